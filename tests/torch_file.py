"""Files as ``torch.save`` writes them, without torch."""

import io
import pickle
import sys
import zipfile
from collections import OrderedDict
from pathlib import Path
from types import ModuleType
from typing import Any, BinaryIO
from unittest.mock import patch

import numpy as np


class Plain:
    """An array that is saved as numpy pickles it."""

    def __init__(self, array: np.ndarray[Any, Any]) -> None:
        self.array = array


def torch_file(path: Path | BinaryIO, table: object, cut: int = 0) -> Path | BinaryIO:
    """A file as ``torch.save`` writes it since PyTorch 1.6, `cut` bytes short in its last storage.

    Names of torch are those of its own pickles; none of its code is needed. What is `Plain` stays
    an array of numpy.
    """
    stored: list[bytes] = []

    class Saver(pickle.Pickler):
        def persistent_id(self, x: object) -> object:
            return x.pid if isinstance(x, Numbers) else None

        def reducer_override(self, x: object) -> object:
            if isinstance(x, Plain):
                return x.array.__reduce__()
            if not isinstance(x, np.ndarray):
                return NotImplemented
            stored.append(x.astype("<f4").tobytes())
            numbers = Numbers(("storage", FloatStorage, str(len(stored) - 1), "cpu", x.size))
            stride = tuple(s // x.itemsize for s in x.strides)
            return rebuild, (numbers, 0, x.shape, stride, False, OrderedDict())

    class Numbers:
        def __init__(self, pid: tuple[object, ...]) -> None:
            self.pid = pid

    FloatStorage = type("FloatStorage", (), {"__module__": "torch"})

    def rebuild() -> None: ...

    rebuild.__module__, rebuild.__qualname__ = "torch._utils", "_rebuild_tensor_v2"
    rebuild.__name__ = "_rebuild_tensor_v2"
    fakes = {"torch": ModuleType("torch"), "torch._utils": ModuleType("torch._utils")}
    fakes["torch"].FloatStorage = FloatStorage
    fakes["torch._utils"]._rebuild_tensor_v2 = rebuild
    out = io.BytesIO()
    with patch.dict(sys.modules, fakes):
        Saver(out, protocol=2).dump(table)
    stored[-1:] = [x[: len(x) - cut] for x in stored[-1:]]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("log/data.pkl", out.getvalue())
        archive.writestr("log/byteorder", "little")
        for i, x in enumerate(stored):
            archive.writestr(f"log/data/{i}", x)
    return path
