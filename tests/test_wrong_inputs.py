"""Wrong input: one line that names it and the fix, exit code 2, nothing written.

Every case goes through the command line and through Python. The gate stands before any fit, so that
each answers in a second.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from command_line import run

import frictionjoint as fj
from frictionjoint.errors import FrictionJointError
from frictionjoint.identify.design import solve
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

J, MGL, FC, SIGMA2 = 0.5, 6.0, 1.5, 0.4
N, DT = 6000, 2e-3

# A pendulum that hangs at zero: mass and distance make the gravity, the rest of J is its own.
PENDULUM = f"""
<mujoco><compiler angle="radian"/><worldbody><body><joint name="elbow" axis="0 1 0"/>
<inertial mass="2" pos="0 0 -{MGL / 2 / 9.81}" diaginertia="1 {J - MGL**2 / 2 / 9.81**2} 1"/>
</body></worldbody></mujoco>"""
ARM = """
<mujoco><compiler angle="radian"/><worldbody><body><joint name="shoulder" axis="0 1 0"/>
<geom type="capsule" size=".03" fromto="0 0 0 0 0 -.4" mass="2"/><body pos="0 0 -.4">
<joint name="elbow" axis="0 1 0"/><geom type="capsule" size=".03" fromto="0 0 0 0 0 -.4" mass="2"/>
<body pos="0 0 -.4"><joint name="lamp" axis="0 0 1"/><geom size=".02" mass=".1"/></body>
</body></body></worldbody></mujoco>"""
BALL = PENDULUM.replace('axis="0 1 0"', 'type="ball"')
SLIDE = PENDULUM.replace('axis="0 1 0"', 'type="slide" axis="1 0 0"')
RANGE = PENDULUM.replace('axis="0 1 0"', 'axis="0 1 0" range="-1.5 1.5"')
LIMIT = PENDULUM.replace('axis="0 1 0"', 'axis="0 1 0" actuatorfrcrange="-0.5 0.5"')

Table = dict[str, np.ndarray]


def table(seed: int = 0, n: int = N) -> Table:
    """A joint with friction that changes its side smoothly, in closed form."""
    rng = np.random.default_rng(seed)
    t = DT * np.arange(n)
    w, phase = 2 * np.pi * np.array([[0.3], [0.7], [1.3]]), rng.uniform(0.0, 6.0, (3, 1))
    size = np.array([[0.5], [0.2], [0.08]])
    q = np.sum(size * np.sin(w * t + phase), axis=0)
    v = np.sum(size * w * np.cos(w * t + phase), axis=0)
    a = -np.sum(size * w**2 * np.sin(w * t + phase), axis=0)
    torque = J * a + MGL * np.sin(q) + FC * np.tanh(v / 0.01) + SIGMA2 * v
    return {"time_s": t, "position_rad": q, "torque_nm": torque + 0.02 * rng.standard_normal(n)}


def text_of(columns: Table, header: bool = True) -> str:
    """A CSV."""
    rows = np.column_stack([np.asarray(x, dtype=float) for x in columns.values()])
    lines = [",".join(f"{x:.9g}" for x in row) for row in rows]
    return "\n".join(([",".join(columns)] if header else []) + lines) + "\n"


def scaled(**factors: float) -> Table:
    """The log with columns in another unit or of another sign."""
    return {name: x * factors.get(name, 1.0) for name, x in table().items()}


def changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Table:
    return {k: change(x) if k == name else x for k, x in table().items()}


def renamed(**names: str) -> Table:
    return {names.get(name, name): x for name, x in table().items()}


def with_column(name: str, x: np.ndarray) -> Table:
    return table() | {name: x}


def arm(*others: str) -> Table:
    """An arm's log; the other joints move too."""
    own = table()
    found = {"time_s": own["time_s"]}
    found |= {f"elbow.{k}": own[k] for k in ("position_rad", "torque_nm")}
    for i, name in enumerate(others):
        found[f"{name}.position_rad"] = 0.3 * np.sin((1.1 + i) * own["time_s"])
    return found


