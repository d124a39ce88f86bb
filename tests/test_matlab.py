"""MATLAB and HDF5 files: what is written is read to the last bit; corrupt ones end in an error."""

import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from frictionjoint.errors import LogError
from frictionjoint.measured import matlab
from frictionjoint.measured.arrays import mat_columns
from frictionjoint.measured.readers import read_log

KINDS = ["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "?"]
COUNT = np.arange(12).reshape(3, 4)
PLAIN = {f"x_{kind.replace('?', 'b')}": COUNT.astype(kind) for kind in KINDS}
# what a short element holds, beside names of 1 to 31 letters
PLAIN |= {"q": np.array([1.5]), "abcdefgh": np.zeros((0, 3)), "y" * 31: np.ones((2, 1, 2))}
OTHERS = {"text": "abc", "pair": {"a": 1.0}, "turn": np.array([1 + 2j]), "cells": np.empty(2, "O")}

T = np.arange(300) / 200.0
Q = 0.4 * np.sin(3.0 * T)
COLUMNS = {"time_s": "200Hz", "position_rad": "observations/qpos[1]", "torque_nm": "effort"}


@pytest.fixture(params=[False, True], ids=["plain", "compressed"])
def file(request, tmp_path: Path) -> Path:
    OTHERS["cells"][:] = ["a", 1.0]
    savemat(tmp_path / "log.mat", PLAIN | OTHERS, do_compression=request.param)
    return tmp_path / "log.mat"


def test_numbers_and_shapes_are_those_scipy_reads(file: Path) -> None:
    assert matlab.is_level_5(file)
    assert matlab.variable_names(file) == [*PLAIN, *OTHERS]
    found, wanted = matlab.arrays(file, PLAIN), loadmat(file)
    for name in PLAIN:
        assert found[name].dtype == np.float64
        assert found[name].shape == wanted[name].shape
        np.testing.assert_array_equal(found[name], wanted[name])
    assert set(matlab.arrays(file, ["q"])) == {"q"}


def test_the_other_byte_order(tmp_path: Path) -> None:
    def element(kind: int, data: bytes) -> bytes:
        return struct.pack(">II", kind, len(data)) + data + bytes(-len(data) % 8)

    matrix = element(6, struct.pack(">II", 6, 0)) + element(5, struct.pack(">ii", 1, 2))
    matrix += element(1, b"q") + element(9, struct.pack(">dd", 0.5, -3.0))
    content = b"MATLAB 5.0".ljust(124) + b"\x01\x00MI" + element(14, matrix)
    (tmp_path / "big.mat").write_bytes(content)
    np.testing.assert_array_equal(mat_columns(tmp_path / "big.mat", ["q"])["q"], [0.5, -3.0])


def test_a_data_type_without_a_number_is_an_error(tmp_path: Path) -> None:
    # scipy 1.17 reads beyond a table here and takes the process with it
    savemat(tmp_path / "log.mat", {"time_s": np.arange(80.0)})
    content = bytearray((tmp_path / "log.mat").read_bytes())
    at = content.index(struct.pack("<II", 9, 640))
    for code in (0, 8, 15, 20, 0xFFFF):
        content[at : at + 2] = struct.pack("<H", code)
        (tmp_path / "log.mat").write_bytes(content)
        with pytest.raises(LogError, match=r"log.mat: .*corrupt"):
            mat_columns(tmp_path / "log.mat", ["time_s"])


@pytest.mark.parametrize("option", [{"wrap": 1.0}, {"signals": ["kp"]}, {"drop_nan": True}])
def test_an_option_that_the_format_of_emps_lacks_is_refused(tmp_path: Path, option) -> None:
    savemat(tmp_path / "a.mat", {"t": T, "qm": Q, "qg": Q, "vir": 0.1 * np.sign(Q), "gtau": 35.0})
    assert read_log(tmp_path / "a.mat").position.size == T.size
    with pytest.raises(LogError, match="EMPS in its own format takes no --"):
        read_log(tmp_path / "a.mat", **option)


@pytest.mark.parametrize("name", ["a.h5", "a.hdf5", "a.mat"])
def test_arrays_are_named_by_their_path(tmp_path: Path, name: str) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / name
    with h5py.File(path, "w", userblock_size=512 if name == "a.mat" else 0) as file:
        columns = np.column_stack([T, Q])
        file["observations/qpos"] = columns.T if name == "a.mat" else columns
        file["effort"] = 2.0 * Q
        file["name"] = "arm"
    log = read_log(path, columns=COLUMNS)
    np.testing.assert_allclose(log.position, Q)
    np.testing.assert_allclose(log.time, T, atol=1e-12)
    with pytest.raises(LogError, match=r"it has effort, observations/qpos"):
        read_log(path)
    with pytest.raises(LogError, match=r"a column: observations/qpos\[0\] to observations/qpos\[1"):
        read_log(path, columns=COLUMNS | {"position_rad": "observations/qpos"})


def test_a_file_that_is_cut_off_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(40))
    with pytest.raises(LogError, match="is it whole"):
        read_log(path, columns=COLUMNS)
