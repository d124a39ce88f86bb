"""Logs in HDF5, of robot-learning data sets and of MATLAB 7.3."""

from pathlib import Path

import numpy as np
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured.readers import read_log

T = np.arange(300) / 200.0
Q = 0.4 * np.sin(3.0 * T)
COLUMNS = {"time_s": "200Hz", "position_rad": "observations/qpos[1]", "torque_nm": "effort"}


@pytest.mark.parametrize("name", ["a.h5", "a.hdf5", "a.mat"])
def test_arrays_are_named_by_their_path(tmp_path: Path, name: str) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / name
    with h5py.File(path, "w", userblock_size=512 if name == "a.mat" else 0) as file:
        file["observations/qpos"] = (
            np.column_stack([T, Q]).T if name == "a.mat" else np.column_stack([T, Q])
        )
        file["effort"] = 2.0 * Q
        file["name"] = "arm"
    log = read_log(path, columns=COLUMNS)
    np.testing.assert_allclose(log.position, Q)
    np.testing.assert_allclose(log.time, T, atol=1e-12)
    with pytest.raises(LogError, match=r"it has effort, observations/qpos"):
        read_log(path)
    with pytest.raises(
        LogError, match=r"name a column: observations/qpos\[0\] to observations/qpos\[1\]"
    ):
        read_log(path, columns=COLUMNS | {"position_rad": "observations/qpos"})


def test_a_file_that_is_cut_off_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(40))
    with pytest.raises(LogError, match="is it whole"):
        read_log(path, columns=COLUMNS)