def noise() -> np.ndarray:
    return np.random.default_rng(3).standard_normal(N)


@dataclass(frozen=True)
class Wrong:
    """Files to write, the command, and what its one line must say."""

    says: tuple[str, ...]
    logs: tuple[Table | str, ...] = ()
    held_out: Table | str | float | None = None
    model: str = PENDULUM
    joint: str = "elbow"
    options: tuple[str, ...] = ()
    python: dict[str, Any] | None = None  # what of the options Python takes; None: not its matter


def wrong(*says: str, log: Table | str | None = None, **more: Any) -> Wrong:
    return Wrong(says, (table() if log is None else log,), **({"python": {}} | more))


ROWS = text_of(table()).splitlines()


def with_row(text: str) -> str:
    """The log with another row 9."""
    return "\n".join([*ROWS[:8], text, *ROWS[9:]])


CASES = {
    # signs
    "position reversed": wrong("wrong sign of position or torque", log=scaled(position_rad=-1.0)),
    "torque reversed": wrong("wrong sign of position or torque", log=scaled(torque_nm=-1.0)),
    "one log reversed": Wrong(
        ("log1 (first part): wrong sign",),
        (table(), {k: -x if k == "torque_nm" else x for k, x in table(1).items()}),
        python={},
    ),
    "current reversed": wrong("wrong sign of position or current", log={
        "current_a" if k == "torque_nm" else k: x for k, x in scaled(torque_nm=-1.0).items()}),
    # units
    "torque at the motor": wrong("0.01 times the load", "units", log=scaled(torque_nm=0.01)),
    "torque in mN m": wrong("times the load of the model", "mN m", log=scaled(torque_nm=1e3)),
    "torque beyond the actuators": wrong("limited to 0.5 N m", model=LIMIT),
    "position in degrees": wrong("not degrees", log=scaled(position_rad=57.3)),
    "position beyond the range": wrong("1.5", "degrees?", log=scaled(position_rad=57.3),
                                       model=RANGE.replace("-1.5 1.5", "-0.75 0.75")),
    "time in milliseconds": wrong("time_s", "--unit time=ms", log=scaled(time_s=1e3)),
    "time in nanoseconds": wrong("time_s", "--unit time=ns", log=scaled(time_s=1e9)),
    "velocity in degrees": wrong(
        "times as fast", "units", log=with_column("velocity_rad_s", 57.3 * np.gradient(
            table()["position_rad"], DT))
    ),
    # columns of something else
    "torque is noise": wrong("residual", "clock", log=changed("torque_nm", lambda x: noise())),
    "torque of another clock": wrong("residual", "clock", log=changed(
        "torque_nm", lambda x: np.roll(x, 1700))),
    "torque stands": wrong("constant at 2", log=changed("torque_nm", lambda x: 0 * x + 2.0)),
    "position stands": wrong("does not move", log=changed("position_rad", lambda x: 0 * x)),
    # wraps, gaps, clocks
    "position leaps": wrong("jumps from", "--wrap", log=changed(
        "position_rad", lambda x: x + 9.0 * (np.arange(N) > 3000))),
    "wrap is negative": wrong("--wrap -1", options=("--wrap", "-1"), python=None),
    "nothing between gaps": wrong("no part of 50 samples", log=changed(
        "time_s", lambda x: x + 3.0 * (np.arange(N) // 40))),
    "time runs backwards": wrong("row 12, time_s", "increase", log="\n".join(
        [*ROWS[:11], ROWS[4], *ROWS[11:]])),
    "a time twice": wrong("row 12, time_s", "repeats", log="\n".join(
        [*ROWS[:11], ROWS[10], *ROWS[11:]])),
    # joints
    "another joint missing": wrong("no position of shoulder", "--fixed shoulder=VALUE",
                                   log=arm("lamp"), model=ARM),
    "no joint named": wrong("no position of shoulder", model=ARM),
    "a joint misspelt": wrong("no joint 'shouldr' in the MJCF: 'shoulder'?",
                              log=arm("shouldr", "lamp"), model=ARM),
    "joint not in the log": wrong("no joint 'lamp'", "elbow", log=arm("shoulder"), model=ARM,
                                  joint="lamp"),
    "joint not in the model": wrong("'hip' in the MJCF; available joints: elbow", joint="hip"),
    "a pose of no joint": wrong("--fixed hip", "it has elbow", options=("--fixed", "hip=1"),
                                python={"fixed": {"hip": 1.0}}),
    "a pose of the joint itself": wrong("joint to identify", options=("--fixed", "elbow=1"),
                                        python={"fixed": {"elbow": 1.0}}),
    "a pose that is measured": wrong("contains its motion", log=arm("shoulder", "lamp"), model=ARM,
                                     options=("--fixed", "shoulder=1"),
                                     python={"fixed": {"shoulder": 1.0}}),
    "a pose that is no number": wrong("--fixed shoulder=up", "e.g. shoulder=0.3",
                                      options=("--fixed", "shoulder=up"), python=None),
    "a pose of many numbers": wrong("give one number", log=arm(), model=ARM,
                                    options=("--fixed", "shoulder=1,2"),
                                    python={"fixed": {"shoulder": [1.0, 2.0]}}),
    "a ball joint": wrong("is a ball joint", model=BALL),
    "a slide for a hinge's log": wrong("a slide in the MJCF", "position_m, force_n", model=SLIDE),
    # tables
    "no header": wrong("no header", "numbered, 1 to 3", "--column time_s=NUMBER",
                       log=text_of(table(), header=False)),
    "names of their own": wrong("it has t, q_meas, i", "time_s=t --column position_rad=q_meas",
                                log=renamed(time_s="t", position_rad="q_meas", torque_nm="i")),
    "names with other units": wrong("--column position_rad=position_deg --unit position=deg",
                                    "--column torque_nm=tau_mNm --unit torque=mNm",
                                    log=renamed(position_rad="position_deg", torque_nm="tau_mNm")),
    "no drive": wrong("'torque_nm' or 'voltage_v' or 'current_a'", "--column torque_nm=effort",
                      log=renamed(torque_nm="effort")),
    "a rate without its unit": wrong("no column '500'", "--column time_s=500Hz",
                                     options=("--column", "time_s=500"), python=None),
    "a map of a name near ours": wrong("--column time=clock", "'time_s'?",
                                       options=("--column", "time=clock"), python=None),
    "a map of a name like no other": wrong("known are time_s, position_rad",
                                           options=("--column", "x=y"), python=None),
    "a map the wrong way round": wrong("the standard name comes first, time_s=t",
                                       log=renamed(time_s="t"),
                                       options=("--column", "t=time_s"), python=None),
    "a unit twice": wrong("--unit position is given twice", options=(
        "--unit", "position=deg", "--unit", "position=rad"), python=None),
    "a rate of nothing": wrong("the rate must be above 0", options=("--column", "time_s=0Hz"),
                               python=None),
    "a joint of no name": wrong("no joint ''", joint="", python=None),
    "half a map": wrong("write ours=theirs", options=("--column", "time_s"), python=None),
    "a signal that is not there": wrong("no column 'n' for --signal", options=("--signal", "n"),
                                        python=None),
    "a signal that is used": wrong("omit it", options=("--signal", "torque_nm"), python=None),
    "a decimal comma": wrong("row 9, position_rad: '1,5'", "write decimal points",
                             log=with_row('0.014,"1,5",1')),
    "NaN": wrong("row 9, position_rad", "NaN", log=with_row("0.014,nan,1")),
    "a word": wrong("row 9, torque_nm", "'off'", log=with_row("0.014,0.1,off")),
    "an empty cell": wrong("row 9, position_rad", "empty", log=with_row("0.014,,1")),
    "an infinite number": wrong("row 9, torque_nm", "inf", log=with_row("0.014,0.1,inf")),
    "a column twice": wrong("'position_rad' appears twice", log="\n".join(
        ["time_s,position_rad,position_rad,torque_nm", *(f"{row},1" for row in ROWS[1:])])),
    "a force of a hinge": wrong("force_n and position_rad exclude each other",
                                log=with_column("force_n", noise())),
    "a row cut short": wrong("row 9: 2 cells", log=with_row("0.014,0.1")),
    "an empty file": wrong("empty", "header", log=""),
    "one sample": wrong("1 samples", "at least 50", log="\n".join(ROWS[:2])),
    # what goes with what
    "held out as it is fitted": wrong("the same samples as log0", held_out=table()),
    "a log twice": Wrong(("the same samples as log0", "give it once"), (table(), table()),
                         python={}),
    "mixed drives": Wrong(("log0 (first part) has a torque", "a voltage"),
                          (table(), renamed(torque_nm="voltage_v") | {
                              "position_rad": table(1)["position_rad"]}), python={}),
    "another drive held out": wrong("held has a voltage and log0 a torque",
                                    held_out=renamed(torque_nm="voltage_v") | {
                                        "position_rad": table(1)["position_rad"]}),
    "nearly all held out": wrong("held-out fraction is 0.99", "at most 0.8", held_out=0.99),
    "less than nothing held out": wrong("held-out fraction is -0.5", held_out=-0.5),
    "a seed below 0": wrong("seed", "0", options=("--seed", "-1"), python={"seed": -1}),
    "an unknown law": wrong("stribek", options=("--law", "stribek"), python={"law": "stribek"}),
    "a torque with a gain": wrong("the torque is measured", options=("--gain", "0.1"),
                                  python=None),
    "a gain of nothing": wrong("gain is 0", log=renamed(torque_nm="current_a"),
                               options=("--gain", "0"), python=None),
    "no such model": wrong("none.xml", options=("--model", "none.xml"), python=None),
    "a model that does not compile": wrong("cannot compile", model="<mujoco><wrldbody/></mujoco>"),
}  # fmt: skip


def own_model(case: Wrong, folder: Path) -> list[str | Path]:
    """The option of the case's model, where its options name no other."""
    return [] if "--model" in case.options else ["--model", folder / "model.xml"]


def files_of(case: Wrong, folder: Path) -> tuple[list[Path], Path | float | None]:
    """Write a case's logs and model; returns the logs and what is held out."""

    def write(name: str, log: Table | str) -> Path:
        path = folder / f"{name}.csv"
        path.write_text(log if isinstance(log, str) else text_of(log))
        return path

    (folder / "model.xml").write_text(case.model)
    logs = [write(f"log{i}", log) for i, log in enumerate(case.logs)]
    held = case.held_out
    return logs, write("held", held) if isinstance(held, dict | str) else held


def line_of(*arguments: object, cwd: Path) -> str:
    """The one line that a command ends with."""
    done = run(*arguments, cwd=cwd)
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.strip().splitlines()
    return line


@pytest.mark.parametrize("name", CASES)
def test_a_wrong_input_ends_in_one_line(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    logs, held = files_of(case, tmp_path)
    there = sorted(tmp_path.iterdir())
    command = ["close-loop", *logs, *own_model(case, tmp_path), "--joint", case.joint]
    command += ["--held-out", held] if held is not None else []
    line = line_of(*command, "--out", "deep/out", *case.options, cwd=tmp_path)
    for word in case.says:
        assert word in line
    assert sorted(tmp_path.iterdir()) == there, "nothing may be written"
    if case.python is not None:
        with pytest.raises(FrictionJointError) as caught:
            fj.close_loop(
                logs,
                tmp_path / "model.xml",
                case.joint,
                [held] if isinstance(held, Path) else 0.25 if held is None else held,
                **case.python,
            )
        for word in case.says:
            assert word in str(caught.value)


@pytest.mark.parametrize(
    "name", [n for n, c in CASES.items() if c.held_out is None and "--seed" not in c.options]
)
def test_identify_has_the_same_gate(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    logs, _ = files_of(case, tmp_path)
    command = ["identify", *logs, *own_model(case, tmp_path), "--joint", case.joint]
    line = line_of(*command, "--out", "out.toml", *case.options, cwd=tmp_path)
    for word in case.says:
        assert word.replace(" (first part)", "") in line
    assert not (tmp_path / "out.toml").exists()


@pytest.mark.parametrize(
    ("command", "out", "says"),
    [
        ("close-loop", "log0.csv", "a file has this name"),
        ("close-loop", "log0.csv/out", "cannot be written"),
        ("identify", ".", "a folder has this name"),
        ("identify", "log0.csv/out.toml", "cannot be written"),
    ],
)
def test_an_output_that_cannot_be_written_is_told_first(
    command: str, out: str, says: str, tmp_path: Path
) -> None:
    (tmp_path / "log0.csv").write_text("not even a log")
    model = ("--model", "m.xml", "--joint", "j")
    assert says in line_of(command, "log0.csv", *model, "--out", out, cwd=tmp_path)


TIME, POSITION, TORQUE = table().values()
LOG = JointLog(name="log", joint="elbow", time=TIME, position=POSITION, torque=TORQUE)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("log.csv", PENDULUM, "elbow"), "logs is one log: give a list"),
        (({"a": LOG}, PENDULUM, "elbow"), "logs is of type dict"),
        (([table()], PENDULUM, "elbow"), "logs is of type dict: a log is a path or a JointLog"),
        (
            ([LOG], mujoco.MjModel.from_xml_string(PENDULUM), "elbow"),
            "model is of type MjModel: give the path of an MJCF, or its text",
        ),
        (([LOG], PENDULUM, 0), "joint is of type int"),
        (([LOG], PENDULUM, "elbow", "held.csv"), "held_out is one log"),
        (([LOG], PENDULUM, "elbow", None), "held_out is of type NoneType"),
        (([LOG], PENDULUM, "elbow", 0.25, 0.5), "seed is of type float"),
    ],
)
def test_a_wrong_type_in_python_is_told_with_its_fix(arguments: tuple[Any, ...], says: str) -> None:
    with pytest.raises(TypeError) as caught:
        fj.close_loop(*arguments)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_other_public_functions_name_wrong_types_too() -> None:
    with pytest.raises(TypeError, match="log is of type dict: give the path"):
        read_log(table())  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="columns is of type list: give names by name"):
        read_log("log.csv", columns=["time_s"])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"torque is of type list: give a numpy array"):
        JointLog(name="log", joint="j", time=LOG.time, position=LOG.position, torque=[1.0])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="logs is one log: give a list"):
        fj.evaluate(PENDULUM, "log.csv")
    with pytest.raises(TypeError, match="fixed is of type list: give poses by name"):
        fj.close_loop([LOG], PENDULUM, "elbow", fixed=["shoulder"])  # type: ignore[arg-type]


