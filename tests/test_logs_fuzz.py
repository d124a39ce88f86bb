"""Whatever a file holds, a reader gives a log or a LogError of one line, nothing else."""

import io
import os
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow
from hypothesis import given, settings
from hypothesis import strategies as st
from pyarrow import parquet
from scipy.io import savemat
from torch_file import torch_file

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

# more inputs on demand: FRICTIONJOINT_FUZZ=20000 pytest tests/test_logs_fuzz.py
EXAMPLES = int(os.environ.get("FRICTIONJOINT_FUZZ", "120"))

NAMES = ["time_s", "position_rad", "velocity_rad_s", "torque_nm", "voltage_v", "a.position_rad"]
CELLS = [
    *("", "nan", "inf", "-1e308", "1e999", "0x1", "1_0", "١"),
    *("true", '"', '"1"', " 2 ", "NA", "x,y"),
]
cell = st.one_of(
    st.floats(width=32).map(str),
    st.integers().map(str),
    st.sampled_from(CELLS),
    st.text(max_size=4),
)
header = st.lists(st.sampled_from(NAMES) | st.text(max_size=5), min_size=1, max_size=6)


def never_anything_else(name: str, content: bytes, joint: str | None = None) -> None:
    """Read a file of that content."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(content)
        try:
            log = read_log(path, joint)
        except LogError as error:
            text = str(error)
            assert "\n" not in text
            assert name in text
        else:
            assert isinstance(log, JointLog)
            assert all(np.isfinite(x).all() for x in log.arrays().values())


@settings(max_examples=EXAMPLES, deadline=None)
@given(header, st.lists(st.lists(cell, max_size=6), max_size=8), st.sampled_from("\n\r"))
def test_any_table(names: list[str], rows: list[list[str]], end: str) -> None:
    text = end.join(",".join(row) for row in [names, *rows])
    never_anything_else("log.csv", text.encode("utf-8", "surrogatepass"))


@settings(max_examples=EXAMPLES, deadline=None)
@given(st.integers(0, 79), st.integers(0, 3), cell, st.sampled_from(["a", None]), st.booleans())
def test_a_good_table_with_one_bad_cell(
    row: int, column: int, content: str, joint: str | None, prefixed: bool
) -> None:
    t = 0.01 * np.arange(80)
    table = np.column_stack([t, np.sin(t), np.cos(t), np.sin(7 * t)])
    lines = [[repr(float(x)) for x in values] for values in table]
    lines[row][column] = content
    prefix = "a." if prefixed else ""
    names = ["time_s", *(f"{prefix}{c}" for c in NAMES[1:4])]
    text = "\n".join(",".join(line) for line in [names, *lines])
    never_anything_else("log.csv", text.encode("utf-8", "surrogatepass"), joint)


@settings(max_examples=EXAMPLES, deadline=None)
@given(
    st.sampled_from(["csv", "parquet", "npz", "mat", "npy", "json", "db3", "mcap", "bag"]),
    st.binary(max_size=200),
)
def test_any_bytes_under_any_name(suffix: str, content: bytes) -> None:
    never_anything_else(f"log.{suffix}", content)


def whole(suffix: str) -> bytes:
    """A good log in a binary format."""
    t = 0.01 * np.arange(80)
    table = dict(
        zip(["time_s", *NAMES[1:4]], (t, np.sin(t), np.cos(t), np.sin(7 * t)), strict=True)
    )
    buffer = io.BytesIO()
    if suffix == "npz":
        np.savez(buffer, **table)
    elif suffix == "pt":
        two = {name: np.column_stack([x, x]) for name, x in (("dof_pos", t), ("des_dof_pos", t))}
        torch_file(buffer, {"time": t} | two)
    elif "mat" in suffix:
        savemat(buffer, table, do_compression=suffix == "packed.mat")
    else:
        parquet.write_table(pyarrow.table(table), buffer)
    return buffer.getvalue()


WHOLE = {suffix: whole(suffix) for suffix in ("npz", "mat", "packed.mat", "parquet", "pt")}


@settings(max_examples=EXAMPLES, deadline=None)
@given(
    st.sampled_from(sorted(WHOLE)),
    st.integers(0, 2**16),
    st.integers(0, 12),
    st.binary(max_size=8),
    st.booleans(),
)
def test_a_good_binary_log_corrupt_somewhere(
    suffix: str, at: int, length: int, piece: bytes, cut: bool
) -> None:
    content = WHOLE[suffix]
    at %= len(content)
    rest = b"" if cut else content[at + length :]
    never_anything_else(f"log.{suffix}", content[:at] + piece + rest)
