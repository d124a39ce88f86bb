"""Readers of other formats give the log that was written."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from scipy.io import savemat

from frictionjoint.errors import LogError
from frictionjoint.measured import read_log

T = 0.004 * np.arange(300)
TABLE = {
    "t": T,
    "q": 0.5 * np.sin(5.0 * T),
    "tau": np.sign(np.cos(5.0 * T)) + 0.1 * np.sin(40.0 * T),
    "note": np.ones(300),
}
MAPPING = {"time_s": "t", "position_rad": "q", "torque_nm": "tau"}


def save_csv(path: Path) -> None:
    pd.DataFrame(TABLE).assign(note='a "word", and more').to_csv(path, index=False)


def save_parquet(path: Path) -> None:
    pd.DataFrame(TABLE).assign(note="text").to_parquet(path)


def save_npz(path: Path) -> None:
    np.savez(path, **TABLE)


def save_mat(path: Path) -> None:
    savemat(path, {**TABLE, "q": TABLE["q"][:, None], "model": {"gear": 3.0}})


SAVERS = {"csv": save_csv, "parquet": save_parquet, "npz": save_npz, "mat": save_mat}


@pytest.mark.parametrize("kind", SAVERS)
def test_foreign_names_by_mapping(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"log.{kind}"
    SAVERS[kind](path)
    log = read_log(path, "elbow", MAPPING)
    assert log.joint == "elbow"
    np.testing.assert_array_equal(log.time, T)
    np.testing.assert_array_equal(log.position, TABLE["q"])
    np.testing.assert_array_equal(log.torque, TABLE["tau"])
    for wrong, what in (({"time_s": "clock"}, "'clock'"), ({"angle": "q"}, "'angle'")):
        with pytest.raises(LogError, match=what):
            read_log(path, columns=MAPPING | wrong)
    with pytest.raises(LogError, match="no column 'time_s', it has"):
        read_log(path)


@pytest.mark.parametrize("kind", ["parquet", "npz", "mat"])
def test_what_is_no_column_of_numbers_is_refused(tmp_path: Path, kind: str) -> None:
    bad = [np.array([str(x) for x in TABLE["q"]])]
    if kind != "parquet":
        bad += [TABLE["q"] + 1j, np.column_stack([TABLE["q"]] * 2), TABLE["q"][:-1]]
    for x in bad:
        path = tmp_path / f"log.{kind}"
        if kind == "parquet":
            pd.DataFrame(TABLE).assign(q=x).to_parquet(path)
        else:
            save: Callable[..., None] = np.savez if kind == "npz" else _mat
            save(path, **(TABLE | {"q": x}))
        with pytest.raises(LogError, match="log"):
            read_log(path, columns=MAPPING)


def _mat(path: Path, **columns: np.ndarray) -> None:
    savemat(path, columns)


def test_a_slide_and_a_current(tmp_path: Path) -> None:
    path = tmp_path / "slide.csv"
    names = {"t": "time_s", "q": "position_m", "tau": "current_a"}
    pd.DataFrame(TABLE).rename(columns=names).to_csv(path, index=False)
    log = read_log(path)
    assert log.slide
    assert log.torque is None
    np.testing.assert_array_equal(log.current, TABLE["tau"])


def write_bag(path: Path, plugin: str, effort: bool = True, stamped: bool = True) -> Path:
    """A ROS 2 bag of two joints; returns its folder."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="reading bags needs rosbags")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = SimpleNamespace(**{k.rpartition("/")[2]: v for k, v in store.types.items()})
    storage = rosbag2.StoragePlugin.MCAP if plugin == "mcap" else rosbag2.StoragePlugin.SQLITE3
    with rosbag2.Writer(path, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection("/arm", kinds.JointState.__msgtype__, typestore=store)
        for i in range(len(T)):
            recorded = 1_700_000_000_000_000_000 + 4_000_000 * i
            stamp = divmod(recorded, 1_000_000_000) if stamped else (0, 0)
            message = kinds.JointState(
                header=kinds.Header(stamp=kinds.Time(sec=stamp[0], nanosec=stamp[1]), frame_id=""),
                name=["elbow", "wrist"],
                position=np.array([TABLE["q"][i], 0.1]),
                velocity=np.zeros(0),
                effort=np.array([TABLE["tau"][i], 0.0]) if effort else np.zeros(0),
            )
            data = store.serialize_cdr(message, connection.msgtype)
            writer.write(connection, recorded, data)
    return path


@pytest.mark.parametrize("plugin", ["mcap", "db3"])
@pytest.mark.parametrize("stamped", [True, False])
def test_ros_bags(tmp_path: Path, plugin: str, stamped: bool) -> None:
    folder = write_bag(tmp_path / "bag", plugin, stamped=stamped)
    for path in (folder, next(folder.glob(f"*.{plugin}"))):
        log = read_log(path, "elbow")
        # the stamps' whole nanoseconds survive
        np.testing.assert_allclose(log.time, T, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(log.position, TABLE["q"])
        np.testing.assert_array_equal(log.torque, TABLE["tau"])
        assert log.velocity is None
        assert list(log.other_positions) == ["wrist"]
        assert read_log(path, "elbow", {"position_m": "position"}).slide
        for joint, what in (("hip", "it has elbow, wrist"), (None, "name one of elbow, wrist")):
            with pytest.raises(LogError, match=what):
                read_log(path, joint)
        with pytest.raises(LogError, match="no sensor_msgs/msg/JointState topic named /leg"):
            read_log(path, "elbow", {"topic": "/leg"})


def test_a_bag_without_effort(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="effort is empty"):
        read_log(write_bag(tmp_path / "bag", "mcap", effort=False), "elbow")


def test_an_odrive_recording(tmp_path: Path) -> None:
    path = tmp_path / "slow.npy"
    np.save(path, np.array([T, 8192 / (2 * np.pi) * TABLE["q"], TABLE["tau"]]))
    np.testing.assert_allclose(read_log(path).position, TABLE["q"], atol=1e-15)
    np.save(path, np.ones((4, 300)))
    with pytest.raises(LogError, match="three rows"):
        read_log(path)
