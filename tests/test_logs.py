"""Logs: what a JointLog refuses, splitting, and the line-exact errors of a table."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured.derivatives import speed_note
from frictionjoint.measured.log import JointLog, split_at_gaps, split_in_time
from frictionjoint.measured.long_logs import shortened
from frictionjoint.measured.readers import read_log

N, DT = 400, 0.002


def columns() -> dict[str, np.ndarray]:
    """A plausible hinge log."""
    t = DT * np.arange(N)
    return {
        "time_s": t,
        "position_rad": 0.6 * np.sin(9.0 * t),
        "velocity_rad_s": 5.4 * np.cos(9.0 * t),
        "torque_nm": 2.0 * np.sign(np.cos(9.0 * t)) + 0.1 * np.sin(60.0 * t),
    }


def write(path: Path, table: dict[str, np.ndarray]) -> Path:
    """A CSV whose numbers read back exactly."""
    rows = zip(*table.values(), strict=True)
    text = "\n".join([",".join(table), *(",".join(repr(float(x)) for x in row) for row in rows)])
    path.write_text(text + "\n")
    return path


def error_of(path: Path, joint: str | None = None) -> str:
    """The one line a log is refused with."""
    with pytest.raises(LogError) as caught:
        read_log(path, joint)
    text = str(caught.value)
    assert "\n" not in text
    assert path.name in text
    return text


def test_bom_crlf_quotes_blank_lines_and_semicolons_are_no_errors(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", columns())
    text = path.read_text().replace("time_s", '"time_s"').replace(",", ";").replace("\n", "\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + text.encode() + b"\r\n\r\n")
    assert len(read_log(path).time) == N


@pytest.mark.parametrize("ending", ["csv", "tsv", "txt", "dat"])
@pytest.mark.parametrize(("separator", "point"), [(";", ","), ("\t", "."), ("\t", ","), (" ", ".")])
def test_text_of_other_endings_separators_and_points_is_read(
    tmp_path: Path, ending: str, separator: str, point: str
) -> None:
    table = columns()
    path = tmp_path / f"log.{ending}"
    rows = [
        [repr(float(x)).replace(".", point) for x in row]
        for row in zip(*table.values(), strict=True)
    ]
    path.write_text("\n".join(separator.join(row) for row in [list(table), *rows]))
    log = read_log(path)
    np.testing.assert_array_equal(log.position, table["position_rad"])
    rows[7][1] = "often"
    path.write_text("\n".join(separator.join(row) for row in [list(table), *rows]))
    with pytest.raises(LogError, match=r"row 9, .*: 'often' is not a number"):
        read_log(path)


def rows_of(path: Path, kept: np.ndarray) -> JointLog:
    """A log of which some rows are there."""
    return read_log(write(path / "log.csv", {name: x[kept] for name, x in columns().items()}))


def test_a_log_is_split_at_a_gap(tmp_path: Path) -> None:
    kept = np.r_[0:100, 150:N]
    whole = rows_of(tmp_path, kept)
    parts = split_at_gaps(whole)
    assert [len(part.time) for part in parts] == [100, 250]
    assert [part.name for part in parts] == ["log (1 of 2)", "log (2 of 2)"]
    np.testing.assert_array_equal(
        np.concatenate([p.torque for p in parts]), columns()["torque_nm"][kept]
    )
    assert all(part.notes == ("log: a gap of 0.102 s at 0.3 s: split there.",) for part in parts)
    # what a fit takes is split in any case
    assert [part.name for part in shortened([whole])] == [part.name for part in parts]


def test_stretches_too_short_between_gaps_are_left_out_and_said(tmp_path: Path) -> None:
    kept = np.r_[0:100, 150:170, 220:N]
    parts = split_at_gaps(rows_of(tmp_path, kept))
    assert [len(part.time) for part in parts] == [100, 180]
    assert "and 1 more" in parts[0].notes[0]
    assert "20 samples in stretches under 50 are left out" in parts[0].notes[0]
    short = np.r_[0:40, 100:140, 200:240]
    with pytest.raises(LogError, match="no part of 50 samples"):
        split_at_gaps(rows_of(tmp_path, short))


@pytest.mark.parametrize(
    ("wrap", "declared"), [(2 * np.pi, None), (25.0, None), (25.0, 25.0), (9.0, 9.0)]
)
def test_a_wrapped_position_goes_on(tmp_path: Path, wrap: float, declared: float | None) -> None:
    table = columns()
    del table["velocity_rad_s"]
    true = 40.0 * np.sin(2.0 * table["time_s"])
    table["position_rad"] = (true + wrap / 2) % wrap - wrap / 2
    table["target_rad"] = (true + 0.01 + wrap / 2) % wrap - wrap / 2
    log = read_log(write(tmp_path / "log.csv", table), wrap=declared)
    np.testing.assert_allclose(log.position, true, atol=1e-9)
    np.testing.assert_allclose(log.target, true + 0.01, atol=1e-9)
    (note,) = log.notes
    assert note.startswith(f"log: position_rad wrapped at {wrap:.4g} in ")


def test_a_target_that_steps_and_a_position_of_one_count_are_not_wrapped(tmp_path: Path) -> None:
    table = columns()
    table["target_rad"] = np.where(table["time_s"] < 0.4, 0.6, -0.6) + 0.1 * table["time_s"]
    table["torque_nm"] = np.sign(table["torque_nm"]) + 1e-3 * np.arange(N)
    table["position_rad"] = np.where(np.sin(50.0 * table["time_s"]) > 0.0, 1.5e-3, 0.0)
    del table["velocity_rad_s"]
    log = read_log(write(tmp_path / "log.csv", table))
    np.testing.assert_array_equal(log.target, table["target_rad"])
    assert log.notes == ()


@pytest.mark.parametrize("times", [2, 10])
def test_rows_that_stand_several_times_are_taken_once(tmp_path: Path, times: int) -> None:
    table = columns()
    held = times * (np.arange(N) // times)
    for name in ("position_rad", "velocity_rad_s", "torque_nm"):
        table[name] = table[name][held]
    table["temperature_c"] = 20.0 + 0.01 * np.arange(N)
    log = read_log(write(tmp_path / "log.csv", table))
    np.testing.assert_array_equal(log.time, columns()["time_s"][::times])
    np.testing.assert_array_equal(log.position, columns()["position_rad"][::times])
    assert log.notes == (
        f"log: every row is repeated {times} times: {N // times} of {N} rows are used.",
    )


def test_readings_held_while_the_joint_moves_are_refused(tmp_path: Path) -> None:
    """They stand for up to nine rows, as where messages are lost."""
    table, rng = columns(), np.random.default_rng(3)
    fresh = np.cumsum(rng.integers(1, 10, N))
    at = fresh[np.searchsorted(fresh, np.arange(N), side="right") - 1].clip(0, N - 1)
    for name in ("position_rad", "torque_nm"):
        table[name] = table[name][at]
    del table["velocity_rad_s"]
    error = error_of(write(tmp_path / "log.csv", table))
    assert "position_rad" in error
    assert "of the travel lies in jumps" in error


def test_an_encoder_that_is_set_anew_is_refused(tmp_path: Path) -> None:
    table = columns()
    del table["velocity_rad_s"]
    table["position_rad"][N // 2 :] += 0.3
    error = error_of(write(tmp_path / "log.csv", table))
    assert f"at {table['time_s'][N // 2 - 1]:g} s" in error
    assert "set anew" in error


@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (0.97, False), (1.1, True)])
def test_a_velocity_that_is_not_the_slope_is_said(factor: float, said: bool) -> None:
    c = columns()
    rng = np.random.default_rng(1)
    log = replace(make_log(), velocity=factor * c["velocity_rad_s"] + 0.2 * rng.normal(size=N))
    notes = speed_note(log)
    assert bool(notes) is said
    if said:
        assert "1.1 times the slope of the position" in notes[0]


def test_a_known_motor_constant_makes_a_torque_of_a_current() -> None:
    c = columns()
    log = replace(make_log(), torque=None, current=c["torque_nm"] / 0.04)
    np.testing.assert_allclose(log.with_gain(0.04).torque, c["torque_nm"])
    assert log.with_gain(0.04).current is None
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(LogError, match="above 0"):
            log.with_gain(bad)
    with pytest.raises(LogError, match="the torque is measured"):
        make_log().with_gain(0.04)


def test_a_declared_signal_is_read_by_its_name(tmp_path: Path) -> None:
    table = columns()
    arm = {"time_s": table["time_s"], "bus": np.linspace(47.0, 48.0, N)}
    for i, joint in enumerate(("elbow", "wrist")):
        arm |= {f"{joint}.{name}": x for name, x in table.items() if name != "time_s"}
        arm[f"{joint}.load_n"] = np.full(N, 5.0 + i)
    path = write(tmp_path / "arm.csv", arm)
    log = read_log(path, "wrist", signals=["load_n", "bus", "elbow.torque_nm"])
    assert list(log.signals) == ["load_n", "bus", "elbow torque_nm"]
    np.testing.assert_array_equal(log.signals["load_n"], np.full(N, 6.0))
    np.testing.assert_array_equal(log.part(slice(0, 9), "").signals["bus"], arm["bus"][:9])
    for name, what in (("lod_n", "no column 'lod_n' for --signal"), ("torque_nm", "omit it")):
        with pytest.raises(LogError, match=what):
            read_log(path, "wrist", signals=[name])


def test_an_unknown_joint_lists_those_there(tmp_path: Path) -> None:
    table = columns()
    arm = {"time_s": table.pop("time_s")}
    for joint in ("elbow", "wrist"):
        arm |= {f"{joint}.{name}": x for name, x in table.items()}
    path = write(tmp_path / "arm.csv", arm)
    assert "no joint 'hip', it has elbow, wrist" in error_of(path, "hip")
    assert "elbow, wrist" in error_of(path)
    log = read_log(path, "wrist")
    assert log.joint == "wrist"
    np.testing.assert_array_equal(log.other_positions["elbow"], arm["elbow.position_rad"])
    np.testing.assert_array_equal(log.other_velocities["elbow"], arm["elbow.velocity_rad_s"])
    arm["elbow.position_rad"] = np.where(np.arange(N) == 11, np.nan, arm["elbow.position_rad"])
    assert "row 13, elbow.position_rad" in error_of(write(path, arm), "wrist")


def test_a_missing_file_and_an_unknown_kind(tmp_path: Path) -> None:
    assert "no such log" in error_of(tmp_path / "none.csv")
    (tmp_path / "log.doc").write_bytes(b"x\0")
    assert "unknown kind" in error_of(tmp_path / "log.doc")
    write(tmp_path / "log.csv", columns()).rename(tmp_path / "log.t")
    assert len(read_log(tmp_path / "log.t").time) == N


def make_log() -> JointLog:
    """The same log as an object."""
    c = columns()
    return JointLog(
        name="log",
        joint="elbow",
        time=c["time_s"],
        position=c["position_rad"],
        torque=c["torque_nm"],
        torque_enabled=np.ones(N, dtype=bool),
        other_positions={"wrist": c["position_rad"]},
        other_velocities={"wrist": c["velocity_rad_s"]},
    )


def test_splitting_holds_out_the_end() -> None:
    log = make_log()
    fit, held_out = split_in_time(log, 0.25)
    assert len(fit.time) == 300
    for name, whole in log.arrays().items():
        parts = (fit.arrays()[name], held_out.arrays()[name])
        np.testing.assert_array_equal(np.concatenate(parts), whole)
    assert fit.name != held_out.name
    assert fit.before is None
    for name, whole in log.arrays().items():
        np.testing.assert_array_equal(held_out.with_before().arrays()[name], whole)
    for fraction in (0.0, 1.0, -0.2, np.nan, 0.01, 0.99):
        with pytest.raises(LogError):
            split_in_time(log, fraction)


@pytest.mark.parametrize(
    "change",
    [
        {"torque": None},
        {"torque": np.ones(N - 1)},
        {"torque": np.full(N, np.nan)},
        {"time": np.zeros(N)},
        {"position": np.ones((N, 1))},
        {"other_positions": {"wrist": np.ones(3)}},
        {"joint": ""},
    ],
)
def test_no_half_valid_log_can_be_made(change: dict[str, object]) -> None:
    with pytest.raises(LogError):
        replace(make_log(), **change)  # type: ignore[arg-type]


def test_rows_left_out_do_not_move_the_rows_in_messages(tmp_path: Path) -> None:
    t = 0.01 * np.arange(200)
    log = {"time_s": t.copy(), "position_rad": np.sin(5 * t), "torque_nm": np.cos(5 * t)}
    np.savez(tmp_path / "short.npz", **log | {"torque_nm": log["torque_nm"][:190]})
    with pytest.raises(LogError, match="190 numbers, time_s has 200"):
        read_log(tmp_path / "short.npz", drop_nan=True)
    log["position_rad"][3], log["time_s"][100] = np.nan, t[99]
    np.savez(tmp_path / "log.npz", **log)
    with pytest.raises(LogError, match="row 101, time_s"):
        read_log(tmp_path / "log.npz", drop_nan=True)
