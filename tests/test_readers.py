"""Readers of other formats give the log that was written."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat
from torch_file import Plain, torch_file

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import joints_with_drive, read_log

T = 0.004 * np.arange(300)
TABLE = {
    "t": T,
    "q": 0.5 * np.sin(5.0 * T),
    "tau": np.sign(np.cos(5.0 * T)) + 0.1 * np.sin(40.0 * T),
    "note": np.ones(300),
}
MAPPING = {"time_s": "t", "position_rad": "q", "torque_nm": "tau"}


# what else a file of each kind may hold, or in another shape
KINDS: dict[str, dict[str, object]] = {
    "csv": {"note": 'a "word", and more'},
    "parquet": {"note": "text"},
    "npz": {},
    "mat": {"q": TABLE["q"][:, None], "model": {"gear": 3.0}},
}


def save(path: Path, **columns: object) -> Path:
    """A file of the kind that its name ends with."""
    if path.suffix in (".npz", ".mat"):
        np.savez(path, **columns) if path.suffix == ".npz" else savemat(path, columns)
    else:
        frame = pd.DataFrame(columns)
        frame.to_csv(path, index=False) if path.suffix == ".csv" else frame.to_parquet(path)
    return path


def holds_the_table(log: JointLog) -> None:
    np.testing.assert_array_equal(log.position, TABLE["q"])
    np.testing.assert_array_equal(log.torque, TABLE["tau"])


def refused(what: str, *arguments: object) -> None:
    with pytest.raises(LogError, match=what):
        read_log(*arguments)


@pytest.mark.parametrize("kind", KINDS)
def test_foreign_names_by_mapping(tmp_path: Path, kind: str) -> None:
    path = save(tmp_path / f"log.{kind}", **TABLE | KINDS[kind])
    log = read_log(path, "elbow", MAPPING)
    assert log.joint == "elbow"
    np.testing.assert_array_equal(log.time, T)
    holds_the_table(log)
    refused("'clock'", path, None, MAPPING | {"time_s": "clock"})
    refused("'angle'", path, None, MAPPING | {"angle": "q"})
    refused("no column 'time_s', it has", path)


@pytest.mark.parametrize("kind", ["npz", "mat"])
@pytest.mark.parametrize("across", [False, True], ids=["a row a sample", "a column a sample"])
def test_a_matrix_has_columns_by_number(tmp_path: Path, kind: str, across: bool) -> None:
    q = np.column_stack([TABLE["q"], 2.0 * TABLE["q"], 3.0 * TABLE["q"]])
    tau = np.column_stack([TABLE["tau"]] * 3)
    q_kept, tau_kept = (q.T, tau.T) if across else (q, tau)
    path = save(tmp_path / f"log.{kind}", t=T, q=q_kept, tau=tau_kept)
    joints = {"shoulder": 0, "elbow": 2}
    mapping = {"time_s": "t"}
    for joint, k in joints.items():
        mapping |= {f"{joint}.position_rad": f"q[{k}]", f"{joint}.torque_nm": f"tau[{k}]"}
    assert joints_with_drive(path, mapping) == sorted(joints)
    for joint, k in joints.items():
        np.testing.assert_array_equal(read_log(path, joint, mapping).position, q[:, k])
    for wrong, what in (
        ("q", r"log.*q: it is .*, name a column: q\[0\] to q\[2\]"),
        ("q[3]", r"q\[3\]: it is .*, name a column: q\[0\] to q\[2\]"),
        ("t[0]", r"t\[0\]: t is one column, name it without"),
        ("v[0]", r"no column 'v\[0\]', it has"),
    ):
        refused(what, path, "elbow", MAPPING | {"torque_nm": "tau[0]", "position_rad": wrong})


@pytest.mark.parametrize("kind", ["csv", "parquet"])
@pytest.mark.parametrize("zone", [None, "UTC", "Europe/Brussels"])
def test_times_may_be_dates(tmp_path: Path, kind: str, zone: str | None) -> None:
    moments = pd.Timestamp("2026-01-05 23:59:59", tz=zone) + pd.to_timedelta(T, unit="s")
    path = save(tmp_path / f"log.{kind}", **TABLE | {"t": moments})
    log = read_log(path, "elbow", MAPPING)
    np.testing.assert_allclose(log.time, T, atol=1e-9)
    holds_the_table(log)


@pytest.mark.parametrize("kind", KINDS)
def test_gains_that_stay_are_figures_of_the_log(tmp_path: Path, kind: str) -> None:
    gains = {"elbow.kp": np.full(300, 20.0), "kp": np.full(300, 9.0), "D": np.full(300, 0.5)}
    names = {"q": "elbow.position_rad", "tau": "elbow.target_rad"}
    table = {"time_s": T, "vin": np.linspace(11.0, 12.0, 300)} | gains
    table |= {ours: TABLE[theirs] for theirs, ours in names.items()}
    path = save(tmp_path / f"log.{kind}", **table)
    # a supply that falls is none
    assert read_log(path, columns={"kd": "D"}).metadata == {"kp": 20.0, "kd": 0.5}


def test_a_slide_and_a_current(tmp_path: Path) -> None:
    columns = {"time_s": T, "position_m": TABLE["q"], "current_a": TABLE["tau"]}
    log = read_log(save(tmp_path / "slide.csv", **columns))
    assert log.slide
    assert log.torque is None
    np.testing.assert_array_equal(log.current, TABLE["tau"])


CONTROLLER_STATE_NAME = "control_msgs/msg/JointTrajectoryControllerState"
CONTROLLER_STATE = """std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint reference
trajectory_msgs/JointTrajectoryPoint feedback
"""


def write_bag(
    path: Path, plugin: str, effort: bool = True, stamped: bool = True, command: str = ""
) -> Path:
    """A ROS 2 bag of two joints, with commands of a type; returns its folder."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="reading bags needs rosbags")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(CONTROLLER_STATE, CONTROLLER_STATE_NAME))
    kinds = SimpleNamespace(**{k.rpartition("/")[2]: v for k, v in store.types.items()})
    storage = rosbag2.StoragePlugin.MCAP if plugin == "mcap" else rosbag2.StoragePlugin.SQLITE3

    def header(recorded: int) -> object:
        stamp = divmod(recorded, 1_000_000_000) if stamped else (0, 0)
        return kinds.Header(stamp=kinds.Time(sec=stamp[0], nanosec=stamp[1]), frame_id="")

    none, zero = np.zeros(0), kinds.Duration(sec=0, nanosec=0)

    def joint_state(recorded: int, position: np.ndarray, torque: np.ndarray = none) -> object:
        return kinds.JointState(header(recorded), ["elbow", "wrist"], position, none, torque)

    def controller_state(recorded: int, target: np.ndarray) -> object:
        points = (
            kinds.JointTrajectoryPoint(x, none, none, none, zero)
            for x in (target[::-1].copy(), np.zeros(2))
        )
        names = ["wrist", "elbow"]
        return kinds.JointTrajectoryControllerState(header(recorded), names, *points)

    with rosbag2.Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection("/arm", kinds.JointState.__msgtype__, typestore=store)
        told, state = kinds.JointTrajectoryControllerState, controller_state
        if command == "JointState":
            told, state = kinds.JointState, joint_state
        commands = command and writer.add_connection("/told", told.__msgtype__, typestore=store)
        for i in range(len(T)):
            recorded = 1_700_000_000_000_000_000 + 4_000_000 * i
            some = np.array([TABLE["tau"][i], 0.0]) if effort else np.zeros(0)
            message = joint_state(recorded, np.array([TABLE["q"][i], 0.1]), some)
            writer.write(connection, recorded, store.serialize_cdr(message, connection.msgtype))
            if command and i >= 3 and i % 2:  # every second sample, 1 ms later, from the fourth on
                later, target = recorded + 1_000_000, np.array([0.01 * i, -0.1])
                message = state(later, target)
                writer.write(commands, later, store.serialize_cdr(message, commands.msgtype))
    return path


