"""LeRobot data sets (github.com/huggingface/lerobot, formats 2 and 3): positions and commands.

A folder with ``meta/info.json``, which names the joints of ``observation.state`` (position) and of
``action`` (target), and Parquet files below ``data`` with a row a frame: one episode a file
(format 2) or several (format 3). The unit is nowhere in a data set: it is asked for.
"""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import corrupt, one_line
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

_INFO = "meta/info.json"
_STATE, _ACTION = "observation.state", "action"
_UNITS = {"rad": 1.0, "deg": math.pi / 180.0}


def is_lerobot(path: Path) -> bool:
    """Whether a folder is such a data set."""
    return (path / _INFO).is_file()


def read_lerobot(
    path: Path, joint: str | None, columns: Mapping[str, str] | None = None
) -> JointLog:
    """Read one joint of one episode.

    Args:
        columns: ``{"unit": "deg", "episode": "3"}``: the unit of positions and actions, deg or rad,
            and the episode's index, where there are several.
    Raises:
        LogError: not such a data set, no such episode or joint, no unit, or see `validate`.
    """
    mapping = dict(columns or {})
    unit, episode = mapping.pop("unit", None), mapping.pop("episode", None)
    if mapping:
        raise LogError(f"{path.name}: a data set takes the columns unit and episode, not {mapping}")
    if unit not in _UNITS:
        what = f"unit is {unit!r}" if unit else "its unit is not in the data set"
        raise LogError(
            f"{path.name}: {what}: give unit=deg or unit=rad; positions from -100 to 100 are to be "
            "recorded again with use_degrees"
        )
    info = _info(path)
    positions, targets = _joints(path, info, _STATE), _joints(path, info, _ACTION)
    both = [name for name in positions if name in targets]
    if joint is None and len(both) == 1:
        joint = both[0]
    if joint is None or joint not in both:
        what = f"no joint {joint!r}, it has" if joint else "several joints, name one of"
        raise LogError(f"{path.name}: {what} {', '.join(both)}")
    time, state, action = _episode(path, info, episode, len(positions), len(targets))
    scale = _UNITS[unit]
    data = {
        "time_s": time,
        "position_rad": scale * state[:, positions.index(joint)],
        "target_rad": scale * action[:, targets.index(joint)],
    }
    data |= {
        f"{name}.position_rad": scale * state[:, i]
        for i, name in enumerate(positions)
        if name != joint
    }
    return log_of(path, joint, data)


def joints_of_lerobot(path: Path) -> list[str]:
    """Names of the joints whose position and target a data set holds.

    Raises:
        LogError: not such a data set.
    """
    info = _info(path)
    targets = _joints(path, info, _ACTION)
    return [name for name in _joints(path, info, _STATE) if name in targets]


def _info(path: Path) -> dict[str, Any]:
    try:
        info = json.loads((path / _INFO).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise LogError(f"{path.name}, {_INFO}: cannot be read as JSON: {one_line(error)}") from None
    if not isinstance(info, dict) or not isinstance(info.get("features"), dict):
        raise LogError(f"{path.name}, {_INFO}: no features: not a LeRobot data set")
    return info


def _joints(path: Path, info: dict[str, Any], feature: str) -> list[str]:
    """Names of a feature's numbers: a list of them, or one in a table."""
    found = info["features"].get(feature)
    if not isinstance(found, dict):
        listed = ", ".join(info["features"]) or "none"
        raise LogError(f"{path.name}, {_INFO}: no feature {feature!r}, it has {listed}")
    names = found.get("names")
    if isinstance(names, dict) and len(names) == 1:
        (names,) = names.values()
    shape = found.get("shape")
    count = shape[0] if isinstance(shape, list) and shape else None
    if not isinstance(names, list) or len(names) != count:
        raise LogError(
            f"{path.name}, {_INFO}, {feature}: {count} numbers and no name for each: name them in "
            f"features, {feature}, names"
        )
    # a robot's own features are called shoulder_pan.pos; a point separates a joint and its column
    return [str(name).removesuffix(".pos").replace(".", " ") for name in names]


def _episode(
    path: Path, info: dict[str, Any], episode: str | None, states: int, actions: int
) -> tuple[Array, Array, Array]:
    """Time, states, actions, shapes (n,), (n, states), (n, actions)."""
    total = info.get("total_episodes")
    if episode is None and total == 1:
        episode = "0"
    if episode is None or not episode.isdecimal() or int(episode) >= int(total or 0):
        what = "several episodes" if episode is None else f"no episode {episode!r}"
        raise LogError(f"{path.name}: {what}, it has 0 to {int(total or 0) - 1}: give episode=N")
    wanted = int(episode)
    tables = []
    for file in _files(path, info, wanted):
        try:
            tables.append(
                pyarrow.parquet.read_table(
                    file,
                    columns=["timestamp", _STATE, _ACTION],
                    filters=[("episode_index", "==", wanted)],
                )
            )
        except (OSError, ValueError, KeyError, pa.ArrowException) as error:
            raise corrupt(file, error) from None
    table = pa.concat_tables(tables) if tables else None
    if table is None or not table.num_rows:
        raise LogError(f"{path.name}: no frame of episode {wanted} below data: is it whole?")
    time = table["timestamp"].to_numpy().astype(np.float64)
    fps = info.get("fps")
    if isinstance(fps, int | float) and fps > 0.0:
        # stamps are multiples of the period in single precision: what they lost is known
        frame = np.round(time * fps)
        if np.all(np.abs(time * fps - frame) < 0.05) and np.all(np.diff(frame) > 0.0):
            time = frame / fps
    return time, _rows(path, table, _STATE, states), _rows(path, table, _ACTION, actions)


def _files(path: Path, info: dict[str, Any], episode: int) -> list[Path]:
    """Where an episode's frames may be."""
    pattern = info.get("data_path")
    if isinstance(pattern, str) and "{episode_index" in pattern:
        size = info.get("chunks_size")
        chunk = episode // size if isinstance(size, int) and size > 0 else 0
        try:
            return [path / pattern.format(episode_chunk=chunk, episode_index=episode)]
        except (KeyError, IndexError, ValueError, AttributeError):
            raise LogError(f"{path.name}, {_INFO}: data_path {pattern!r} is none") from None
    return sorted((path / "data").glob("*/*.parquet"))


def _rows(path: Path, table: pa.Table, feature: str, count: int) -> Array:
    rows = table[feature].to_pylist()
    if any(row is None or len(row) != count for row in rows):
        raise LogError(f"{path.name}, {feature}: not {count} numbers in every frame")
    return np.array(rows, dtype=np.float64)
