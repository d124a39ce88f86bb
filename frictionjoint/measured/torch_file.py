"""Tensors from a file written by ``torch.save``, without torch.

Such a file is a zip archive: a pickle of plain containers, whose tensors refer to members
``data/0``, ``data/1``, ... with their numbers (PyTorch 1.6 and later,
https://docs.pytorch.org/docs/stable/notes/serialization.html). A pickle can call any function by
name, so it is read by an unpickler that knows only the names in a table of tensors and of numpy
arrays, and refuses all others. numpy pickles an array as an empty array followed by a state of
shape, type and bytes; the classes that stand in for numpy's accept such states and call nothing.
"""

import io
import math
import pickle
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line, whole

# classes of storages, and what their numbers are; a half has no digits to spare for a log
_STORAGES = {"DoubleStorage": "f8", "FloatStorage": "f4", "HalfStorage": "f2"}
_STORAGES |= {"LongStorage": "i8", "IntStorage": "i4", "ShortStorage": "i2"}
_STORAGES |= {"CharStorage": "i1", "ByteStorage": "u1"}
# types of the numbers of an array of numpy
_NUMBERS = re.compile(r"[iu][1248]|f[248]|b1")


class _Storage(NamedTuple):
    """Numbers of a member of the archive."""

    numbers: np.ndarray[Any, Any]


def read_tensors(path: Path) -> dict[str, Array]:
    """The tensors and arrays of a file with a table of them, by name, as float64; LogError for
    another file, or one that contains more than tensors and plain containers."""
    with whole(path):
        try:
            with zipfile.ZipFile(path) as archive:
                content = _load(path, archive)
        except pickle.UnpicklingError as error:
            what = f"contains more than tensors and plain containers ({one_line(error)})"
            raise LogError(f"{path.name}: {what}: save a dict of tensors") from None
        except zipfile.BadZipFile as error:
            what = f"not a file of torch.save since PyTorch 1.6 ({one_line(error)})"
            raise LogError(f"{path.name}: {what}") from None
    if not isinstance(content, dict):
        kind = type(content).__name__
        raise LogError(f"{path.name}: contains a {kind}, not a dict of tensors: save a dict")
    arrays = {n: x.numbers if isinstance(x, _Array) else x for n, x in content.items()}
    return {
        str(name): np.asarray(x, dtype=np.float64)
        for name, x in arrays.items()
        if isinstance(x, np.ndarray)
    }


def _load(path: Path, archive: zipfile.ZipFile) -> Any:
    pickles = [i for i in archive.infolist() if i.filename.rpartition("/")[2] == "data.pkl"]
    if len(pickles) != 1:
        raise LogError(f"{path.name}: not a file of torch.save: it has no data.pkl")
    # the pickle itself has containers and names, no numbers
    if pickles[0].file_size > 1 << 24:
        raise LogError(f"{path.name}: data.pkl has {pickles[0].file_size} bytes, save tensors only")
    folder = pickles[0].filename[: -len("data.pkl")]
    order = "<"
    if f"{folder}byteorder" in archive.namelist():
        order = ">" if archive.read(f"{folder}byteorder") == b"big" else "<"
    return _Unpickler(path, archive, folder, order, archive.read(pickles[0])).load()


class _Unpickler(pickle.Unpickler):
    """Unpickler of tensors and plain containers; it looks up and imports no other name."""

    def __init__(
        self, path: Path, archive: zipfile.ZipFile, folder: str, order: str, content: bytes
    ) -> None:
        super().__init__(io.BytesIO(content))
        self.path, self.archive, self.folder, self.order = path, archive, folder, order

    def find_class(self, module: str, name: str) -> Any:
        """Replacements for the few names that a table of tensors needs."""
        if module == "torch" and name in _STORAGES:
            return _STORAGES[name]
        if (module, name) in _STAND_INS:
            return _STAND_INS[module, name]
        raise pickle.UnpicklingError(f"{module}.{name}")

    def persistent_load(self, pid: Any) -> _Storage:
        """Numbers of a tensor: ("storage", class, member, device, count)."""
        kind, code, member, _, count = pid
        if kind != "storage" or code not in _STORAGES.values():
            raise pickle.UnpicklingError(f"{kind} {code}")
        dtype = np.dtype(f"{self.order}{code}")
        info = self.archive.getinfo(f"{self.folder}data/{member}")
        # never compressed by torch: no small file becomes a large one
        stored = info.compress_type == zipfile.ZIP_STORED
        if not stored or info.file_size != count * dtype.itemsize:
            sizes = f"has {info.file_size} bytes instead of {count * dtype.itemsize}"
            raise LogError(f"{self.path.name}: storage {member} {sizes}: is the file complete?")
        return _Storage(np.frombuffer(self.archive.read(info), dtype))


def _tensor(
    storage: _Storage, offset: int, size: tuple[int, ...], stride: tuple[int, ...], *_: Any
) -> np.ndarray[Any, Any]:
    """A copy of a tensor's numbers; a view beyond its storage is refused."""
    last = offset + sum((n - 1) * step for n, step in zip(size, stride, strict=True))
    inside = offset >= 0 and all(n >= 0 and step >= 0 for n, step in zip(size, stride, strict=True))
    most = len(storage.numbers)
    if not inside or (all(size) and (last >= most or math.prod(size) > most)):
        raise pickle.UnpicklingError(f"a tensor of size {size} beyond its storage")
    if not all(size):
        return np.zeros(size)
    bytes_each = storage.numbers.itemsize
    view = np.lib.stride_tricks.as_strided(
        storage.numbers[offset:], size, [bytes_each * step for step in stride], writeable=False
    )
    return view.copy()


class _Array:
    """An array whose state follows it in the pickle; `numbers` is the array."""

    numbers: np.ndarray[Any, Any]

    def __init__(self, *_: Any) -> None:
        self.numbers = np.zeros(0)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, shape, kind, by_columns, content = state
        if not (isinstance(kind, _Kind) and isinstance(content, bytes)):
            raise pickle.UnpicklingError("an array of something other than numbers")
        size = math.prod(shape)
        if min(shape, default=0) < 0 or size * kind.dtype.itemsize != len(content):
            raise pickle.UnpicklingError(f"an array of shape {shape} in {len(content)} bytes")
        numbers = np.frombuffer(content, kind.dtype)
        self.numbers = numbers.reshape(shape[::-1]).T if by_columns else numbers.reshape(shape)


class _Kind:
    """Type of an array's numbers; its byte order is its state."""

    def __init__(self, code: str, *_: Any) -> None:
        if not (isinstance(code, str) and _NUMBERS.fullmatch(code)):
            raise pickle.UnpicklingError(f"an array of {code!r}, not of numbers")
        self.dtype = np.dtype(code)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        if state[1] in ("<", ">"):
            self.dtype = self.dtype.newbyteorder(state[1])


def _bytes(text: str, code: str) -> bytes:
    """Bytes in the encoding of older pickles."""
    if code != "latin1":
        raise pickle.UnpicklingError(f"_codecs.encode to {code!r}")
    return text.encode("latin1")


_STAND_INS: dict[tuple[str, str], Callable[..., Any]] = {
    ("torch._utils", "_rebuild_tensor_v2"): _tensor,
    ("collections", "OrderedDict"): dict,
    ("numpy.core.multiarray", "_reconstruct"): _Array,
    ("numpy._core.multiarray", "_reconstruct"): _Array,
    # the class of the array, which the stand-in of `_reconstruct` is given
    ("numpy", "ndarray"): _Array,
    ("numpy", "dtype"): _Kind,
    ("_codecs", "encode"): _bytes,
}