@pytest.mark.parametrize("plugin", ["mcap", "db3"])
@pytest.mark.parametrize("stamped", [True, False])
def test_ros_bags(tmp_path: Path, plugin: str, stamped: bool) -> None:
    folder = write_bag(tmp_path / "bag", plugin, stamped=stamped)
    for path in (folder, next(folder.glob(f"*.{plugin}"))):
        log = read_log(path, "elbow")
        # the stamps' whole nanoseconds survive
        np.testing.assert_allclose(log.time, T, rtol=0, atol=1e-12)
        holds_the_table(log)
        assert log.velocity is None
        assert list(log.other_positions) == ["wrist"]
        assert read_log(path, "elbow", {"position_m": "position"}).slide
        refused("it has elbow, wrist", path, "hip")
        refused("name one with --joint: elbow, wrist", path, None)
        no_topic = "no sensor_msgs/msg/JointState topic named /leg"
        refused(no_topic, path, "elbow", {"topic": "/leg"})


def test_fields_of_any_message_are_named(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "bag", "mcap")
    fields = {"position_rad": "position[0]", "torque_nm": "effort[0]"}
    log = read_log(path, columns=fields)
    np.testing.assert_allclose(log.time, T, rtol=0, atol=1e-6)
    holds_the_table(log)
    for wrong, what in (
        ({"position_rad": "angle"}, "field is missing"),
        ({"position_rad": "position[9]"}, "field is missing"),
        ({"position_rad": "position"}, "same length"),
        ({"joints": "a"}, "--column joints cannot be used"),
    ):
        refused(what, path, None, fields | wrong)


