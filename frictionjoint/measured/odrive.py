"""Anti-cogging recordings of a bare motor on an ODrive (Chen et al.): .npy with three rows.

Rows: time s, encoder counts (8192 per turn), motor current A. The current is a torque up to the
motor's torque constant, which the file does not contain.
"""

from pathlib import Path

import numpy as np

from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import corrupt
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

_RAD_PER_COUNT = 2 * np.pi / 8192


def read_odrive(path: Path) -> JointLog:
    """Read one recording; rows in messages are samples, counted from 1.

    Raises:
        LogError: not such a file, or see `validate`.
    """
    try:
        rows = np.load(path, allow_pickle=False)
    except Exception as error:  # numpy raises many kinds on a corrupt file
        raise corrupt(path, error) from None
    if not isinstance(rows, np.ndarray) or rows.ndim != 2 or len(rows) != 3:
        raise LogError(f"{path.name}: needs three rows: time s, encoder counts, current A")
    if rows.dtype.kind not in "fiu":
        raise LogError(f"{path.name}: {rows.dtype} are not numbers")
    time, counts, current = rows.astype(np.float64)
    columns = {"time_s": time, "position_rad": counts * _RAD_PER_COUNT, "current_a": current}
    return log_of(path, "joint", columns)
