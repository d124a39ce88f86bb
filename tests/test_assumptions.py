"""What logs do not determine of a law is assumed and said to be so."""

import tomllib
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from test_early_checks import stages

import frictionjoint as fj
from frictionjoint import close_loop, uninstall
from frictionjoint.decisions import CLEARLY
from frictionjoint.effects.friction_level import LOAD_DEPENDENT
from frictionjoint.errors import LogError
from frictionjoint.files import joint_friction
from frictionjoint.identify.assumptions import (
    shortest,
    with_assumed_breakaway,
    with_assumed_level,
    with_assumed_stiffness,
    with_steep_start,
)
from frictionjoint.identify.base_fit import base_fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.notes import assumed_note
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import Estimate, law_estimates, law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog
from frictionjoint.report.numbers import status_of

DT, N, LEVEL, COUNT = 2e-3, 4000, 0.5, 1e-4
T = DT * np.arange(N)
JOINT = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial mass="1" pos="0 0 0" diaginertia="0.05 0.05 0.05"/></body></worldbody></mujoco>"""

PENDULUM = JOINT.replace("0 0 1", "0 1 0").replace('pos="0 0 0"', 'pos="0 0 -0.2"')


def motion(phase: float = 0.0, middle: float = 0.0):
    q = middle + 0.5 * np.sin(2.0 * np.pi * 0.3 * T + phase) + 0.2 * np.sin(2.0 * np.pi * 0.8 * T)
    v = np.gradient(q, DT)
    return q, v, np.gradient(v, DT)


def logged(q, torque, noise: float, seed: int) -> JointLog:
    torque = torque + noise * np.random.default_rng(seed).standard_normal(N)
    return JointLog(name=f"{seed}", joint="j", time=T, position=q, torque=torque)


def log(stiffness: float, seed: int = 1, noise: float = 2e-3) -> JointLog:
    """A bristle of a stiffness along sines, read by an encoder."""
    q, _, a = motion(seed)
    friction = stages(q, LEVEL, LEVEL / stiffness)
    return logged(COUNT * np.round(q / COUNT), 0.05 * a + friction, noise, seed)


def fitted(stiffness: float, noise: float = 2e-3):
    body = RigidBody(JOINT, "j")
    prepared, found = base_fit(prepare([log(stiffness, noise=noise)], body), "integrated")
    return prepared, with_assumed_stiffness(prepared, found)


def test_a_stiffness_that_the_encoder_does_not_resolve_is_assumed():
    prepared, found = fitted(5e5)
    assert found.shape.stiffness_assumed
    stiffness = law_estimates(found, stated_covariance(prepared, found), False)["stiffness"]
    assert stiffness.stderr is None
    # no softer than what the logs would have shown
    law = law_parameters(found)
    assert stiffness.value == pytest.approx(law.stiffness)
    assert stiffness.value == pytest.approx(law.Fs_pos / shortest(prepared), rel=0.01)
    # that of a search, which nothing limits, is not taken
    short = replace(found.shape, length=1e-9, stiffness_assumed=False)
    assert short.with_assumed_stiffness(1e-5).length == 1e-5
    assert law.Fc_pos == pytest.approx(LEVEL, rel=0.02)


def test_a_stiffness_that_the_logs_show_is_estimated():
    prepared, found = fitted(20.0)
    assert not found.shape.stiffness_assumed
    stiffness = law_estimates(found, stated_covariance(prepared, found), False)["stiffness"]
    assert stiffness.stderr is not None
    # that at a reversal, where the curve is steepest
    assert 20.0 < stiffness.value < 40.0


def test_without_a_coulomb_level_no_stiffness_is_assumed_and_the_joint_does_not_stick():
    q, v, a = motion()
    # viscous friction that rises faster than linearly: below the straight line where slow
    own = logged(q, 0.05 * a + 0.5 * v + 0.2 * v * np.abs(v), 1e-3, 0)
    prepared, found = base_fit(prepare([own], RigidBody(JOINT, "j")), "integrated")
    found = with_assumed_stiffness(prepared, found)
    assert not found.has_level
    assert not found.shape.stiffness_assumed
    (said,) = assumed_note(prepared, found)
    assert "no Coulomb friction" in said


def test_coulomb_friction_that_a_sweep_in_one_direction_does_not_show_is_not_called_none():
    q = 0.1 * T + 0.02 * T**2
    sweep = logged(q, 0.002 + 0.5 * LEVEL * np.arange(N) / N, 0.4, 0)
    report = close_loop([sweep], JOINT, "j", [replace(sweep, name="1", position=q + 1e-3)])
    (said,) = (x for x in report.notes if "Coulomb friction," in x)
    assert "do not determine Coulomb friction, because the joint moves in one direction" in said
    # no parameter file without the number it is for
    with pytest.raises(LogError, match="0: does not determine Coulomb friction, because the joint"):
        fj.identify([sweep], JOINT, "j")


def test_a_parameter_file_says_what_is_assumed():
    found = fj.identify([log(5e5)], JOINT, "j")
    text = found.to_toml()
    assert "# The presliding stiffness is assumed: these logs do not determine it." in text
    assert joint_friction(tomllib.loads(text)).parameters == found.parameters
    unsure = found.estimates | {"Fc_pos": Estimate(0.08, 0.06, "N m")}
    text = replace(found, estimates=unsure).to_toml()
    assert "# Standard errors of more than half of the value: Fc_pos" in text


def test_friction_that_would_vanish_with_the_load_gets_a_level():
    q, v, a = motion(middle=1.0)
    load = 0.09 * a + 0.2 * 9.81 * np.sin(q)
    own = logged(q, load + (0.2 * np.abs(load) - 0.05) * np.tanh(v / 1e-3), 2e-3, 0)
    prepared, base = base_fit(prepare([own], RigidBody(PENDULUM, "j")), "integrated")
    bare = refit(prepared, (EffectTerm(LOAD_DEPENDENT, (1e-4,)),), base.shape)
    assert not bare.has_level
    prepared, found = with_assumed_level(prepared, bare)
    assert found.level_assumed
    assert found.drive_rms <= bare.drive_rms / (1.0 - CLEARLY)
    assert [n for n in assumed_note(prepared, found) if "unloaded joint is assumed" in n]


def test_a_report_says_that_it_is_assumed_and_starts_from_what_identify_writes():
    prepared, base = fitted(5e5)
    report = close_loop([log(5e5)], JOINT, "j", [log(5e5, seed=2)])
    assert not report.added
    assert [n for n in report.notes if "presliding stiffness is assumed" in n]
    assert 'name="frictionjoint-assumed:j"' in report.mjcf
    model = mujoco.MjModel.from_xml_string(report.mjcf)
    assert "assumed: the stiffness" in fj.check(model)[0]["acts"][-1]
    spec = mujoco.MjSpec.from_string(report.mjcf)
    uninstall(spec)
    assert not list(spec.texts)
    base = with_steep_start(prepared, with_assumed_breakaway(prepared, base))
    own = law_estimates(base, stated_covariance(prepared, base), False)
    assert {k: x.value for k, x in report.base.items()} == pytest.approx(
        {k: x.value for k, x in own.items()}, rel=1e-6
    )


@pytest.mark.parametrize("stiffness", [20.0, 300.0])
def test_a_soft_joint_comes_to_rest_under_load_by_an_assumed_steep_start(stiffness):
    prepared, ringing = fitted(stiffness, noise=0.1)
    found = with_steep_start(prepared, ringing)
    assert found.drive_rms <= ringing.drive_rms / 0.99
    before, after = (law_parameters(f).stiffness for f in (ringing, found))
    assert after == pytest.approx(before, rel=0.02)
    (said,) = assumed_note(prepared, found)
    assert "beginning of the presliding curve is assumed" in said
    assert moves_at_rest(ringing) > 1e-7
    assert moves_at_rest(found) < 1e-9


def test_a_breakaway_friction_that_the_logs_do_not_show_is_assumed():
    prepared, found = fitted(5e5)
    # far above Coulomb friction, below all speeds of the logs
    shape = replace(found.shape, excess=12.0, Vs=1.1e-3 * prepared.top_speed, delta=2.0)
    high = refit(prepared, (), shape)
    assert law_parameters(high).Fs_pos > 2.0 * LEVEL
    lower = with_assumed_breakaway(prepared, high)
    law = law_parameters(lower)
    assert law.Fc_pos <= law.Fs_pos <= 1.3 * LEVEL
    assert lower.drive_rms <= high.drive_rms / (1.0 - CLEARLY)
    times = {0.0: "equals Coulomb", 0.25: "is 1.25 times Coulomb"}[lower.shape.excess]
    assert [n for n in assumed_note(prepared, lower) if f"It {times} friction" in n]


@pytest.mark.parametrize("law", ["integrated", "lugre", "static"])
def test_no_breakaway_friction_of_a_short_log_is_stated_with_an_error_beyond_half_of_it(law):
    """Three seconds in which a joint with a Stribeck effect reverses twice."""
    t = 5e-3 * np.arange(600)
    w, rng = 2.0 * np.pi * 0.2, np.random.default_rng(7)
    q, v = 0.8 * np.sin(w * t), 0.8 * w * np.cos(w * t)
    level = 0.74 + 0.37 * np.exp(-((v / 0.05) ** 2))
    torque = level * np.tanh(v / 1e-3) + 0.1 * v - 0.05 * w**2 * q
    torque += 0.02 * rng.standard_normal(len(t))
    step = 2.0 * np.pi / 16384
    read = step * np.round(q / step)
    own = JointLog(name="short", joint="j", time=t, position=read, torque=torque)
    found = fj.identify([own], JOINT, "j", law=law).estimates
    assert 0.7 < found["Fc_pos"].value <= found["Fs_pos"].value < 2.0
    assert status_of("Fs_pos", found) == "assumed"


def moves_at_rest(found) -> float:
    """Movement from 10 to 15 s after a load within the friction was put on, rad."""
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": law_parameters(found)})
    model = spec.compile()
    data, places = mujoco.MjData(model), []
    with fj.attach(model):
        data.qfrc_applied[0] = 0.4 * LEVEL
        while data.time < 15.0:
            mujoco.mj_step(model, data)
            if data.time > 10.0:
                places.append(data.qpos[0])
    return float(np.ptp(places))


def test_a_lower_assumed_breakaway_friction_keeps_what_the_logs_show():
    """The fall at the speeds of the logs, and the stiffness."""
    _, found = fitted(300.0, noise=0.1)
    high = replace(found.shape, excess=2.87, Vs=0.0037, delta=0.404)
    low = high.with_assumed_breakaway(0.33)

    def level(shape, v):
        return shape.excess * np.exp(-((v / shape.Vs) ** shape.delta))

    for v in (0.05, 0.1, 0.2):
        assert level(low, v) == pytest.approx(level(high, v), abs=0.02)
    before, after = (shape.parameters(1.0, 0.0).stiffness for shape in (high, low))
    assert after == pytest.approx(before)