def test_a_bag_without_effort(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", "mcap", effort=False)
    refused("effort is empty and name the topic of its commands", bag, "elbow")


@pytest.mark.parametrize("kind", ["JointState", "controller state"])
@pytest.mark.parametrize("effort", [True, False])
def test_a_bag_with_commands(tmp_path: Path, kind: str, effort: bool) -> None:
    bag = write_bag(tmp_path / "bag", "mcap", effort=effort, command=kind)
    topics = {"command": "/told", "topic": "/arm"}
    log = read_log(bag, "elbow", topics)
    # the first command comes 1 ms after sample 3, so that sample 4 is the first to know it
    assert len(log.time) == len(T) - 4
    np.testing.assert_array_equal(log.position, TABLE["q"][4:])
    expected = [0.01 * ((i - 2) // 2 * 2 + 1) for i in range(4, len(T))]
    np.testing.assert_allclose(log.target, expected, atol=1e-15)
    assert (log.torque is None) is not effort
    assert set(joints_with_drive(bag, topics)) == {"elbow", "wrist"}
    refused("topic named /asked, it has /arm", bag, "elbow", topics | {"command": "/asked"})


PACE = {
    "time": T.astype(np.float32),
    "dof_pos": np.column_stack([TABLE["q"], 0.3 * np.cos(3 * T)]).astype(np.float32),
    "des_dof_pos": np.column_stack([TABLE["q"] + 0.1, 0.3 * np.cos(3 * T)]).astype(np.float32),
}


def test_a_log_of_pace(tmp_path: Path) -> None:
    path = torch_file(tmp_path / "chirp.pt", PACE)
    log = read_log(path, "joint_1")
    np.testing.assert_allclose(log.time, T, atol=1e-6)
    np.testing.assert_array_equal(log.position, PACE["dof_pos"][:, 0].astype(float))
    np.testing.assert_array_equal(log.target, PACE["des_dof_pos"][:, 0].astype(float))
    assert list(log.other_positions) == ["joint_2"]
    assert read_log(path, "knee", {"joints": "hip, knee"}).position[0] == PACE["dof_pos"][0, 1]
    assert joints_with_drive(path, {"joints": "hip,knee"}) == ["hip", "knee"]
    for joint, columns, what in (
        ("hip", None, "no joint 'hip', it has joint_1, joint_2"),
        (None, None, "several joints, name one with --joint: joint_1"),
        ("hip", {"joints": "hip"}, "it has 2 joints, but the names are hip"),
        ("hip", {"unit": "deg"}, "--column takes joints and world"),
    ):
        refused(what, path, joint, columns)


class Harm:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return print, ("harm",)


@pytest.mark.parametrize(
    ("table", "cut", "what"),
    [
        (PACE | {"bounds": Harm()}, 0, r"more than tensors and plain containers \(\w+.print\)"),
        ({"time": PACE["time"]}, 0, "no array 'dof_pos', it has time"),
        ([PACE["time"]], 0, "contains a list, not a dict of tensors"),
        (PACE | {"des_dof_pos": PACE["dof_pos"][:-1]}, 0, "give one row per time"),
        (PACE | {"kp": Plain(np.ones(3))}, 0, r"kp has shape \(3,\): give one number per joint, 2"),
        (PACE | {"kp": Plain(np.array(["high", "low"]))}, 0, "an array of 'U4', not of numbers"),
        (PACE, 4, "storage 2 has 2396 bytes instead of 2400"),
    ],
)
def test_a_bad_file_of_tensors_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], table: object, cut: int, what: str
) -> None:
    path = torch_file(tmp_path / "chirp.pt", table, cut)
    with pytest.raises(LogError, match=what) as found:
        read_log(path, "joint_1")
    assert "\n" not in str(found.value)
    assert not capsys.readouterr().out
    for content in (b"", b"PK\x03\x04", path.read_bytes()[:300]):
        path.write_bytes(content)
        refused("chirp", path, "joint_1")


def lerobot_set(folder: Path, version: int, names: object = None, count: int = 2) -> Path:
    """A data set of some episodes of two joints, in degrees, at 50 frames a second."""
    names = names or ["elbow.pos", "wrist.pos"]
    feature = {"dtype": "float32", "shape": [2], "names": names}
    pattern = (
        "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
        if version == 2
        else "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
    )
    info = {
        "codebase_version": f"v{version}.0",
        "fps": 50,
        "total_episodes": count,
        "chunks_size": 1000,
        "data_path": pattern,
        "features": {"observation.state": feature, "action": feature},
    }
    (folder / "meta").mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(info))
    (folder / "data/chunk-000").mkdir(parents=True)
    degrees = np.degrees(TABLE["q"])

    def rows(elbow: np.ndarray) -> list[np.ndarray]:
        return list(np.column_stack([elbow, T]).astype(np.float32))

    episodes = [
        pd.DataFrame(
            {
                "timestamp": (np.arange(len(T)) / 50).astype(np.float32),
                "episode_index": i,
                "observation.state": rows((i + 1) * degrees),
                "action": rows(degrees + 1.0),
            }
        )
        for i in range(count)
    ]
    if version == 2:
        for i, table in enumerate(episodes):
            table.to_parquet(folder / f"data/chunk-000/episode_{i:06d}.parquet")
    else:
        pd.concat(episodes).to_parquet(folder / "data/chunk-000/file-000.parquet")
    return folder


