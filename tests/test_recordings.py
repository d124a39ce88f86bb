"""What several recordings of one joint say, and whether a joint is still as its report says.

The joints are MuJoCo's own: friction of its `dcmotor`, with numbers that change between recordings.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from command_line import run
from led import led
from reports import good

from frictionjoint import close_loop
from frictionjoint.control.controller import Controller
from frictionjoint.errors import LogError
from frictionjoint.files import toml_document
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.between import Between, moderated
from frictionjoint.recordings.drift import drift, known_of
from frictionjoint.recordings.estimate import Estimates, Known
from frictionjoint.recordings.in_report import with_recordings
from frictionjoint.recordings.numbers import numbers_of
from frictionjoint.refine.posterior import Posterior, numbers_in
from frictionjoint.rivals import LuGreParameters
from frictionjoint.simulate.carrier import install

STEP, EVERY, SECONDS = 5e-4, 8, 12.0
TIME = STEP * np.arange(int(SECONDS / STEP))
FC, FS, VS, SIGMA2 = 0.30, 0.36, 0.15, 0.08
ARM = """<mujoco><option timestep="0.0005" integrator="implicitfast"/><worldbody><body>
<joint name="elbow" axis="0 1 0" {joint}/><inertial pos="0.2 0 0" mass="0.5" diaginertia="1e-3 1e-3
1e-3"/></body></worldbody>{end}</mujoco>"""


def joint_with(Fc: float = FC, sigma2: float = SIGMA2) -> mujoco.MjModel:
    """A joint with MuJoCo's own friction."""
    return mujoco.MjModel.from_xml_string(
        ARM.format(
            joint=f'damping="{sigma2}"',
            end='<actuator><dcmotor joint="elbow" input="none" motorconst="1e-6" resistance="1" '
            f'lugre="300 0.5 {Fc} {Fc + FS - FC} {VS}"/></actuator>',
        )
    )


def noisy(
    name: str, torque: np.ndarray, position: np.ndarray, rng: np.random.Generator, noise: float
) -> JointLog:
    kept = slice(None, None, EVERY)
    time, q, tau = TIME[kept], position[kept], torque[kept]
    q = q + rng.normal(0.0, 2e-5, len(q))
    tau = tau + rng.normal(0.0, noise, len(tau))
    return JointLog(name=name, joint="elbow", time=time, position=q, torque=tau)


def recording(seed: int, Fc: float = FC, sigma2: float = SIGMA2, noise: float = 0.01) -> JointLog:
    """A joint of MuJoCo under a random sum of sines, with noise of torque and position."""
    rng = np.random.default_rng(seed)
    w, a, p = (rng.uniform(*ends, (5, 1)) for ends in ((2.0, 12.0), (0.2, 0.4), (0.0, 6.0)))
    target = np.sum(2.0 * a * np.sin(w * TIME + p), axis=0)
    moved = led(joint_with(Fc, sigma2), target, kp=0.5, bears=True)
    return noisy(f"log{seed}", *moved, rng, noise)


def staircase() -> JointLog:
    """Steps with rests between them, which a stiff controller makes."""
    stairs = 0.3 * np.array([0, 1, 2, 3, 2, 1, 0, -1, -2, -1, 0])
    rest, moved = (TIME / 0.8).astype(int) % 10, np.clip((TIME % 0.8) / 0.17, 0.0, 1.0)
    smooth = np.where(moved < 0.5, 2.0 * moved**2, 1.0 - 2.0 * (1.0 - moved) ** 2)
    target = stairs[rest] + (stairs[rest + 1] - stairs[rest]) * smooth
    moved = led(joint_with(), target, kp=30.0, kd=1.3, bears=True)
    return noisy("staircase", *moved, np.random.default_rng(5), 0.01)


def pushed(log: JointLog) -> JointLog:
    """The same motion with something that pushes the joint along, by more than it brakes."""
    return replace(log, torque=log.torque - 0.3 * np.gradient(log.position, log.time))


