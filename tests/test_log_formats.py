"""Logs as other programs write them: preambles, units, episodes, folders, one file per signal."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from test_readers import lerobot_set

from frictionjoint.cli.logs import LogOptions, log_paths
from frictionjoint.errors import LogError
from frictionjoint.measured.readers import joints_with_drive, log_files, read_log
from frictionjoint.measured.several_files import read_joined
from frictionjoint.measured.table import ReadOptions
from frictionjoint.model_files import compile_model, read_spec

N = 300
T = 0.01 * np.arange(N)
Q = 0.4 * np.sin(2.0 * T) + 0.05 * np.cos(9.0 * T)
TAU = 0.3 * np.sign(np.cos(2.0 * T)) + 0.01 * np.sin(40.0 * T)
NAMES = ("time_s", "position_rad", "torque_nm")


def csv(path: Path, before: str = "", end: str = "", names=NAMES, columns=(T, Q, TAU)) -> Path:
    rows = [",".join(repr(float(x)) for x in row) + end for row in zip(*columns, strict=True)]
    path.write_text("\n".join([before + ",".join(names) + end, *rows]) + "\n")
    return path


@pytest.mark.parametrize("end", ["", ",,,"])
@pytest.mark.parametrize(
    ("before", "skipped"),
    [
        ("", 0),
        ("Rig 3;operator\nfirmware,2.1\n", 2),
        ("DYNAMIXEL Graph,3,,\n\n-1,321,MX-106,Position\n", 3),
        ("# a remark\n", 0),
    ],
)
def test_what_stands_above_the_header_and_empty_columns_are_no_harm(
    tmp_path: Path, before: str, skipped: int, end: str
) -> None:
    log = read_log(csv(tmp_path / "a.csv", before, end))
    np.testing.assert_array_equal(log.position, Q)
    np.testing.assert_array_equal(log.torque, TAU)
    said = [note for note in log.notes if "skipped" in note]
    assert len(said) == (skipped > 0)
    assert all(f"1 to {skipped} skipped" in note for note in said)


def test_a_line_of_units_is_read_where_it_agrees(tmp_path: Path) -> None:
    path = csv(tmp_path / "a.csv")
    header, rest = path.read_text().split("\n", 1)
    path.write_text(f"{header}\ns,[rad],N m\n{rest}")
    np.testing.assert_array_equal(read_log(path).torque, TAU)
    path.write_text(f"{header}\ns,[deg],N m\n{rest}")
    with pytest.raises(LogError, match=r"row 2, position_rad: .*'\[deg\]'.*--unit position=UNIT"):
        read_log(path)
    np.testing.assert_allclose(read_log(path, units={"position": "deg"}).position, np.radians(Q))


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ({"time": "ms"}, {"time": 1e-3}),
        ({"position": "deg"}, {"position": np.pi / 180.0}),
        ({"position": "counts:4096"}, {"position": 2.0 * np.pi / 4096.0}),
        ({"torque": "kgf cm"}, {"torque": 0.0980665}),
        ({"torque": "mNm", "position": "rev"}, {"torque": 1e-3, "position": 2.0 * np.pi}),
    ],
)
def test_units_are_converted_where_they_are_named(
    tmp_path: Path, unit: dict[str, str], factor: dict[str, float]
) -> None:
    size = {name: 1.0 / factor.get(name, 1.0) for name in ("time", "position", "torque")}
    path = csv(
        tmp_path / "a.csv", columns=(size["time"] * T, size["position"] * Q, size["torque"] * TAU)
    )
    log = read_log(path, units=unit)
    for name, x in (("time", T), ("position", Q), ("torque", TAU)):
        np.testing.assert_allclose(getattr(log, name), x, rtol=1e-12, atol=1e-15)


def test_episodes_of_a_data_set_are_logs_of_their_own(tmp_path: Path) -> None:
    # nested names, as of converted G1 recordings
    folder = lerobot_set(tmp_path / "arm", 2, [["kElbow", "kWrist"]], 3)
    assert joints_with_drive(folder) == joints_with_drive(f"{folder}#2") == ["kElbow", "kWrist"]
    assert [x.name for x in log_files(folder)] == ["arm#0", "arm#1", "arm#2"]
    found = log_paths([folder], [f"{folder}#1"])
    assert [x.name for x in found.logs] == ["arm#0", "arm#2"]
    assert found.kept == [Path(f"{folder}#1")]
    read = LogOptions(unit=["position=deg"]).reader(found)
    logs = [read(path, "kElbow") for path in found.logs]
    assert [log.name for log in logs] == ["arm#0", "arm#2"]
    np.testing.assert_allclose(logs[1].position, 3.0 * logs[0].position, atol=1e-6)
    assert [x.name for x in log_files(f"{folder}#0-1")] == ["arm#0", "arm#1"]
    with pytest.raises(LogError, match="no episode 7, it has 0 to 2"):
        log_files(f"{folder}#0,7")
    with pytest.raises(LogError, match="several episodes, it has 0 to 2: name one as arm#N"):
        read(folder, "kElbow")
    with pytest.raises(LogError, match="give --unit position=deg or position=rad"):
        read_log(f"{folder}#0", "kElbow")
    with pytest.raises(LogError, match="--wrap and --drop-nan apply only to"):
        read_log(f"{folder}#0", "kElbow", wrap=25.0)


def test_a_folder_of_logs_is_all_of_them_but_those_held_out(tmp_path: Path) -> None:
    for name in ("b", "a", "c"):
        csv(tmp_path / f"{name}.csv")
    (tmp_path / "notes.md").write_text("rig 3")
    found = log_paths([tmp_path], [str(tmp_path / "c.csv"), "0.2"])
    assert [x.name for x in found.logs] == ["a.csv", "b.csv"]
    assert (found.kept, found.fraction) == ([tmp_path / "c.csv"], 0.2)
    (tmp_path / "empty").mkdir()
    with pytest.raises(LogError, match="a folder without a log"):
        log_paths([tmp_path / "empty"], [])


def test_a_file_per_signal_is_one_log(tmp_path: Path) -> None:
    """Each with its own clock: a torque twice as often, a target only where it changes."""
    fine = np.arange(-0.05, 2.9, 0.005)
    steps = np.array([0.0, 0.5, 1.0, 1.5, 2.0]).repeat(20) + np.tile(1e-4 * np.arange(20), 5)
    csv(tmp_path / "position_rad.csv", names=("time", "value"), columns=(T, Q))
    csv(tmp_path / "current.csv", names=("Time [s]", "value"), columns=(fine, np.sin(fine)))
    csv(tmp_path / "target_rad.csv", names=("t", "value"), columns=(steps, np.floor(2 * steps)))
    log = read_joined(sorted(tmp_path.iterdir()), how=ReadOptions({"torque_nm": "current"}))
    np.testing.assert_array_equal(log.time, T[log.time[0] <= T][: len(log.time)])
    assert log.time[-1] <= steps[-1]
    np.testing.assert_allclose(log.torque, np.sin(log.time), atol=1e-5)
    assert set(log.target) == {0.0, 1.0, 2.0, 3.0, 4.0}
    assert "joined from 3 files" in log.notes[0]
    found = log_paths([tmp_path], [], join=True)
    again = LogOptions(column=["torque_nm=current"]).reader(found)(found.logs[0], "j")
    np.testing.assert_array_equal(again.torque, log.torque)
    with pytest.raises(LogError, match="1 file, give one file per signal"):
        read_joined([tmp_path / "current.csv"])
    csv(tmp_path / "late.csv", names=("t", "torque_nm"), columns=(T + 1e3, TAU))
    with pytest.raises(LogError, match="do not overlap"):
        read_joined([tmp_path / "position_rad.csv", tmp_path / "late.csv"])


@pytest.mark.parametrize("worlds", [0, 3])
def test_a_rollout_of_isaac_lab_or_mjlab(tmp_path: Path, worlds: int) -> None:
    """Arrays of all joints, perhaps of several worlds; time by its step."""
    both = np.stack([Q, 0.2 * np.cos(T)], axis=1)
    arrays = {"joint_pos": both, "joint_pos_target": both + 0.01 * np.sin(T)[:, None]}
    arrays["applied_torque"] = np.stack([TAU, -TAU], axis=1)
    if worlds:
        arrays = {k: np.stack([x + i for i in range(worlds)], axis=1) for k, x in arrays.items()}
    path = tmp_path / "run.npz"
    np.savez(path, **arrays, dt=0.01, joint_names=np.array(["hip", "knee"]))
    assert joints_with_drive(path, {"world": "0"} if worlds else None) == ["hip", "knee"]
    log = read_log(path, "knee", {"world": "2"} if worlds else None)
    np.testing.assert_allclose(log.time, T)
    np.testing.assert_array_equal(log.torque, -TAU + (2 if worlds else 0))
    if worlds:
        with pytest.raises(LogError, match="3 worlds: name one of 0 to 2"):
            read_log(path, "knee")


def test_a_recording_of_mujocos_own_identification(tmp_path: Path) -> None:
    sysid = pytest.importorskip("mujoco.sysid", reason="needs mujoco[sysid]")
    model = compile_model(
        "<mujoco><worldbody><body><joint name='j'/><geom size='0.1'/></body></worldbody><actuator>"
        "<motor name='m' joint='j'/></actuator><sensor><jointpos name='pos' joint='j'/></sensor>"
        "</mujoco>"
    )
    sensors = sysid.TimeSeries.compute_all_sensor_mapping(model)
    controls = sysid.TimeSeries.compute_all_control_mapping(model)
    path = tmp_path / "one.npz"
    recorded = sysid.SystemTrajectory(
        model=model,
        control=sysid.TimeSeries(T, TAU[:, None], controls),
        sensordata=sysid.TimeSeries(T, Q[:, None], sensors),
        initial_state=np.zeros(3),
        state=None,
    )
    recorded.save_to_disk(path)
    log = read_log(path, "j", {"position_rad": "pos", "torque_nm": "m_ctrl"})
    np.testing.assert_allclose(log.position, Q)
    np.testing.assert_allclose(log.torque, TAU)
    with pytest.raises(LogError, match="it has time_s, pos, m_ctrl"):
        read_log(path, "j")


MESHES = """<mujoco><compiler meshdir="parts"/><asset><mesh name="link" file="link.stl"/></asset>
<worldbody><body><geom type="mesh" mesh="link"/></body><body><joint name="j"/>{}
<geom type="mesh" mesh="link"/></body></worldbody></mujoco>"""
INERTIA = '<inertial pos="0 0 -1" mass="2" diaginertia="1 1 1"/>'


def test_missing_meshes_do_not_matter_where_masses_are_given(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(MESHES.format(INERTIA))
    with pytest.warns(RuntimeWarning, match=r"not found: link\.stl; these shapes are ignored"):
        model = compile_model(path)
    assert (model.ngeom, model.nmesh, model.body_mass[2]) == (0, 0, 2.0)
    with pytest.raises(ValueError, match="Error opening file"):
        read_spec(path, whole=True)
    path.write_text(MESHES.format(""))
    with pytest.raises(ValueError, match=r"not found: link\.stl of links that move and have no"):
        compile_model(path)


SHARED = Path(os.environ.get("FRICTIONJOINT_CASES", Path(__file__).parents[2] / "shared/cases"))


@pytest.mark.skipif(not SHARED.is_dir(), reason="no ../shared/cases")
def test_files_that_people_sent() -> None:
    for name in ("plain", "trailing_commas", "preamble", "units_row"):
        assert len(read_log(SHARED / f"formats/{name}.csv").time) == 2000
    columns = {"time_s": "Time[ms]", "position_rad": "Present Position"}
    columns["target_rad"] = "Goal Position"
    units = {"time": "ms", "position": "counts:4096"}
    log = read_log(SHARED / "formats/dynamixel_wizard.csv", columns=columns, units=units)
    assert np.ptp(log.target) < 7.0
    assert len(read_log(SHARED / "formats/lerobot_nested", "kLeftElbow", {"unit": "rad"}).time) > 99


def test_parquet_without_pyarrow_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    path = tmp_path / "log.parquet"
    path.write_bytes(b"")
    with pytest.raises(LogError, match=r"pip install 'frictionjoint\[parquet\]'"):
        read_log(path)
