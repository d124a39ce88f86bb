"""Read a log, whatever its format; the format follows from the file's name and content.

The package's own format is CSV or Parquet with the column names of `columns`. Others: .npz and
.mat with a mapping of names, ROS bags, and the public logs of EMPS, XL330, Panda, ODrive and TX40.
"""

from collections.abc import Mapping
from pathlib import Path

from frictionjoint.errors import LogError
from frictionjoint.measured.emps import is_emps, read_emps
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.odrive import read_odrive
from frictionjoint.measured.panda import is_panda, read_panda
from frictionjoint.measured.rosbag import SUFFIXES, is_bag, read_rosbag
from frictionjoint.measured.table import column_names, read_table
from frictionjoint.measured.tx40 import is_tx40, read_tx40
from frictionjoint.measured.xl330 import read_xl330

_TABLES = (".csv", ".parquet", ".npz", ".mat")
_KINDS = (*_TABLES, *SUFFIXES, ".json", ".npy")


def read_log(
    path: str | Path, joint: str | None = None, columns: Mapping[str, str] | None = None
) -> JointLog:
    """Read one joint of a log.

    Args:
        path: .csv, .parquet, .npz, .mat, .db3, .mcap, .bag, the XL330's .json, the ODrive's .npy,
            or the folder of a ROS 2 bag, of the Panda's or of the TX40's log.
        joint: which one, where the log holds several.
        columns: our column name -> the file's, for tables with names of their own, for instance
            ``{"time_s": "t", "position_rad": "q"}``. Names only: values are never converted.
    Raises:
        LogError: one line that names the file, the row or column, and the mend.
    """
    path = Path(path)
    if not path.exists():
        raise LogError(f"{path}: no such log, check the path")
    if is_bag(path):
        return read_rosbag(path, joint, columns)
    kind = path.suffix.lower()
    if kind in _TABLES and path.is_file():
        if kind == ".mat" and not columns and is_emps(column_names(path)):
            return read_emps(path)
        return read_table(path, joint, columns)
    if columns:
        raise LogError(f"{path.name}: column names are mapped for {', '.join(_TABLES)} only")
    if path.is_dir():
        return _read_folder(path, joint)
    if kind == ".json":
        return read_xl330(path)
    if kind == ".npy":
        return read_odrive(path)
    raise LogError(f"{path.name}: unknown kind of log, give one of {', '.join(_KINDS)}")


def _read_folder(path: Path, joint: str | None) -> JointLog:
    if is_panda(path):
        return read_panda(path, joint)
    if is_tx40(path):
        return read_tx40(path, joint)
    raise LogError(f"{path.name}: a folder, but no ROS 2 bag, Panda or TX40 log: name a file in it")
