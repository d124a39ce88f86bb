"""A simulation that runs away is no result: no figure of it is stated, and nothing is explained."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from arms.arm import random_arm
from arms.fitted import joint_logs

import frictionjoint as fj
from frictionjoint.diagnose import close_loop as loop
from frictionjoint.diagnose.notes import DIVERGES
from frictionjoint.diagnose.report_parts import verdict
from frictionjoint.effects import temperature_dependent
from frictionjoint.effects.measurement_delay import EFFECT as DELAY
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog
from frictionjoint.model_files import read_spec
from frictionjoint.replay.free_runs import Replay, replay, replay_joints, simulated_whole
from frictionjoint.report.joint_report import Rms
from frictionjoint.robot.joint import first_fit

N, DT = 2000, 4e-3
# errors of torque and position before and after
BETTER = (Rms(2.0, 2.0), Rms(None, None)), (Rms(0.1, 0.1), Rms(None, None))
JOINT = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="j" axis="0 1 0"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 0.05 1"/></body></worldbody></mujoco>"""


def log(celsius: float | np.ndarray = 40.0) -> JointLog:
    """Friction in closed form, whose level falls with temperature."""
    t = DT * np.arange(N)
    w, size = 2 * np.pi * np.array([[0.3], [0.7], [1.3]]), np.array([[0.5], [0.2], [0.1]])
    q = np.sum(size * np.sin(w * t), axis=0)
    v = np.sum(size * w * np.cos(w * t), axis=0)
    a = -np.sum(size * w**2 * np.sin(w * t), axis=0)
    noise = 0.02 * np.random.default_rng(1).standard_normal(N)
    level = 0.5 * np.exp((40.0 - celsius) / 30.0)
    torque = 0.05 * a + level * np.tanh(v / 0.01) + 0.1 * v + noise
    known = None if np.isscalar(celsius) else celsius
    return JointLog(name="log", joint="j", time=t, position=q, torque=torque, temperature=known)


def test_a_run_has_temperature_and_delay_of_its_log() -> None:
    body, own = RigidBody(JOINT, "j"), log()
    late = replace(own, position=np.interp(own.time - 0.02, own.time, own.position))
    falling = EffectTerm(temperature_dependent.EFFECT, (40.0, 30.0))
    cases = (log(np.linspace(20.0, 60.0, N)), falling), (late, EffectTerm(DELAY, (0.02,)))
    for one, term in cases:
        prepared = prepare([one], body)
        alone = fit(prepared)
        whole = refit(prepared, (term,), alone.shape)
        assert simulated_whole(whole, body.armature)
        assert replay(prepared, body, whole).rms < 0.2 * replay(prepared, body, alone).rms


def test_runs_that_leave_the_travel_diverge() -> None:
    near = Replay((np.array([0.1, np.nan, -0.2]),), travel=1.0)
    assert not near.diverges
    assert near.stated == near.rms == pytest.approx(np.sqrt(0.025))
    far = Replay((np.array([0.1]), np.array([18650.0])), travel=1.0)
    assert far.diverges
    assert far.stated is None
    assert Replay((np.full(3, np.nan),), travel=1.0).stated is None


def test_runs_that_become_unstable_diverge_and_are_not_heard_of(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """MuJoCo begins such a run anew at the model's pose, which may be near what was measured."""
    monkeypatch.chdir(tmp_path)
    body = RigidBody(JOINT, "j")
    prepared = prepare([log()], body)
    fitted = fit(prepared)
    assert not replay(prepared, body, fitted).diverges
    (segment,) = prepared.segments
    noted = replace(segment, others={"normal_load": segment.drive})
    again = replay(replace(prepared, segments=(noted,)), body, fitted)
    assert again.rms == replay(prepared, body, fitted).rms
    # MuJoCo's own springs are explicit, and this one is far too stiff for the time step
    sprung = RigidBody(JOINT.replace("<joint", '<joint stiffness="1e9"'), "j")
    found = replay(prepared, sprung, fitted)
    assert np.isinf(found.errors[0]).any()
    assert found.diverges
    assert found.runs.max() == pytest.approx(found.travel**2)
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")


def test_joints_of_an_arm_run_together_or_next_to_one_on_its_measured_path() -> None:
    arm = random_arm(4, 2)
    logs = joint_logs(arm, (1,), 5.0)
    joints = {name: first_fit(own, arm.believed, name, None) for name, own in logs.items()}
    for names in (["j1", "j2"], ["j2"]):
        segments = {n: joints[n].prepared.segments[0] for n in names}
        fits = {n: joints[n].fit for n in names}
        found = replay_joints(read_spec(arm.believed), [segments], fits, {})
        assert len(found.errors) == len(names)
        assert found.rms < 0.01 * found.travel


def test_a_report_has_no_figure_of_a_diverging_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*arguments: Any) -> Replay:
        found = replay(*arguments)
        return replace(found, errors=tuple(1e5 * e for e in found.errors))

    monkeypatch.setattr(loop, "replay", away)
    report = fj.close_loop([log()], JOINT, "j")
    assert (report.after_replay.fit, report.after_replay.held_out) == (None, None)
    assert report.replay_interval is None
    assert DIVERGES in report.notes


def test_what_diverges_is_not_explained() -> None:
    found: Any = SimpleNamespace(findings=("spring",), unexplained=())
    assert verdict(found, *BETTER, diverges=True) == "partly-explained"


def test_white_residuals_far_above_the_noise_are_not_explained() -> None:
    rest = np.random.default_rng(0).standard_normal(1000)

    def said(noise: float) -> str:
        of_log = SimpleNamespace(torque=noise, left=lambda _: (noise**2, 0))
        part = SimpleNamespace(bandwidth_hz=10.0, dt=0.05, step=1, noise=of_log)
        final = SimpleNamespace(
            effects=(),
            layout=None,
            residual=rest,
            weight=np.ones(1000),
            log_index=np.zeros(1000, dtype=int),
            rms_in_motion=1.0,
            target_rms=100.0,
            gain=1.0,
        )
        found: Any = SimpleNamespace(
            findings=("spring",),
            unexplained=(),
            final=final,
            prepared=SimpleNamespace(segments=[part]),
        )
        return verdict(found, *BETTER, diverges=False)

    assert said(1.0) == "explained"
    assert said(0.1) == "partly-explained"
    # no instrument has so little noise, so that its level is unknown
    assert said(1e-4) == "explained"