def known(error: float = 0.01, Fs: float = FS) -> Known:
    """The friction that the joints have at first, as a report has it."""
    law = LuGreParameters.symmetric(
        Fs=Fs, Fc=FC, Vs=VS, sigma2=SIGMA2, sigma0=300.0, sigma1=0.5, delta=2.0
    )
    spec = mujoco.MjSpec.from_string(ARM.format(joint="", end=""))
    install(spec, {"elbow": law})
    spec.compile()
    content = toml_document(law, ()).unwrap()
    factor = np.diag(error * np.abs(numbers_in(content)))
    return Known(spec.to_xml(), "elbow", Posterior(content, factor))


def value(found, name):
    i = [n.name for n in found.numbers].index(name)
    return found.value[i], found.stderr[i]


def test_a_recording_says_what_changed() -> None:
    before = Estimates(known(), recording(1))
    after = Estimates(known(), recording(2, Fc=0.36, sigma2=0.10))
    assert value(before, "Fc")[0] == pytest.approx(FC, rel=0.03)
    assert value(before, "sigma2")[0] == pytest.approx(SIGMA2, rel=0.06)
    assert value(after, "Fc")[0] == pytest.approx(0.36, rel=0.03)
    assert value(after, "sigma2")[0] == pytest.approx(0.10, rel=0.08)
    assert 0.0 < value(after, "Fc")[1] < 0.01


def test_a_number_that_the_report_assumes_has_not_changed() -> None:
    log = [recording(2, Fc=0.36, sigma2=0.10)]
    states = {x.number: x.state for x in drift(known(), log)}
    assert states["Fc"] == "changed"
    assumed = replace(known(), undetermined=frozenset({"Fc_pos", "Fc_neg"}))
    states = {x.number: x.state for x in drift(assumed, log)}
    assert (states["Fc"], states["sigma2"]) == ("not resolvable", "changed")


def test_where_an_effect_is_zero_is_a_choice_and_is_not_compared() -> None:
    """Freed, a reference temperature takes the place of the friction level."""
    table = {"effect": "temperature-dependent", "form": 27, "T0": 30.0, "scale": 20.0}
    content = known().posterior.content | {"effects": [table | {"level": 0.1, "viscous": 0.05}]}
    names = {x.name for x in numbers_of(content)}
    assert {"Fc", "temperature-dependent level", "temperature-dependent scale"} <= names
    assert "temperature-dependent T0" not in names


def test_rests_do_not_outweigh_the_motion_between_them() -> None:
    """In the rests, two thirds of the samples, the position hardly determines the torque."""
    found = Estimates(known(), staircase())
    for name, true in (("Fc", FC), ("Vs", VS), ("sigma2", SIGMA2)):
        now, stderr = value(found, name)
        assert abs(now - true) < 4.0 * stderr, name
        assert now == pytest.approx(true, rel=0.15), name


def test_a_number_that_changes_no_torque_is_not_resolvable() -> None:
    logs = [recording(1), recording(2)]
    for some in (logs[:1], logs):
        found = {x.number: x for x in drift(known(Fs=FC), some)}
        assert (found["Vs"].state, found["Vs"].now) == ("not resolvable", None)
        assert found["sigma2"].state != "not resolvable"
    # a joint that something pushes along: viscous friction cannot be negative
    assert {x.number: x.now for x in drift(known(), [pushed(logs[0])])}["sigma2"] is None


def report(folder: Path) -> Path:
    """A report of the joint in a folder."""
    k = known()
    folder.mkdir()
    (folder / "model.xml").write_text(str(k.model))
    (folder / "report.json").write_text(json.dumps(good(posterior=k.posterior.to_dict())))
    return folder


def save(log: JointLog, path: Path, drive: str = "torque_nm") -> None:
    rows = np.column_stack([log.time, log.position, log.torque])
    header = f"time_s,position_rad,{drive}"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9g")


