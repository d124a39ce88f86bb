"""The link of an elastic joint hangs where it has swung to: gravity is no part of its spring."""

import mujoco
import numpy as np
import pytest
from round_trip_joint import joint_trip, plant
from scipy.integrate import solve_ivp

from frictionjoint.effects import joint_elasticity
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import DT, N_SIGNALS, SAG, SWAY, A
from frictionjoint.identify.rigid_body import RigidBody

# oblique axes, a second joint behind the first, a rotor, and a body that is held up in part
ARM = """
<mujoco><option gravity="1 -2 -9"/><worldbody><body>
<joint name="a" axis="0.3 1 0.2" armature="0.1"/>
<inertial pos="0.1 0.05 -0.2" mass="2" diaginertia="0.02 0.03 0.02"/>
<body pos="0.1 0 -0.4" gravcomp="0.3"><joint name="b" axis="1 0.2 0"/>
<inertial pos="0 0.1 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/></body></body>
<body pos="1 0 0"><joint name="c"/><inertial pos="1 0 0" mass="9" diaginertia="1 1 1"/></body>
</worldbody></mujoco>"""


def still(model: mujoco.MjModel, q: float, other: float, moved: float) -> float:
    """Torque at the first joint where nothing turns, N m; `moved`: its acceleration, rad/s^2."""
    data = mujoco.MjData(model)
    data.qpos[:2], data.qacc[0] = (q, other), moved
    mujoco.mj_inverse(model, data)
    return float(data.qfrc_inverse[0])


def test_what_a_hanging_link_asks_for_is_the_models_gravity_over_its_inertia():
    q, h = np.linspace(-3.0, 3.0, 9), 1e-5
    other, none = 0.4 * np.cos(q), np.zeros(9)
    body = RigidBody(ARM, "a")
    found = body.torque(q, none, none, {"b": (other, none, none)})
    pairs = list(zip(q, other, strict=True))
    inertia = [still(body.model, *x, 1.0) - still(body.model, *x, 0.0) - 0.1 for x in pairs]
    gravity = [still(body.model, *x, 0.0) for x in pairs]
    stiffness = [
        (still(body.model, x + h, y, 0.0) - still(body.model, x - h, y, 0.0)) / (2.0 * h)
        for x, y in pairs
    ]
    np.testing.assert_allclose(found.sag, np.divide(gravity, inertia), rtol=1e-9)
    np.testing.assert_allclose(found.sway, np.divide(stiffness, inertia), rtol=1e-6)


def test_the_torque_of_a_pendulum_behind_a_spring():
    """Against its equation, J (a + d'') = -(K d + D d' + G sin(q + d)), integrated."""
    J, resonance, damping, rate2 = 0.2, 6.0, 0.03, 40.0
    w, turn, size = 2.0 * np.pi * resonance, 2.0 * np.pi * 3.0, 0.3
    t = 2e-3 * np.arange(3000)

    def q(x):
        return 0.5 + size * np.cos(turn * x)

    def acceleration(x):
        return -size * turn**2 * np.cos(turn * x)

    def spring(d, rate):
        return -J * (w * w * d + 2.0 * damping * w * rate)

    def moves(x, state):
        d, rate = state
        return rate, spring(d, rate) / J - rate2 * np.sin(q(x) + d) - acceleration(x)

    start = -rate2 * np.sin(q(0.0)) / (w * w + rate2 * np.cos(q(0.0)))
    d, rate = solve_ivp(moves, (0.0, t[-1]), (start, 0.0), t_eval=t, rtol=1e-9, atol=1e-12).y
    wanted = spring(d, rate) - J * (acceleration(t) + rate2 * np.sin(q(t)))
    rows = np.zeros((len(t), N_SIGNALS))
    rows[1:, DT], rows[:, A] = 2e-3, acceleration(t)
    rows[:, SAG], rows[:, SWAY] = rate2 * np.sin(q(t)), rate2 * np.cos(q(t))
    found = J * columns(joint_elasticity.EFFECT.effect_id, (resonance, damping), 1, rows)[:, 0]
    rows[:, [SAG, SWAY]] = 0.0
    without = J * columns(joint_elasticity.EFFECT.effect_id, (resonance, damping), 1, rows)[:, 0]
    settled = slice(1500, None)
    assert np.abs(found - wanted)[settled].max() < 0.02 * np.abs(wanted).max()
    assert np.abs(without - wanted)[settled].max() > 0.1 * np.abs(wanted).max()


def test_a_heavy_link_comes_back_with_the_spring_it_has(tmp_path):
    seed = 200
    spec = plant("joint-elasticity", 12.0, seed)
    trip = joint_trip("joint-elasticity", tmp_path, 12.0, seed=seed)
    assert max(trip.errors.values()) < 2.0, trip.errors
    spring = spec.effects[0].parameters
    true = np.sqrt(spring["stiffness"] / spec.inertia) / (2.0 * np.pi)
    # gravity's mean stiffness would make it 0.35% more
    assert trip.first["resonance"].value == pytest.approx(true, rel=5e-4)
