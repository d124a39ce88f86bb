"""The link behind a spring or a gap is followed from the motor: it hangs where it has swung to."""

from dataclasses import replace
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from round_trip_joint import joint_trip, plant
from scipy.integrate import solve_ivp
from trial_logs import PENDULUM

from frictionjoint.effects import backlash, joint_elasticity
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import DT, GEAR, N_SIGNALS, SAG, SWAY, A
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.readers import read_log
from tests.plants.plant import simulate, write
from tests.plants.spec import Effect, Friction, Motion

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


def behind_a_gap(h):
    """A pendulum behind a gap, by its equation in steps of a hundredth of a sample h.

    J (a + d'') = T - G sin(q + d).

    Returns:
        the column of the effect, and T less that of a rigid gear: at the samples, and the mean of
        the means over the times before and after each.
    """
    J, half, resonance, damping, rate2, parts = 0.2, 0.01, 9.0, 0.5, 12.0, 100
    w, turn, size, n = 2.0 * np.pi * resonance, 2.0 * np.pi * 0.7, 0.25, round(6.0 / h)
    t = np.arange((n - 1) * parts + 1) * h / parts
    q, a = 0.1 + size * np.sin(turn * t), -size * turn**2 * np.sin(turn * t)
    rigid = J * (a + rate2 * np.sin(q))
    d, rate, exact = -half - rate2 * np.sin(q[0]) / (w * w), 0.0, np.zeros(len(t))
    for k in range(len(t)):
        beyond = np.sign(d) * max(0.0, abs(d) - half)
        T = -J * (w * w * beyond + 2.0 * damping * w * rate * (beyond != 0.0))
        T *= T * d <= 0.0
        exact[k] = T - rigid[k]
        rate += h / parts * (T / J - a[k] - rate2 * np.sin(q[k] + d))
        d += h / parts * rate
    before = exact[1:].reshape(n - 1, parts).mean(axis=1)
    rows = np.zeros((n, N_SIGNALS))
    rows[1:, DT], rows[:, GEAR], rows[:, SWAY] = h, rigid[::parts], rate2 * np.cos(q[::parts])
    found = columns(backlash.EFFECT.effect_id, (2.0 * half * J, resonance, damping, 0.0), 1, rows)[
        :, 0
    ]
    settled = slice(n // 6, n - 1)
    around = 0.5 * (before + np.append(before[1:], 0.0))
    return found[settled], exact[::parts][settled], np.append(0.0, around)[settled]


@pytest.mark.parametrize(("h", "near", "apart"), [(2e-3, 0.01, 0.1), (1e-2, 0.03, 0.2)])
def test_an_impact_between_two_samples_counts_for_what_it_hands_on(h, near, apart):
    """At the samples the torque of an impact, which lasts some milliseconds, is anything."""
    found, exact, around = behind_a_gap(h)
    assert np.std(found - around) < near * np.std(around)
    assert np.std(exact - around) > apart * np.std(around)


def test_a_link_that_hangs_within_its_gap_begins_there():
    rows = np.zeros((50, N_SIGNALS))
    rows[1:, DT], rows[:, SWAY] = 1e-3, 30.0
    for torque, hangs in ((0.01, -0.01 / 30.0), (-0.02, 0.02 / 30.0)):
        rows[:, GEAR] = torque
        X = np.zeros(3)
        for row in rows:
            found = backlash.torque(np.array([2e-3, 10.0, 0.3, 0.0, 1.0]), 0, row, X, 0)
        assert X[0] == pytest.approx(hangs, rel=1e-9)
        assert found == pytest.approx(-torque)


def test_a_heavy_link_comes_back_with_the_spring_it_has(tmp_path):
    seed = 200
    spec = plant("joint-elasticity", 12.0, seed)
    trip = joint_trip("joint-elasticity", tmp_path, 12.0, seed=seed)
    assert max(trip.errors.values()) < 2.0, trip.errors
    spring = spec.effects[0].parameters
    true = np.sqrt(spring["stiffness"] / spec.inertia) / (2.0 * np.pi)
    # gravity's mean stiffness would make it 0.35% more
    assert trip.first["resonance"].value == pytest.approx(true, rel=5e-4)


def lumped(mjcf):
    """An MJCF that has the rotor's inertia in its link."""
    root = ElementTree.fromstring(mjcf)
    joint, inertial = root.find(".//joint"), root.find(".//inertial")
    rotor = float(joint.attrib.pop("armature"))
    moments = [float(x) + rotor for x in inertial.get("diaginertia").split()]
    inertial.set("diaginertia", " ".join(map(str, moments)))
    return ElementTree.tostring(root, encoding="unicode")


def test_all_of_gravity_hangs_behind_a_spring_whatever_the_model_lumps_together(tmp_path):
    w = 2.0 * np.pi * 6.0
    link = PENDULUM.inertia
    spring = {"stiffness": link * w * w, "damping": 0.06 * link * w}
    motions = (Motion("multisine", 3, 0.5, 1.0, 15.0), Motion("multisine", 4, 0.4, 1.5, 15.0))
    spec = replace(
        PENDULUM,
        mass=2.5,
        length=0.15,
        armature=0.1,
        motions=motions,
        friction=Friction("lugre", Fs=0.6, Fc=0.6, Vs=0.1, sigma2=0.1, presliding=2e-3),
        effects=(Effect("joint-elasticity", spring),),
    )
    logs = [read_log(path, "joint") for path in write(simulate(spec), tmp_path)]
    mjcf = (tmp_path / "joint.xml").read_text()
    term = EffectTerm(joint_elasticity.EFFECT, (5.0, 0.05))
    apart, together = (
        fit(prepare(logs, RigidBody(text, "joint")), (term,)) for text in (mjcf, lumped(mjcf))
    )
    part = link / (link + spec.armature)
    assert together.terms[0].part == pytest.approx(part, rel=0.1)
    assert together.drive_rms < 1.1 * apart.drive_rms
    assert together.terms[0].shape[0] == pytest.approx(6.0, rel=0.005)


def test_a_rotor_that_the_model_has_in_the_link_is_not_behind_the_gap(tmp_path):
    motions = (Motion("multisine", 3, 0.5, 1.0, 15.0), Motion("multisine", 4, 0.4, 1.5, 15.0))
    spec = replace(
        PENDULUM,
        armature=0.06,
        motions=motions,
        effects=(Effect("backlash", {"gap": 0.02, "stiffness": 100.0}),),
    )
    logs = [read_log(path, "joint") for path in write(simulate(spec), tmp_path)]
    mjcf = lumped((tmp_path / "joint.xml").read_text())
    start = (0.02 * PENDULUM.inertia, 8.0, 0.5, 0.0)
    found = fit(prepare(logs, RigidBody(mjcf, "joint")), (EffectTerm(backlash.EFFECT, start),))
    gap, *_, rotor = found.terms[0].shape
    assert rotor == pytest.approx(spec.armature, rel=0.15)
    assert gap == pytest.approx(start[0], rel=0.15)
