"""Logs that say little about themselves: no header, no times, no position, signals in rows."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from frictionjoint.errors import LogError
from frictionjoint.measured.readers import read_log
from frictionjoint.measured.several_files import read_joined
from frictionjoint.measured.table import ReadOptions

T = np.arange(300) / 200.0
Q = 0.4 * np.sin(3.0 * T)
V = 1.2 * np.cos(3.0 * T)
TAU = 0.3 * np.tanh(V / 0.01) + 0.1 * V
BY_NUMBER = {"time_s": "1", "position_rad": "2", "torque_nm": "3"}


@pytest.mark.parametrize("separator", [",", ", ", ";", "\t", "   "])
@pytest.mark.parametrize("above", ["", "# rig 3\n", "% volts and\n% radians\n"])
@pytest.mark.parametrize("end", ["", "t"])
def test_columns_of_a_file_without_header_have_numbers(
    tmp_path: Path, separator: str, above: str, end: str
) -> None:
    path = tmp_path / "a.txt"
    mark = separator.strip(" ") if end else ""
    rows = (separator.join(f"{x:+.9e}" for x in row) + mark for row in zip(T, Q, TAU, strict=True))
    path.write_text(above + "\n".join(rows) + "\n")
    log = read_log(path, columns=BY_NUMBER)
    np.testing.assert_allclose(log.position, Q, atol=1e-8)
    assert log.torque is not None
    np.testing.assert_allclose(log.torque, TAU, atol=1e-8)
    with pytest.raises(LogError, match="it has no header: its columns are numbered, 1 to 3"):
        read_log(path)


def test_a_cell_that_is_no_number_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = [f"{a},{b},{c}" for a, b, c in zip(T, Q, TAU, strict=True)]
    lines[7] = "0.1,often,0.2"
    path.write_text("\n".join(lines))
    with pytest.raises(LogError, match=r"a\.csv: .*'often'.*row 7, column 2"):
        read_log(path, columns=BY_NUMBER)


@pytest.mark.parametrize("rate", ["200Hz", "0.2kHz", "200 hz"])
def test_a_sample_rate_stands_for_times(tmp_path: Path, rate: str) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([Q, TAU]), header="q,tau", delimiter=",", comments="")
    log = read_log(path, columns={"time_s": rate, "position_rad": "q", "torque_nm": "tau"})
    np.testing.assert_allclose(log.time, T, atol=1e-12)


@pytest.mark.parametrize("slide", [False, True])
def test_a_bench_that_records_speed_only_has_its_position_integrated(
    tmp_path: Path, slide: bool
) -> None:
    path = tmp_path / "a.csv"
    names = "time_s,velocity_m_s,force_n" if slide else "time_s,velocity_rad_s,torque_nm"
    np.savetxt(path, np.column_stack([T, V, TAU]), header=names, delimiter=",", comments="")
    log = read_log(path)
    np.testing.assert_allclose(log.position, Q, atol=1e-4)
    assert log.slide == slide
    assert any("integrated from the velocity" in note for note in log.notes)


def test_a_message_names_all_that_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Time [s],Motor Angle,Speed,Torque (Nm)\n0,0,1,1\n1,1,1,1\n")
    wanted = (
        "--column 'time_s=Time [s]' --column 'position_rad=Motor Angle' "
        "--column 'torque_nm=Torque (Nm)'"
    )
    with pytest.raises(LogError) as error:
        read_log(path)
    assert wanted in str(error.value)


def test_files_whose_rows_belong_together(tmp_path: Path) -> None:
    savemat(tmp_path / "q.mat", {"q": np.column_stack([Q, V])})
    savemat(tmp_path / "t.mat", {"t": T})
    np.savetxt(tmp_path / "tau.csv", np.column_stack([TAU, Q]), delimiter=",")
    files = [tmp_path / name for name in ("q.mat", "t.mat", "tau.csv")]
    columns = {"time_s": "t", "position_rad": "q[0]", "torque_nm": "tau[0]"}
    log = read_joined(files, how=ReadOptions(columns))
    np.testing.assert_allclose(log.position, Q)
    assert log.torque is not None
    np.testing.assert_allclose(log.torque, TAU)
    (tmp_path / "t.mat").unlink()
    log = read_joined([files[0], files[2]], how=ReadOptions(columns | {"time_s": "200Hz"}))
    np.testing.assert_allclose(log.time, T, atol=1e-12)
    savemat(tmp_path / "q.mat", {"q": np.column_stack([Q, V])[:-3]})
    with pytest.raises(LogError, match=r"(297|300) numbers"):
        read_joined([files[0], files[2]], how=ReadOptions(columns | {"time_s": "200Hz"}))


@pytest.mark.parametrize("unit", ["-2", "0.5", "1e-2"])
def test_a_number_is_a_factor_to_si(tmp_path: Path, unit: str) -> None:
    path = tmp_path / "a.csv"
    names = "time_s,position_rad,torque_nm"
    np.savetxt(path, np.column_stack([T, Q, TAU]), header=names, delimiter=",", comments="")
    torque = read_log(path, units={"torque": unit}).torque
    assert torque is not None
    np.testing.assert_allclose(torque, float(unit) * TAU, atol=1e-12)
    with pytest.raises(LogError, match="factor to SI"):
        read_log(path, units={"torque": "0"})


def test_runs_of_one_clock_each_are_runs_of_one_log(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = np.column_stack([np.concatenate([T, T + 0.001]), np.tile(Q, 2), np.tile(TAU, 2)])
    np.savetxt(path, rows, delimiter=",")
    log = read_log(path, columns=BY_NUMBER)
    np.testing.assert_allclose(np.diff(log.time[:300]), np.diff(T), atol=1e-12)
    np.testing.assert_allclose(np.diff(log.time[300:]), np.diff(T), atol=1e-12)
    assert log.time[300] - log.time[299] > 0.4
    assert any("read as 2 runs" in note for note in log.notes)
    swapped = rows[:300].copy()
    swapped[[100, 101]] = swapped[[101, 100]]
    np.savetxt(path, swapped, delimiter=",")
    with pytest.raises(LogError, match="time must increase"):
        read_log(path, columns=BY_NUMBER)