def test_drift_is_told_from_none_and_from_what_a_log_does_not_show(tmp_path: Path) -> None:
    folder = report(tmp_path / "report")
    save(recording(3), tmp_path / "same.csv")
    save(recording(4, Fc=0.38), tmp_path / "worn.csv")
    same = run("drift", folder, "same.csv", "--json", cwd=tmp_path)
    assert same.returncode == 0, same.stderr
    states = {x["number"]: x["state"] for x in json.loads(same.stdout)["numbers"]}
    assert states["Fc"] == states["sigma2"] == "confirmed"
    worn = run("drift", folder, "worn.csv", cwd=tmp_path)
    assert worn.returncode == 1
    assert {"Fc", "changed"} <= {*worn.stdout.split()}
    save(recording(5, Fc=0.38, noise=5.0), tmp_path / "noisy.csv")
    noisy = run("drift", folder, "noisy.csv", cwd=tmp_path).stdout.splitlines()[3:-1]
    assert all("–" in row and "not resolvable" in row for row in noisy), noisy
    # no law is exact: 3% more is not called a change, however small the noise
    more = drift(known_of(folder), [recording(7, Fc=1.03 * FC, noise=0.001)])
    assert next(x.state for x in more if x.number == "Fc") == "confirmed"
    with pytest.raises(LogError, match="too little motion"):
        drift(known_of(folder), [recording(5).part(slice(0, 60), "")])
    # a log of target and position is compared by the controller next to the report
    kp = 40.0
    log = recording(4, Fc=0.38)
    target = log.position + log.torque / kp
    save(replace(log, torque=target), tmp_path / "servo.csv", "target_rad")
    servo = run("drift", folder, "servo.csv", cwd=tmp_path)
    assert servo.returncode == 2
    assert "no measured drive" in servo.stderr
    controller = Controller(output="torque_nm", kp=kp, source="test")
    (folder / "controller.toml").write_text(controller.to_toml())
    assert run("drift", folder, "servo.csv", cwd=tmp_path).returncode == 1
    assert run("drift", tmp_path / "no", "same.csv", cwd=tmp_path).returncode == 2


@dataclass(frozen=True)
class Stated:
    """The part of a report that recordings are compared by."""

    joint: str
    mjcf: str
    posterior: Posterior | None
    notes: tuple[str, ...] = ()
    slide: bool = False
    controller: Controller | None = None
    recordings: tuple[dict, ...] = ()
    added: tuple[SimpleNamespace, ...] = ()
    bandwidth_hz: float = np.inf
    unexplained: tuple[tuple[str, float], ...] = ()

    @classmethod
    def of(cls, k: Known) -> "Stated":
        """What a report states of a known friction."""
        return cls("elbow", str(k.model), k.posterior)


def test_a_report_states_what_differs_and_samples_spread_as_much() -> None:
    stated = Stated.of(known())
    levels = (0.24, 0.36, 0.28, 0.34)
    logs = [recording(20 + i, Fc=Fc) for i, Fc in enumerate(levels)]
    found = with_recordings(stated, logs)
    rows = {row["number"]: row for row in found.recordings}
    assert rows["Fc"]["deviation"] == pytest.approx(np.std(levels, ddof=1), rel=0.15)
    assert rows["sigma2"]["deviation"] < 0.1 * SIGMA2
    assert [x["log"] for x in rows["Fc"]["recordings"]] == [log.name for log in logs]
    assert "Between recordings, Coulomb friction varies by 0.05" in found.notes[0]
    assert " N m, " in found.notes[0]
    assert "seem so" not in found.notes[0]
    drifting = replace(stated, unexplained=(("time", 0.9),))
    assert "seem so" in with_recordings(drifting, logs).notes[0]
    drawn = [x.parameters.Fc_pos for x in found.posterior.sample(300)]
    assert np.std(drawn) == pytest.approx(np.std(levels, ddof=1), rel=0.25)
    assert with_recordings(stated, logs[:2]) is stated
    # a torque that the result corrects is not compared as measured
    corrected = replace(stated, added=(SimpleNamespace(effect="torque-gain"),))
    (note,) = with_recordings(corrected, logs).notes
    assert "wrong motor constant" in note
    # a joint that something pushes along: its viscous friction would be negative
    found = with_recordings(stated, [pushed(log) for log in logs])
    said = {row["number"] for row in found.recordings}
    assert "Fc" in said
    assert "sigma2" not in said


