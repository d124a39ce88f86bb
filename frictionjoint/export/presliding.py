"""Presliding in stock MuJoCo: ``--to native --lugre`` and ``--to native --yield``.

MuJoCo has LuGre, with presliding and the Stribeck effect, inside the actuator `dcmotor`. Here each
joint gets one with no other function. That adds actuators, and not every program that loads MJCF
supports them. LuGre has no memory of reversals: it drifts under a load that oscillates below
breakaway.

In MuJoCo 4.0, a fixed tendon of one joint with `stiffness` and `springyield` is a Jenkins element:
a spring that slides once its torque reaches a limit. Several in parallel are the Maxwell-slip model
(Iwan 1966): hysteresis with memory of reversals, and no drift under a load that oscillates. MuJoCo
integrates the springs explicitly, so they are softened if the time step requires it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.optimize import minimize_scalar, nnls

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError
from frictionjoint.export.motion import Motion
from frictionjoint.export.sliding import PlainFriction, add_plain, levels
from frictionjoint.law.motion import friction_torque
from frictionjoint.parameters import Friction
from frictionjoint.rivals import LuGreParameters

# range of the bristle stiffness that is searched, over the law's own
_STIFFNESS = (0.05, 5.0)
# of a curve of loading
_SAMPLES = 400


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


@dataclass(frozen=True)
class YieldSprings:
    """Elements of a joint.

    Attributes:
        stiffness: N m/rad (N/m), shape (k,). displacement: rad (m) at which each yields, (k,).
        softened: factor by which the time step lengthened all displacements; 1: none.
    """

    stiffness: Array
    displacement: Array
    softened: float = 1.0

    def suited(self, step: float, inertia: float) -> "YieldSprings":
        """Springs as soft as a step, s, and an inertia, kg m^2, require, with the same limits."""
        # explicit springs hold a joint up to h sqrt(K/J) = 1
        stiffest = inertia * (1.0 / step) ** 2
        factor = max(1.0, float(self.stiffness.sum()) / stiffest)
        return YieldSprings(self.stiffness / factor, self.displacement * factor, factor)


def yield_springs(parameters: Friction, coulomb: float) -> YieldSprings:
    """Elements nearest to the loops of a law; their limits add up to the Coulomb torque, N m.

    Raises:
        ModelError: the law has no presliding, or does not slide.
    """
    if parameters.stiffness == 0.0:
        raise ModelError(f"the law {parameters.law} has no presliding stiffness: leave out --yield")
    if coulomb <= 0.0:
        raise ModelError("the joint has no Coulomb torque that springs could hold: no --yield")
    reach = _reach(parameters, coulomb)
    q = reach * np.linspace(0.0, 1.0, _SAMPLES)
    F = np.minimum(_loading(parameters, q), coulomb)
    tried = np.geomspace(reach / 100.0, reach, 60)
    scale = coulomb / reach
    limits = np.minimum(q[:, None], tried) * scale
    end = np.minimum(reach, tried) * scale
    # the limits add up to the Coulomb torque
    weight = 10.0 * np.sqrt(_SAMPLES)
    A, b = np.vstack([limits, weight * end]), np.append(F, weight * coulomb)
    chosen, _ = nnls(A, b)
    # the four largest elements
    used = np.argsort(chosen * end)[::-1][:4]
    used = np.sort(used[chosen[used] > 0.0])
    again, _ = nnls(A[:, used], b)
    kept = again > 0.0
    stiffness, displacement = again[kept] * scale, tried[used][kept]
    stiffness *= coulomb / float(stiffness @ displacement)
    return YieldSprings(stiffness, displacement)


def _loading(parameters: Friction, q: Array) -> Array:
    """Torque of elements, N m, at displacements that rise from zero: that of the law's loops.

    After a reversal, elements change by twice their first loading at half of the displacement
    (Masing). So the curve is taken after a reversal of slow sliding, not from a joint that never
    moved.
    """
    # after ten presliding displacements it slides
    before = 10.0 * float(q[-1]) * np.linspace(0.0, 1.0, len(q))
    back = before[-1] - 2.0 * q[1:]
    path = np.concatenate([before, back])
    # rad/s over the presliding displacement: slow enough that nothing viscous shows
    time = np.append(0.0, np.cumsum(np.abs(np.diff(path)))) / (1e-4 * q[-1])
    F = friction_torque(parameters, time, path)
    turned = F[len(before) - 1]
    return np.append(0.0, 0.5 * (turned - F[len(before) :]))


def _reach(parameters: Friction, coulomb: float) -> float:
    """Displacement at which slow loading reaches the Coulomb torque, rad (m)."""
    longest = coulomb / parameters.stiffness
    for _ in range(12):
        q = longest * np.linspace(0.0, 1.0, _SAMPLES)
        there = _loading(parameters, q) >= 0.98 * coulomb
        if there.any():
            return float(q[int(np.argmax(there))])
        longest *= 2.0
    return longest


def add_yield_springs(
    spec: mujoco.MjSpec, springs: Mapping[str, YieldSprings], plain: Mapping[str, PlainFriction]
) -> mujoco.MjSpec:
    """Add the elements of joints, and plain friction except its Coulomb torque.

    Raises:
        ModelError: MuJoCo is older than 4.0, or as `add_plain`.
    """
    if not hasattr(mujoco.MjModel, "tendon_springyield"):
        raise ModelError(
            f"springs that yield need MuJoCo 4.0, this is {mujoco.__version__}: leave out --yield"
        )
    add_plain(spec, {name: replace(p, coulomb=0.0) for name, p in plain.items()})
    model = spec.copy().compile()
    start = {name: float(model.qpos0[model.jnt_qposadr[model.joint(name).id]]) for name in springs}
    for name, elements in springs.items():
        pairs = zip(elements.stiffness, elements.displacement, strict=True)
        for i, (stiffness, displacement) in enumerate(pairs):
            tendon = spec.add_tendon(name=f"{name}_presliding_{i + 1}")
            tendon.wrap_joint(name, 1.0)
            tendon.stiffness = np.array([stiffness, *np.zeros(np.size(tendon.stiffness) - 1)])
            tendon.springlength = np.full(2, start[name])
            tendon.springyield = displacement
    return spec
