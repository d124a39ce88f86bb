"""Read a log, whatever its format; the format follows from the file's name and content."""

from collections.abc import Mapping
from pathlib import Path

from frictionjoint.errors import LogError
from frictionjoint.measured.emps import is_emps, read_emps
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.panda import read_panda
from frictionjoint.measured.table import column_names, read_table
from frictionjoint.measured.xl330 import read_xl330

_TABLES = (".csv", ".parquet", ".npz", ".mat")


def read_log(
    path: str | Path, joint: str | None = None, columns: Mapping[str, str] | None = None
) -> JointLog:
    """Read one joint of a log.

    Args:
        path: .csv, .parquet, .npz, .mat, the XL330's .json, or the Panda's folder.
        joint: which one, where the log holds several.
        columns: our column name -> the file's, for tables with names of their own.
    Raises:
        LogError: one line that names the file, the row or column, and the mend.
    """
    path = Path(path)
    if not path.exists():
        raise LogError(f"{path}: no such log, check the path")
    if path.is_dir():
        return read_panda(path, joint)
    if path.suffix == ".json":
        return read_xl330(path)
    if path.suffix not in _TABLES:
        raise LogError(f"{path.name}: unknown kind of log, give {', '.join(_TABLES)} or .json")
    if path.suffix == ".mat" and not columns and is_emps(column_names(path)):
        return read_emps(path)
    return read_table(path, joint, columns)