def test_differences_within_the_error_of_a_law_are_not_stated() -> None:
    """Fc of three recordings differs by 2%, and not by chance: a law errs by as much."""
    logs = [recording(50 + i, Fc=x) for i, x in enumerate((0.294, 0.3, 0.306))]
    found = with_recordings(Stated.of(known()), logs)
    row = next(row for row in found.recordings if row["number"] == "Fc")
    assert row["p_value"] < 0.01
    assert not [note for note in found.notes if "Coulomb friction varies" in note]


def test_a_parameter_that_hardly_helps_does_not_differ(monkeypatch: pytest.MonkeyPatch) -> None:
    """Static friction of three recordings, many standard errors apart."""
    k = known()
    i = [x.name for x in k.numbers].index("Fs - Fc")
    one = np.ones(len(k.values))
    alike = {"informed": one, "stderr": 0.001 * one, "independent": 0.001 * one, "dof": 20.0}
    alike |= {"log": "log", "temperature": np.nan, "speed": 1.0, "direction": 0.0, "load": 1.0}

    def told(squares: float) -> bool:
        values = []
        for level in (0.05, 0.06, 0.07):
            value = k.values.copy()
            value[i] = level
            values.append(SimpleNamespace(value=value, squares=squares, **alike))
        monkeypatch.setattr("frictionjoint.recordings.in_report.Estimates", lambda *_: values.pop())
        notes = with_recordings(Stated.of(k), [recording(1)] * 3).notes
        return any("above Coulomb" in x for x in notes)

    assert told(squares=100.0)
    assert not told(squares=10000.0)


def test_recordings_that_are_not_compared_are_said() -> None:
    stated = Stated.of(known(error=0.0))
    logs = [recording(30 + i) for i in range(3)]
    deaf = with_recordings(stated, [recording(30 + i, noise=15.0) for i in range(3)])
    assert deaf.recordings == ()
    bare = [replace(x, torque=None, target=x.position) for x in logs]
    (note,) = with_recordings(stated, bare).notes
    assert "no measured drive" in note
    assert "N m (N) is unknown" in with_recordings(replace(stated, posterior=None), logs).notes[0]


@pytest.mark.parametrize("tau", [0.0, 0.2])
@pytest.mark.parametrize("apart", [0.0, 0.5])
def test_intervals_over_recordings_hold_what_they_say(tau: float, apart: float) -> None:
    """Of fleets of six recordings, whose errors are estimated from blocks of time.

    `apart`: how much the factor by which correlation in time adds to the variance differs between
    recordings.
    """
    rng = np.random.default_rng(0)
    inside, alarms = [], []
    for _ in range(700):
        independent = rng.uniform(0.03, 0.1, 6) ** 2
        variance = 3.0 * independent * np.exp(apart * rng.standard_normal(6))
        y = 1.0 + tau * rng.standard_normal(6) + np.sqrt(variance) * rng.standard_normal(6)
        block = variance * rng.chisquare(6, 6) / 6.0
        one, shared = moderated(block, independent, np.full(6, 6.0))
        found = Between(y, np.sqrt(one), shared)
        inside.append(found.interval[0] < 1.0 < found.interval[1])
        alarms.append(found.p_value < 0.05)
    assert 0.90 < np.mean(inside) < 0.98
    assert np.mean(alarms) < 0.08 if tau == 0.0 else np.mean(alarms) > 0.08


def test_recordings_of_another_load_are_left_out() -> None:
    arm = ARM.format(joint="", end="")
    logs = [recording(i, Fc=Fc).part(slice(0, 1500), "") for i, Fc in ((40, 0.25), (41, 0.35))]
    logs += [recording(i).part(slice(0, 1500), "") for i in (42, 50)]
    found = close_loop(logs, {"log4*": arm, "log5*": arm}, "elbow", [], law="lugre", refine=False)
    rows = {row["number"]: row for row in found.recordings}
    assert [x["log"][:5] for x in rows["Fc"]["recordings"]] == ["log40", "log41", "log42"]
    assert any("only under the load of log40" in note for note in found.notes)
