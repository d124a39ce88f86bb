"""An arm of seven links and a joint of its own beside it, with presliding as stiff as asked."""

import itertools

import mujoco
import numpy as np

import frictionjoint as fj
from tests.standing import plain_mass

STEP, FS = 1e-3, 10.0
POSTURE = np.append(np.linspace(0.0, 0.6, 7), 0.0)
_LINKS = "".join(
    f'<body pos="0 0 {0.2 * bool(i)}"><joint name="j{i}" armature="0.005" '
    f'axis="{("0 0 1", "0 1 0", "1 0 0")[i % 3]}"/><geom type="capsule" mass="1.5" '
    'fromto="0 0 0 0 0 0.2" size="0.03" contype="0" conaffinity="0"/>'
    for i in range(7)
)
SEVEN = (
    f'<mujoco><option timestep="{STEP}" gravity="0 0 0"/><worldbody>{_LINKS}{"</body>" * 7}'
    # a tree of its own, in the same world
    '<body pos="1 0 0"><joint name="alone" axis="0 1 0"/><geom size="0.05" mass="2"/></body>'
    "</worldbody></mujoco>"
)


def stiff(ratio: float, J: float) -> fj.FrictionParameters:
    """Presliding with h sqrt(K/J) as given."""
    z = FS / ((ratio / STEP) ** 2 * J)
    return fj.FrictionParameters.symmetric(
        Fs=FS, Fc=7.0, Vs=0.05, sigma2=0.1, n=4.0, knots=((z, FS), (4 * z, 20.0), (10 * z, 22.0))
    )


def free_inertias() -> np.ndarray:
    """What a pull at each joint of the arm of seven, and at the one alone, has to move."""
    return 1.0 / np.diag(np.linalg.inv(plain_mass(mujoco.MjModel.from_xml_string(SEVEN), POSTURE)))


def stiff_arm(*ratios: float) -> mujoco.MjModel:
    """Joints with these h sqrt(K/J) in turn."""
    spec = mujoco.MjSpec.from_string(SEVEN)
    each = zip(spec.joints, itertools.cycle(ratios), free_inertias(), strict=False)
    fj.install(spec, {joint.name: stiff(ratio, J) for joint, ratio, J in each})
    return spec.compile()
