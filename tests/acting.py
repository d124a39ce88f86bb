"""Numbers with which an effect acts, from what the effect itself declares.

For tests that go through the catalogue: an effect that is added needs no line here. An arm of two
joints moves without effects; along that motion the grid that a search would begin from gives the
shape numbers, and coefficients are such that each column is felt.
"""

import functools
import math

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint import rivals
from frictionjoint.arrays import Array
from frictionjoint.effects import signals
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.kernel import columns
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.parameters import Friction

STEP, STEPS = 1e-3, 1000
FC = 1.0
LEVELS = {"Fs": 1.5, "Fc": FC, "Vs": 0.05, "sigma2": 0.4}
SPRINGS = LEVELS | {"sigma0": 1e4}
# every law but the integrated one
RIVALS = [
    rivals.StaticParameters.symmetric(**LEVELS, V0=1e-3),
    rivals.ArmstrongParameters.symmetric(**SPRINGS),
    rivals.DahlParameters.symmetric(Fc=FC, sigma2=0.4, sigma0=1e4),
    rivals.DahlStribeckParameters.symmetric(**SPRINGS),
    rivals.LuGreParameters.symmetric(**SPRINGS, sigma1=10.0),
    rivals.ElastoplasticParameters.symmetric(**SPRINGS, sigma1=10.0, breakaway=0.7),
    rivals.MaxwellSlipParameters.symmetric(
        **LEVELS, elements=((5e3, 0.2), (3e3, 0.3), (2e3, 0.5)), C=100.0
    ),
]
ARM = f"""<mujoco><option timestep="{STEP}" integrator="implicitfast"/><worldbody>
<body><joint name="a" axis="0 1 0" armature=".02"/>
<geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/>
<body pos="0 0 -.4"><joint name="b" axis="0 1 0" armature=".02"/>
<geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/></body></body></worldbody>
<actuator><motor joint="a" gear="2" ctrllimited="true" ctrlrange="-1.4 1.4"/><motor joint="b"/>
</actuator><sensor><jointpos name="a_position" joint="a"/></sensor></mujoco>"""
LAW = fj.FrictionParameters.symmetric(
    **LEVELS, sigma1=0.5, n=2.0, knots=((5e-3, 1.5), (15e-3, 2.5), (50e-3, 3.2))
)
# largest torque of each coefficient along the motion, N m
_FELT = 0.4 * FC
# where a grid leaves a number to the data: this far between two bounds, or above the one there is
_BETWEEN, _ABOVE = 0.75, 1.0
# what the thermometer of the motion shows at its beginning and end, deg C
_COLD, _WARM = 20.0, 30.0


def arm(*effects: SimulatedEffect, law: Friction = LAW) -> mujoco.MjModel:
    """The arm, with a law and effects on its first joint."""
    spec = mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"a": law, "b": LAW}, {"a": effects} if effects else None)
    return spec.compile()


def ctrl(k: int) -> Array:
    """Presliding loops, and motion of both joints, beyond the control's range too."""
    t = STEP * k
    return np.float32([1.3 * np.sin(9 * t) + 0.5 * np.sin(41 * t), 0.9 * np.sin(23 * t)])


def natively(model: mujoco.MjModel, steps: int = STEPS, push: float = 0.0) -> Array:
    """Positions and velocities under the native callback, shape (steps, 4); push: N, to and fro."""
    data, out = mujoco.MjData(model), []
    with fj.attach(model):
        for k in range(steps):
            data.ctrl[:] = ctrl(k)
            data.xfrc_applied[-1, 0] = np.float32(push * math.sin(0.2 * k))
            mujoco.mj_step(model, data)
            out.append([*data.qpos, *data.qvel])
    return np.array(out)


def acting(effect: Effect) -> SimulatedEffect:
    """An effect with numbers that make it felt on the arm."""
    rows = _motion()
    shape = _shape(effect, rows)
    found = columns(effect.effect_id, shape, len(effect.coefficients), rows)
    sizes = np.abs(found).max(axis=0)
    bounds = effect.bounds or ((-math.inf, math.inf),) * len(sizes)
    inertia = _inertia() if effect.of_inertia else 1.0
    pairs = zip(sizes, bounds, strict=True)
    return SimulatedEffect(
        effect,
        shape,
        # a column that this motion does not excite has no size to go by
        tuple(
            float(np.clip(_FELT / s if s > 0.0 else _FELT, low * inertia, high * inertia))
            for s, (low, high) in pairs
        ),
    )


def torques() -> tuple[Effect, ...]:
    """All effects that act by a torque of the callback, those that make a signal first."""
    found = [e for e in SIMULATED if e.acts == "torque"]
    return tuple(sorted(found, key=lambda e: bool(e.coefficients)))


def name(effect: Effect) -> str:
    """For the names of tests: forms of one effect have numbers of their own."""
    return f"{effect.name}-{effect.effect_id}"


def _shape(effect: Effect, rows: Array) -> tuple[float, ...]:
    grid = effect.shapes(rows)
    middle = grid[len(grid) // 2] if grid else ()
    bounds = effect.shape_bounds or ((-math.inf, math.inf),) * len(effect.shape)
    # a number that is still to be estimated is zero on the grid
    given = middle if any(middle) else (0.0,) * len(bounds)
    numbers = zip(given, bounds, effect.shape_units, strict=True)
    return tuple(x or _within(*between, unit) for x, between, unit in numbers)


def _within(low: float, high: float, unit: str) -> float:
    if unit == "deg C":
        return _COLD
    if math.isinf(high):
        return _ABOVE + (low if math.isfinite(low) else 0.0)
    return low + _BETWEEN * (high - low)


@functools.cache
def _motion() -> Array:
    """Signals of joint a without effects, under a thermometer that rises; (STEPS, N_SIGNALS)."""
    model = arm()
    data = mujoco.MjData(model)
    rows = np.zeros((STEPS, signals.N_SIGNALS))
    a = model.joint("a").id
    with fj.attach(model):
        for k in range(STEPS):
            data.ctrl[:] = ctrl(k)
            mujoco.mj_step(model, data)
            friction, q = fj.torque(model, data)["a"], data.qpos[a]
            rows[k, [signals.TIME, signals.DT]] = STEP * k, STEP * (k > 0)
            rows[k, [signals.Q, signals.V, signals.A]] = q, data.qvel[a], data.qacc[a]
            rows[k, [signals.GX, signals.GY]] = 9.81 * np.sin(q), 9.81 * np.cos(q)
            rows[k, signals.H] = friction.hysteresis / FC
            motor = data.qfrc_actuator[a]
            rows[k, [signals.MOTOR, signals.ASKED]] = motor, motor
            rows[k, signals.LOAD] = motor - friction.total
            rows[k, signals.LOSS] = friction.total * data.qvel[a]
    rows[:, signals.GEAR] = rows[:, signals.LOAD] - 0.02 * rows[:, signals.A]
    rows[:, signals.TEMP] = np.linspace(_COLD, _WARM, STEPS)
    rows[:, signals.DTAU] = np.gradient(rows[:, signals.MOTOR], STEP)
    return rows


def _inertia() -> float:
    model = arm()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return float(1.0 / model.dof_invweight0[0])
