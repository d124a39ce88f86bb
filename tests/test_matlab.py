"""MATLAB 5 files: what scipy writes is read to the last bit; corrupt ones end in an error."""

import struct
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat, savemat

from frictionjoint.errors import LogError
from frictionjoint.measured import matlab
from frictionjoint.measured.arrays import mat_columns

KINDS = ["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "?"]
COUNT = np.arange(12).reshape(3, 4)
PLAIN = {f"x_{kind.replace('?', 'b')}": COUNT.astype(kind) for kind in KINDS}
# what a short element holds, beside names of 1 to 31 letters
PLAIN |= {"q": np.array([1.5]), "abcdefgh": np.zeros((0, 3)), "y" * 31: np.ones((2, 1, 2))}
OTHERS = {"text": "abc", "pair": {"a": 1.0}, "turn": np.array([1 + 2j]), "cells": np.empty(2, "O")}


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
