"""``--to native --lugre``: MuJoCo's own LuGre, which has presliding and the Stribeck effect.

MuJoCo has it inside the actuator `dcmotor`. Here each joint gets one with no other function. That
adds actuators, and not every program that loads MJCF supports them. LuGre has no memory of
reversals: it drifts under a load that oscillates below breakaway.
"""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np
from scipy.optimize import minimize_scalar

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError
from frictionjoint.export.motion import Motion
from frictionjoint.export.sliding import PlainFriction, add_plain, levels
from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction
from frictionjoint.rivals import LuGreParameters

# range of the bristle stiffness that is searched, over the law's own
_STIFFNESS = (0.05, 5.0)


def lugre_friction(parameters: Friction, motion: Motion) -> LuGreParameters:
    """The LuGre joint nearest to a law along a motion, equal in both directions.

    The levels are means over the directions; the bristle's stiffness is a least-squares fit to the
    torque. MuJoCo's Stribeck exponent is 2, whatever the law's is.

    Raises:
        ModelError: the law has no presliding.
    """
    if parameters.stiffness == 0.0:
        raise ModelError(f"the law {parameters.law} has no presliding stiffness: leave out --lugre")
    both = levels(parameters)
    Fs, Fc, Vs, _, sigma2 = (0.5 * (a + b) for a, b in zip(both["pos"], both["neg"], strict=True))
    sigma1 = float(getattr(parameters, "sigma1", 0.0))

    def made(logarithm: float) -> LuGreParameters:
        return LuGreParameters.symmetric(
            Fs=Fs, Fc=Fc, Vs=Vs, sigma2=sigma2, sigma0=float(np.exp(logarithm)), sigma1=sigma1
        )

    own = friction_torque(parameters, motion.time, motion.position)

    def miss(logarithm: float) -> float:
        other = friction_torque(made(logarithm), motion.time, motion.position)
        return float(np.mean((other - own) ** 2))

    bounds = [float(np.log(parameters.stiffness * factor)) for factor in _STIFFNESS]
    return made(float(minimize_scalar(miss, bounds=bounds, method="bounded").x))


def lugre_torque(lugre: LuGreParameters, motion: Motion) -> Array:
    """Torque of the bristles along a motion, N m, shape (n,), without the viscous part."""
    dry = replace(lugre, sigma2_pos=0.0, sigma2_neg=0.0)
    return friction_torque(dry, motion.time, motion.position)


def add_lugre(
    spec: mujoco.MjSpec, lugre: Mapping[str, LuGreParameters], plain: Mapping[str, PlainFriction]
) -> mujoco.MjSpec:
    """A new spec with a `dcmotor` per joint, and with plain friction except its Coulomb part.

    Raises:
        ModelError: as `add_plain`.
    """
    viscous = {
        name: replace(p, coulomb=0.0, damping=(lugre[name].sigma2_pos,))
        for name, p in plain.items()
    }
    add_plain(spec, viscous)
    motors = "".join(
        # a motor of next to no constant that no control reaches; MuJoCo 3 refuses 0
        f'<dcmotor name="{name}_friction" joint="{name}" input="none" motorconst="1e-6" '
        f'resistance="1" lugre="{p.sigma0!r} {p.sigma1!r} {p.Fc_pos!r} {p.Fs_pos!r} '
        f'{p.Vs_pos!r}"/>'
        for name, p in lugre.items()
    )
    spec.compile()
    text = spec.to_xml().replace("</mujoco>", f"<actuator>{motors}</actuator></mujoco>")
    return mujoco.MjSpec.from_string(text)
