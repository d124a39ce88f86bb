"""Logs in tables: CSV, Parquet, npz and MATLAB files with one column a quantity."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray
from scipy.io import loadmat

from frictionjoint.errors import LogError
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import check_columns, check_moves

Array = NDArray[np.float64]

# column name -> field, for hinge and slide
_FIELDS = {
    "position": ("position_rad", "position_m"),
    "velocity": ("velocity_rad_s", "velocity_m_s"),
    "torque": ("torque_nm", "force_n"),
    "voltage": ("voltage_v",),
    "temperature": ("temperature_c",),
    "target": ("target_rad", "target_m"),
    "motor_position": ("motor_position_rad",),
}
_POSITIONS = _FIELDS["position"]


def read_table(path: Path, joint: str | None, columns: Mapping[str, str] | None = None) -> JointLog:
    """Read one joint from a table.

    Args:
        columns: our column name -> name in the file, for files with names of their own.
    Raises:
        LogError: see `validate`; also unknown columns or joints.
    """
    names = column_names(path)
    wanted = _chosen(path.name, names, joint, dict(columns or {}))
    raw = _load(path, sorted(set(wanted.values())))
    # an editor counts the header as row 1
    first_row = 2 if path.suffix == ".csv" else 1
    data = {ours: raw[theirs] for ours, theirs in wanted.items()}
    check_columns(path.name, data, first_row)
    return _log(path, joint, data)


def _log(path: Path, joint: str | None, data: dict[str, Array]) -> JointLog:
    own = {name: x for name, x in data.items() if "." not in name}
    position = next(name for name in _POSITIONS if name in own)
    check_moves(path.name, position, own[position])
    found = {
        field: next((own[c] for c in choices if c in own), None)
        for field, choices in _FIELDS.items()
    }
    if found["torque"] is None and found["voltage"] is None:
        raise LogError(
            f"{path.name}: no torque_nm (force_n) and no voltage_v among {', '.join(own)}"
        )
    others = {name.rpartition(".")[0]: x for name, x in data.items() if "." in name}
    return JointLog(
        name=path.stem,
        joint=joint or "joint",
        time=own["time_s"],
        slide=position == "position_m",
        other_positions=others,
        **found,  # type: ignore[arg-type]
    )


def _chosen(
    source: str, names: list[str], joint: str | None, mapping: dict[str, str]
) -> dict[str, str]:
    """Our column name -> the file's, for the joint and the other joints' positions."""
    seen = [name for name in names if names.count(name) > 1]
    if seen:
        raise LogError(f"{source}: column {seen[0]!r} stands twice, rename one")
    missing = [theirs for theirs in mapping.values() if theirs not in names]
    if missing:
        raise LogError(f"{source}: no column {missing[0]!r}, it has {', '.join(names)}")
    table = {name: name for name in names} | mapping
    joints = sorted({name.rpartition(".")[0] for name in table if "." in name})
    prefix = ""
    if joints:
        if joint not in joints:
            raise LogError(f"{source}: no joint {joint!r}, it has {', '.join(joints)}")
        prefix = f"{joint}."
    known = {c for choices in _FIELDS.values() for c in choices}
    chosen = {c: table[prefix + c] for c in known if prefix + c in table}
    chosen |= {c: table[c] for c in known if c in table and c not in chosen}
    if "time_s" not in table:
        raise LogError(f"{source}: no column 'time_s', it has {', '.join(names)}")
    chosen["time_s"] = table["time_s"]
    if not any(c in chosen for c in _POSITIONS):
        raise LogError(
            f"{source}: no column '{prefix}position_rad' (slide: position_m), "
            f"it has {', '.join(names)}"
        )
    for other in joints:
        for c in _POSITIONS:
            if other != joint and f"{other}.{c}" in table:
                chosen[f"{other}.{c}"] = table[f"{other}.{c}"]
    return chosen


def column_names(path: Path) -> list[str]:
    """Names of a table's columns, without reading its rows."""
    try:
        if path.suffix == ".parquet":
            return list(pyarrow.parquet.read_schema(path).names)
        if path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as archive:
                return list(archive.files)
        if path.suffix == ".mat":
            return [name for name in loadmat(path) if not name.startswith("__")]
        with path.open(encoding="utf-8-sig") as file:
            header = file.readline().strip()
    except UnicodeDecodeError:
        raise LogError(f"{path.name}: not a text file, give CSV in UTF-8") from None
    except (OSError, ValueError, pa.ArrowInvalid, NotImplementedError) as error:
        raise LogError(f"{path.name}: cannot be read: {_one_line(error)}") from None
    if not header:
        raise LogError(f"{path.name}: empty, it needs a header row and samples")
    return [name.strip().strip('"') for name in header.split(",")]


def _load(path: Path, names: list[str]) -> dict[str, Array]:
    """Only the columns asked for: 8 bytes a number, whatever else the file holds."""
    try:
        if path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as archive:
                return {n: np.asarray(archive[n], dtype=np.float64).ravel() for n in names}
        if path.suffix == ".mat":
            content = loadmat(path)
            return {n: np.asarray(content[n], dtype=np.float64).ravel() for n in names}
        table = _arrow_table(path, names)
        return {n: table[n].to_numpy().astype(np.float64) for n in names}
    except LogError:
        raise
    except (OSError, ValueError, TypeError, pa.ArrowException) as error:
        raise LogError(f"{path.name}: cannot be read: {_one_line(error)}") from None


def _arrow_table(path: Path, names: list[str]) -> pa.Table:
    if path.suffix == ".parquet":
        return pyarrow.parquet.read_table(path, columns=names)
    header = column_names(path)
    read = pa.csv.ReadOptions(column_names=header, skip_rows=1)
    types = {name: pa.float64() for name in header if name in names}
    convert = pa.csv.ConvertOptions(include_columns=names, column_types=types)
    try:
        return pa.csv.read_csv(path, read_options=read, convert_options=convert)
    except pa.ArrowInvalid:
        raise LogError(_first_bad_cell(path, header, names)) from None


def _first_bad_cell(path: Path, header: list[str], names: list[str]) -> str:
    """Find the cell Arrow stumbled over, to name its row."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        for row, line in enumerate(file, start=1):
            cells = line.rstrip("\r\n").split(",")
            if row == 1:
                continue
            if len(cells) != len(header):
                return f"{path.name}, row {row}: {len(cells)} cells, the header has {len(header)}"
            for name, cell in zip(header, cells, strict=True):
                if name in names and not _is_number(cell):
                    return f"{path.name}, row {row}, {name}: {cell!r} is not a number"
    return f"{path.name}: cannot be read as CSV with columns {', '.join(header)}"


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
