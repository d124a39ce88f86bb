"""The generators of trial data themselves: integrator, friction, answers."""

import json

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lab.third_hand import control, effect, plant
from lab.third_hand.draw import draw
from lab.third_hand.files import believed_model, write
from lab.third_hand.friction import slip_elements
from lab.third_hand.hidden import ALL
from lab.third_hand.integrate import COLUMNS, simulate
from lab.third_hand.joint import LAWS, Joint
from lab.third_hand.schedule import schedule

FREE = dict(coulomb=1e-12, breakaway=1e-12, viscous=0.0, stiffness=1e-9, damping=0.0)
STICKY = dict(coulomb=2.0, breakaway=3.0, viscous=1.5, stiffness=3.0 / 5e-4, damping=30.0)


def a_joint(law="lugre", **fields) -> Joint:
    plain = dict(inertia=0.5, gravity=0.0, tilt=0.0, stribeck_velocity=0.03, stribeck_shape=2.0)
    shape = {"elasto-plastic": 0.7, "dahl-stribeck": 1.3}.get(law, 0.0)
    return Joint(**(plain | fields), law=LAWS.index(law), shape=shape)


def driven(joint: Joint, torque: float, seconds: float, dt: float, start: float = 0.0):
    """The joint under a constant torque from rest, up to a thousand samples."""
    feeds = control.Controller(0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1e9)
    reference = np.tile([start, 0.0, torque], (2, 1))
    steps = round(seconds / dt)
    at = np.arange(0, steps + 1, max(steps // 1000, 1))
    elements = slip_elements(joint.coulomb, joint.stiffness)
    args = (joint, elements, feeds, reference, 20, dt, 0.0, 0.003, 22.0, at, at)
    return dict(zip(COLUMNS, simulate(*args)[0].T, strict=True))


def pendulum(dt: float) -> float:
    """Largest error in the angle of a free pendulum let go at 2.5 rad, over five seconds."""
    joint = a_joint("dahl-stribeck", gravity=12.0, tilt=0.3, **FREE)
    got = driven(joint, 0.0, 5.0, dt, start=2.5)
    want = solve_ivp(
        lambda t, y: [y[1], -12.0 / 0.5 * np.sin(y[0] + 0.3)], (0, 5), [2.5, 0.0],
        method="DOP853", t_eval=got["time"].clip(0, 5), rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    return abs(got["position"] - want.y[0]).max()


def test_pendulum_follows_the_differential_equation_and_converges_with_fourth_order():
    assert pendulum(5e-5) < 1e-9
    assert pendulum(8e-3) / pendulum(2e-3) > 0.8 * 4**4


def test_pendulum_keeps_its_energy():
    joint = a_joint("dahl-stribeck", gravity=12.0, tilt=0.3, **FREE)
    r = driven(joint, 0.0, 20.0, 5e-5, start=2.5)
    energy = 0.25 * r["velocity"] ** 2 - 12.0 * np.cos(r["position"] + 0.3)
    assert np.ptp(energy) < 1e-7


def test_two_masses_swing_against_each_other_as_the_formula_says():
    joint = a_joint("dahl-stribeck", **FREE, link=0.6, coupling=300.0)
    r = driven(joint, 2.0, 1.0, 5e-5)
    w = (300.0 * (1 / 0.2 + 1 / 0.3)) ** 0.5
    twist = 2.0 / 0.2 / w**2 * (1 - np.cos(w * r["time"]))
    np.testing.assert_allclose(r["position"] - r["link"], twist, atol=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_slides_at_the_speed_where_viscosity_takes_the_rest(law):
    r = driven(a_joint(law, **STICKY), 5.0, 4.0, 5e-5)
    # Dahl's curve nears its limit as a power of the distance, not exponentially
    assert r["velocity"][-1] == pytest.approx(2.0, rel=2e-3 if law == "dahl-stribeck" else 1e-4)


@pytest.mark.parametrize("law", LAWS)
def test_holds_below_breakaway(law):
    r = driven(a_joint(law, **STICKY), 0.8, 3.0, 5e-5)
    later = r["time"] > 2.0  # Dahl's curve has no damping of its own and still rings
    assert np.ptp(r["position"][later]) < (2e-5 if law == "dahl-stribeck" else 1e-6)
    if law == "elasto-plastic":  # the one that is elastic below breakaway
        assert r["position"][-1] == pytest.approx(0.8 / STICKY["stiffness"], rel=1e-3)


@pytest.fixture(scope="module")
def quiet_plant():
    return plant.make(3, 0, ())


@pytest.fixture(scope="module")
def busy_plant():
    return plant.make(4, 2, ("load-dependent", "end-stop"))


def test_a_plant_is_the_same_for_a_seed_and_another_for_another(quiet_plant):
    again = plant.make(3, 0, ())
    assert again.answer == quiet_plant.answer
    for name, log in quiet_plant.logs.items():
        for column, values in log.items():
            np.testing.assert_array_equal(values, again.logs[name][column])
    other = draw(np.random.default_rng([4, 0]), ())
    assert other.joint.inertia != again.answer["parameters"]["inertia"]


@pytest.mark.parametrize("which", ["quiet_plant", "busy_plant"])
def test_a_plant_has_four_finite_logs_and_a_whole_answer(which, request, tmp_path):
    made = request.getfixturevalue(which)
    write(made, tmp_path)
    answer = json.loads((tmp_path / "answer.json").read_text())
    assert set(answer["accept"]) == set(answer["kinds"]) == set(answer["effects"])
    for name in plant.LOGS:
        table = np.genfromtxt(tmp_path / f"{name}.csv", delimiter=",", names=True)
        assert table.dtype.names[:3] == ("time_s", "position_rad", "torque_nm")
        values = np.array(table.tolist())
        assert np.isfinite(values).all()
        assert (np.diff(table["time_s"]) > 0).all()
        assert 14.5 < np.ptp(table["time_s"]) < 30
    assert answer["styles"]["held"] not in [answer["styles"][n] for n in plant.LOGS[:3]]


def test_noise_is_as_stated_and_effects_stand_out_of_it(busy_plant):
    answer = busy_plant.answer
    assert answer["true_rms"]["fit"] == pytest.approx(answer["noise_rms"], rel=0.2)
    for told in answer["effects"].values():
        assert told["over_noise"] >= 5
        assert told["over_friction"] >= 0.03


def test_model_is_the_joint_without_friction(busy_plant):
    joint = busy_plant.joint._replace(tilt=0.7)
    model = mujoco.MjModel.from_xml_string(believed_model(joint))
    data = mujoco.MjData(model)
    for q, a in [(0.4, 0.0), (-1.2, 3.0), (2.5, -7.0)]:
        data.qpos[0], data.qvel[0], data.qacc[0] = q, 1.3, a
        mujoco.mj_inverse(model, data)
        want = joint.inertia * a + joint.gravity * np.sin(q + 0.7)
        assert data.qfrc_inverse[0] == pytest.approx(want, rel=1e-6)


@pytest.mark.parametrize("kind", ["joint-elasticity", "frictional-lag", "torque-gain", "spring"])
def test_the_balance_that_sizes_an_effect_closes(kind):
    rng = np.random.default_rng(5)
    drawn = draw(rng, (kind,))
    r = plant.run(rng, drawn, 0)
    left = r["asked"] - effect.needed(drawn.joint, drawn.joint, r)
    assert effect.rms(left) < 1e-9 * effect.rms(r["asked"])
    assert effect.rms(effect.moved(kind, drawn.joint, r)) > 0


def test_delay_moves_the_position_against_the_torque_by_what_the_answer_says():
    rng = np.random.default_rng(6)
    drawn = draw(rng, ("measurement-delay",))
    r = plant.run(rng, drawn, 0)
    then = np.interp(r["time"] - drawn.delay, r["time"], r["position"])[20:]
    slack = abs(r["velocity"]).max() * drawn.dt + 30.0 / drawn.instruments.rate**2
    assert abs(r["position_early"][20:] - then).max() < slack


def test_schedule_keeps_its_mix_and_its_beginning():
    plans = schedule(7, 200)
    assert plans[:37] == schedule(7, 37)
    assert plans != schedule(8, 200)
    outside = sum(len(p) == 1 and bool(ALL[p[0]].variable) for p in plans)
    lengths = [len(p) for p in plans]
    assert (lengths.count(0), lengths.count(2), outside) == (40, 40, 30)
    assert {kind for p in plans for kind in p} == set(ALL)
