"""MATLAB 5 files: the names of all variables, and numeric arrays.

scipy's reader crashes the process on some corrupt files (a data type that its table lacks). Level 5
of the MAT-File Format (MathWorks): elements of a tag (type, bytes) and data, padded to 8 bytes; a
variable is a matrix element of array flags, dimensions, name and data, each an element itself, and
may be compressed as a whole.
"""

import math
import struct
import zlib
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array

_HEADER = 128
_COMPRESSED, _MATRIX = 15, 14
# numpy's codes of the numeric data types
_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8"}
_TYPES |= {13: "u8"}
# array classes that hold plain numbers, double to uint64; what others are called
_NUMERIC = range(6, 16)
_OTHERS = {1: "cell", 2: "struct", 3: "object", 4: "text", 5: "sparse", 16: "function"}
# the part of a compressed variable that holds its flags, dimensions and name
_FRONT = 4096


class MatlabError(Exception):
    """Description of an error in a file, without the file's name."""


class NotNumbersError(MatlabError):
    """A variable is intact, but not an array of real numbers."""


def is_level_5(path: Path) -> bool:
    """Whether a file states that it is a MATLAB 5 file; others are older, or 7.3 (HDF5)."""
    with open(path, "rb") as file:
        head = file.read(_HEADER)
    return len(head) == _HEADER and head[124:128] in (b"\x00\x01IM", b"\x01\x00MI")


def variable_names(path: Path) -> list[str]:
    """Names of the variables in the file's order; MatlabError if the file is corrupt."""
    # an unnamed one holds the insides of objects
    return [name for name, _ in _variables(path, ()) if name]


def arrays(path: Path, wanted: Collection[str]) -> dict[str, Array]:
    """The requested variables that exist, in their own shape; MatlabError if the file is corrupt,
    or a requested variable is not an array of real numbers."""
    return {name: x for name, x in _variables(path, wanted) if x is not None}


def _variables(path: Path, wanted: Collection[str]) -> Iterator[tuple[str, Array | None]]:
    """Name of each variable, and its numbers if requested."""
    size = path.stat().st_size
    with open(path, "rb") as file:
        order = "<" if file.read(_HEADER)[126:128] == b"IM" else ">"
        while file.tell() < size:
            kind, _, length = _tag(file.read(8), 0, order)
            begin = file.tell()
            if length > size - begin:
                raise MatlabError("the file ends within a variable")
            if kind == _COMPRESSED:
                yield _compressed(file.read(length), order, wanted)
            elif kind == _MATRIX:
                name, plain, at = _front(file.read(min(length, _FRONT)), order)
                file.seek(begin)
                whole = file.read(length) if name in wanted else b""
                yield name, _numbers(whole, at, name, plain, order) if whole else None
            else:
                raise MatlabError(f"a variable of data type {kind}")
            file.seek(begin + length)


def _compressed(packed: bytes, order: str, wanted: Collection[str]) -> tuple[str, Array | None]:
    """A variable compressed by zlib, unpacked up to the length that its tag states."""
    try:
        front = zlib.decompressobj().decompress(packed, _FRONT)
        kind, start, size = _tag(front, 0, order)
        if kind != _MATRIX:
            raise MatlabError(f"a compressed variable of data type {kind}")
        name, plain, at = _front(front[start:], order)
        if name not in wanted:
            return name, None
        whole = zlib.decompressobj().decompress(packed, start + size)
    except zlib.error as error:
        raise MatlabError(f"compressed data: {error}") from None
    return name, _numbers(whole[start:], at, name, plain, order)


def _front(data: bytes, order: str) -> tuple[str, str | list[int], int]:
    """Name, dimensions (or the kind, if not plain numbers), and the offset of the data."""
    flags, at = _element(data, 0, order)
    if len(flags) < 4:
        raise MatlabError("a variable without its flags")
    (flag,) = struct.unpack_from(f"{order}I", flags)
    kind = flag & 0xFF
    if kind == 17:  # an opaque one has no dimensions
        name, at = _element(data, at, order)
        return _text(name), "object", at
    dimensions, at = _element(data, at, order)
    name, at = _element(data, at, order)
    if kind not in _NUMERIC or flag & 0x0800:  # a complex one has this flag
        other = "complex" if kind in _NUMERIC else _OTHERS.get(kind, f"class {kind}")
        return _text(name), other, at
    whole = dimensions[: len(dimensions) // 4 * 4]
    return _text(name), np.frombuffer(whole, f"{order}i4").tolist(), at


def _numbers(data: bytes, at: int, name: str, shape: str | list[int], order: str) -> Array:
    if isinstance(shape, str):
        raise NotNumbersError(f"{name}: {shape} is not a column of numbers")
    code, start, size = _tag(data, at, order)
    if code not in _TYPES or start + size > len(data):
        raise MatlabError(f"{name}: its data is corrupt")
    values = np.frombuffer(data[start : start + size], order + _TYPES[code])
    if min(shape, default=-1) < 0 or math.prod(shape) != values.size:
        raise MatlabError(f"{name}: {values.size} numbers for dimensions {shape}")
    return values.astype(np.float64).reshape(shape, order="F")


def _element(data: bytes, at: int, order: str) -> tuple[bytes, int]:
    """Bytes of a small element, and the offset of the next one."""
    _, start, size = _tag(data, at, order)
    if start + size > min(len(data), _FRONT):
        raise MatlabError("a variable's name or size is corrupt")
    small = start == at + 4
    return data[start : start + size], at + 8 if small else start + -(-size // 8) * 8


def _tag(data: bytes, at: int, order: str) -> tuple[int, int, int]:
    """Data type of an element, the offset of its data, and its length."""
    if at + 8 > len(data):
        raise MatlabError("the file ends within a tag")
    first, size = struct.unpack_from(f"{order}II", data, at)
    if first >> 16:  # a small element: bytes and type share a word, the data follows at once
        size = first >> 16
        if size > 4:
            raise MatlabError("a small element of more than 4 bytes")
        return first & 0xFFFF, at + 4, size
    return first, at + 8, size


def _text(name: bytes) -> str:
    return name.decode("utf-8", "replace")
