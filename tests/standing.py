"""Mechanisms that friction has to hold: one joint, a linkage, a table on legs, random trees."""

from typing import Any

import mujoco
import numpy as np

import frictionjoint as fj

LINKAGE = """<mujoco><option timestep="1e-3" integrator="implicitfast"/><default><geom
  type="capsule" size=".01" mass=".2" contype="0" conaffinity="0"/></default><worldbody>
  <body><joint name="crank" axis="0 1 0"/><geom fromto="0 0 0 0 0 .2"/>
    <body name="rod" pos="0 0 .2"><joint name="knee" axis="0 1 0"/>
      <geom fromto="0 0 0 .3 0 0"/></body></body>
  <body name="rocker" pos=".3 0 0"><joint name="rocker" axis="0 1 0"/>
    <geom fromto="0 0 0 0 0 .2"/></body></worldbody>
  <equality><connect body1="rod" body2="rocker" anchor=".3 0 0"/></equality></mujoco>"""


def law(level: float, stiffness: float, **more: Any) -> fj.FrictionParameters:
    """Breakaway torque in N m, presliding stiffness in N m/rad."""
    reach = level / stiffness
    knots = ((reach, level), (3 * reach, 1.67 * level), (10 * reach, 2.1 * level))
    numbers = {"Fc": 0.7 * level, "Vs": 0.05, "n": 2, **more}
    return fj.FrictionParameters.symmetric(Fs=level, knots=knots, **numbers)


def with_friction(
    xml: str, level: float, ratio: float, damping: float = 0.0, integrator: str | None = None
) -> mujoco.MjModel:
    """Friction on every named joint; ratio is h sqrt(K/J), damping h sigma2/J of the free joint."""
    spec = mujoco.MjSpec.from_string(xml)
    plain = spec.compile()
    h, laws = plain.opt.timestep, {}
    for joint in spec.joints:
        if joint.name:
            J = 1.0 / plain.dof_invweight0[plain.joint(joint.name).dofadr[0]]
            laws[joint.name] = law(level, J * (ratio / h) ** 2, sigma2=damping * J / h)
    fj.install(spec, laws)
    model = spec.compile()
    if integrator is not None:
        model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    return model


def one_joint(inertia: float, step: float = 1e-3) -> str:
    """A hinge alone, without gravity."""
    return (
        f'<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/><worldbody>'
        f'<body><joint name="j" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia='
        f'"{inertia} {inertia} {inertia}"/></body></worldbody></mujoco>'
    )


def table(step: float = 2e-3) -> str:
    """5 kg on four legs of two joints each that stand on a floor."""
    legs = ""
    for i, (x, y) in enumerate(((0.2, 0.15), (0.2, -0.15), (-0.2, 0.15), (-0.2, -0.15))):
        legs += (
            f'<body pos="{x} {y} 0"><joint name="hip{i}" axis="0 1 0"/><geom type="capsule" '
            'fromto="0 0 0 .1 0 -.2" size=".02" contype="0" conaffinity="0" mass=".5"/>'
            f'<body pos=".1 0 -.2"><joint name="knee{i}" axis="0 1 0"/><geom type="capsule" '
            'fromto="0 0 0 -.1 0 -.2" size=".015" contype="0" conaffinity="0" mass=".3"/>'
            '<geom type="sphere" pos="-.1 0 -.2" size=".02" mass=".05"/></body></body>'
        )
    return (
        f'<mujoco><option timestep="{step}" integrator="implicitfast"/><worldbody>'
        '<geom type="plane" size="3 3 .1"/><body pos="0 0 .42"><freejoint/>'
        f'<geom type="box" size=".25 .18 .04" mass="5"/>{legs}</body></worldbody></mujoco>'
    )


def random_tree(rng: np.random.Generator) -> str:
    """Two to five hinges; maybe an equality constraint, maybe a floor that one end touches."""
    n = int(rng.integers(2, 6))
    parents = [-1] + [int(rng.integers(0, i)) for i in range(1, n)]
    ends = rng.normal(size=(n, 3))
    ends *= (0.15 + 0.25 * rng.random((n, 1))) / np.linalg.norm(ends, axis=1, keepdims=True)
    masses, axes = 0.2 + rng.random(n), rng.normal(size=(n, 3))
    place = np.zeros((n, 3))  # of each body in the world: all joints are at zero
    for i in range(1, n):
        place[i] = place[parents[i]] + ends[parents[i]]

    def text(x: Any) -> str:
        return " ".join(map(str, x))

    def body(i: int) -> str:
        kids = "".join(body(k) for k in range(n) if parents[k] == i)
        at = ends[parents[i]] if i else np.zeros(3)
        return (
            f'<body name="b{i}" pos="{text(at)}"><joint name="j{i}" axis="{text(axes[i])}"/>'
            f'<geom type="capsule" size=".02" mass="{masses[i]}" fromto="0 0 0 {text(ends[i])}" '
            'contype="0" conaffinity="0"/><geom type="sphere" size=".03" mass=".1" '
            f'pos="{text(ends[i])}" contype="0" conaffinity="1"/>{kids}</body>'
        )

    floor = equality = ""
    if rng.random() < 0.7:
        low = (place + ends)[:, 2].min() - 0.03
        floor = f'<geom type="plane" size="5 5 .1" pos="0 0 {low}" contype="1" conaffinity="0"/>'
    if n > 2 and rng.random() < 0.7:
        a, b = rng.choice(n, 2, replace=False)
        equality = (
            f'<joint joint1="j{a}" joint2="j{b}" polycoef="0 {rng.normal()} 0 0 0"/>',
            f'<connect body1="b{a}" body2="b{b}" anchor=".05 .02 .03"/>',
            f'<connect body1="b{a}" body2="world" anchor=".05 .02 .03"/>',
        )[int(rng.integers(0, 3))]
    return (
        '<mujoco><option timestep="1e-3" gravity="0 0 0" integrator="implicitfast"/><worldbody>'
        f"{floor}{body(0)}</worldbody><equality>{equality}</equality></mujoco>"
    )


def plain_mass(model: mujoco.MjModel, qpos: np.ndarray) -> np.ndarray:
    """Mass matrix at a position as MuJoCo makes it, shape (nv, nv)."""
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    data.qpos[:] = qpos
    mujoco.mj_fwdPosition(model, data)
    for row, unit in zip(mass, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    return mass