def test_a_log_made_in_python_is_in_seconds_too() -> None:
    with pytest.raises(
        FrictionJointError, match=r"2 s between samples is too slow.*--unit time=ms"
    ):
        fj.close_loop([replace(LOG, time=1e3 * LOG.time)], PENDULUM, "elbow")
    with pytest.raises(FrictionJointError, match="no log to fit"):
        fj.close_loop([], PENDULUM, "elbow")


def test_a_joint_seen_in_few_positions_stands_still() -> None:
    time = np.arange(4000) * 1e-3
    position = np.round(6.0 * np.sin(7.0 * time)) * 5e-7
    log = JointLog(name="a", joint="elbow", time=time, position=position, torque=np.sin(5.0 * time))
    with pytest.raises(FrictionJointError, match="elbow: only 13 different positions"):
        fj.close_loop([log], PENDULUM, "elbow")


def test_a_coefficient_on_its_bound_is_on_it() -> None:
    """Of a log at constant velocity the viscosity came out at -4e-17, which no parameters take."""
    for seed in range(500):
        rng = np.random.default_rng(seed)
        one = np.ones(200)
        X = np.column_stack([0.2 * one + 1e-9 * rng.standard_normal(200), one, 1e-12 * one])
        y = rng.uniform(0.5, 2.0) * one + 0.1 * rng.standard_normal(200)
        low = np.array([0.0, 1e-12, 0.0])
        assert np.all(solve(X, y, low, np.full(3, np.inf)) >= low)