@pytest.mark.parametrize("version", [2, 3])
def test_a_lerobot_data_set(tmp_path: Path, version: int) -> None:
    folder = lerobot_set(tmp_path / "set", version)
    log = read_log(folder, "elbow", {"unit": "deg", "episode": "1"})
    np.testing.assert_allclose(log.time, np.arange(300) / 50, atol=1e-12)
    np.testing.assert_allclose(log.position, 2.0 * TABLE["q"], atol=1e-6)
    np.testing.assert_allclose(log.target, TABLE["q"] + np.radians(1.0), atol=1e-6)
    assert list(log.other_positions) == ["wrist"]
    assert joints_with_drive(folder) == ["elbow", "wrist"]
    known = {"unit": "deg", "episode": "0"}
    for columns, what in (
        ({"episode": "0"}, "unit is not in the data set: give --unit position=deg"),
        (known | {"unit": "percent"}, "'percent' is not known"),
        ({"unit": "deg"}, "several episodes, it has 0 to 1"),
        (known | {"episode": "2"}, "no episode '2'"),
        (known | {"topic": "/arm"}, "--column takes unit and episode"),
    ):
        refused(what, folder, "elbow", columns)
    refused("no joint 'hip', it has elbow, wrist", folder, "hip", known)
    file = sorted((folder / "data").glob("*/*.parquet"))[0]
    file.write_bytes(file.read_bytes()[:400])
    refused(file.name, folder, "elbow", known)


def test_an_odrive_recording(tmp_path: Path) -> None:
    path = tmp_path / "slow.npy"
    np.save(path, np.array([T, 8192 / (2 * np.pi) * TABLE["q"], TABLE["tau"]]))
    np.testing.assert_allclose(read_log(path).position, TABLE["q"], atol=1e-15)
    np.save(path, np.ones((4, 300)))
    refused("three rows", path)


def test_a_message_on_a_table_of_others_names_the_fix(tmp_path):
    ours, file = "time_s;position_rad;torque_nm", tmp_path / "log.csv"
    for head, cells, says in (
        ("Zeit [ms];Lage [°];Strom [mA]", "0;0;0", "--column 'current_a=Strom [mA]' --unit curr"),
        (ours, "0;1;", "only 0 of 60 rows have no empty cell"),
        (ours, "3.5.2024 9:00;1;2", "dates as 2026-01-31 12:00:00.5"),
    ):
        file.write_text("\n".join([head, *[cells] * 60]), encoding="cp1252")
        with pytest.raises(LogError) as caught:
            read_log(file, drop_nan=True)
        assert says in str(caught.value)
