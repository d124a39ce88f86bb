"""LeRobot data sets (github.com/huggingface/lerobot, formats 2 and 3): positions and commands.

A folder with ``meta/info.json``, which names the joints of ``observation.state`` (position) and of
``action`` (target), and Parquet files below ``data`` with one row per frame: one episode per file
(format 2) or several (format 3). One episode is ``FOLDER#3``, several are ``FOLDER#0-7``. A data
set does not contain the unit, so it must be given. ``observation.velocity`` and
``observation.effort`` (torque, N m) are read if they exist.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import one_line, parquet_rows
from frictionjoint.measured.columns import column_options, one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import ReadOptions, log_of
from frictionjoint.measured.units import check_units, unit_of

_INFO = "meta/info.json"
_STATE, _ACTION = "observation.state", "action"
_MORE = {"observation.velocity": "velocity_rad_s", "observation.effort": "torque_nm"}


def is_lerobot(path: Path) -> bool:
    """Whether a folder is such a data set, or ``FOLDER#3`` one of its episodes."""
    return (path / _INFO).is_file() or episode_of(path)[1] is not None


def read_lerobot(path: Path, joint: str | None, how: ReadOptions) -> JointLog:
    """Read one joint of one episode.

    Args:
        path: the folder, or ``FOLDER#3`` for episode 3.
        how: columns ``{"episode": "3"}``, the episode's index where there are several and the path
            names none; ``{"unit": "deg"}`` is short for ``units={"position": "deg"}``, which must
            be given.
    Raises:
        LogError: not a data set, no such episode or joint, no unit, or see `validate`.
    """
    folder, numbered = episode_of(path)
    unit, episode = column_options(path.name, how.columns, ("unit", "episode"), "a data set")
    units = dict(how.units)
    if unit is not None:
        units.setdefault("position", unit)
    if unit_of(f"{joint}.position_rad", units) is None:
        fix = "give --unit position=deg or position=rad"
        fix += "; if positions go from -100 to 100, record them again with use_degrees"
        raise LogError(f"{path.name}: its unit is not in the data set: {fix}")
    check_units(units)
    path, episode = folder, numbered or episode
    info = _info(path)
    positions, targets = _joints(path, info, _STATE), _joints(path, info, _ACTION)
    both = [name for name in positions if name in targets]
    joint = one_joint(path.name, both, joint)
    widths = {_STATE: len(positions), _ACTION: len(targets)}
    widths |= {x: len(positions) for x in _MORE if _width(info, x) == len(positions)}
    time, more = _episode(path, info, episode, widths)
    state, action = more[_STATE], more[_ACTION]
    data = {"time_s": time, "position_rad": state[:, positions.index(joint)]}
    data["target_rad"] = action[:, targets.index(joint)]
    for feature, ours in _MORE.items():
        if feature in more:
            data[ours] = more[feature][:, positions.index(joint)]
    data |= {f"{n}.position_rad": state[:, i] for i, n in enumerate(positions) if n != joint}
    log = log_of(path, joint, data, ReadOptions(units=units))
    return log if numbered is None else replace(log, name=f"{log.name}#{numbered}")


def episode_of(path: Path) -> tuple[Path, str | None]:
    """Folder of a data set, and the episode that a path ``FOLDER#3`` names."""
    folder, mark, episode = path.name.rpartition("#")
    if mark and not path.exists() and is_lerobot(path.with_name(folder)):
        return path.with_name(folder), episode
    return path, None


def episodes_of(path: Path) -> list[int]:
    """Indices of all episodes of a data set, or of those that ``FOLDER#0-3,8`` names; LogError if
    it is no data set, or that no list of episodes."""
    folder, asked = episode_of(path)
    total = int(_info(folder).get("total_episodes") or 0)
    if asked is None:
        return list(range(total))
    found: list[int] = []
    for part in asked.split(","):
        first, dash, last = part.partition("-")
        if not (first.isdecimal() and (last.isdecimal() if dash else True)):
            raise LogError(f"{path.name}: write episodes as {folder.name}#3, #0-7 or #0-3,8")
        found += range(int(first), int(last or first) + 1)
    beyond = [i for i in found if i >= total]
    if beyond:
        raise LogError(f"{folder.name}: no episode {beyond[0]}, it has 0 to {total - 1}")
    return found


def joints_of_lerobot(path: Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Names of the joints with position and target in a data set; LogError if it is none."""
    folder, _ = episode_of(path)
    info = _info(folder)
    targets = _joints(folder, info, _ACTION)
    return [name for name in _joints(folder, info, _STATE) if name in targets]


def _info(path: Path) -> dict[str, Any]:
    try:
        info = json.loads((path / _INFO).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise LogError(f"{path.name}, {_INFO}: cannot be read as JSON: {one_line(error)}") from None
    if not isinstance(info, dict) or not isinstance(info.get("features"), dict):
        raise LogError(f"{path.name}, {_INFO}: no features: not a LeRobot data set")
    return info


def _joints(path: Path, info: dict[str, Any], feature: str) -> list[str]:
    """Names of a feature's numbers: a list of them, one in a list, or one in a table."""
    found = info["features"].get(feature)
    if not isinstance(found, dict):
        listed = ", ".join(info["features"]) or "none"
        raise LogError(f"{path.name}, {_INFO}: no feature {feature!r}, it has {listed}")
    names = found.get("names")
    if isinstance(names, dict) and len(names) == 1:
        (names,) = names.values()
    if isinstance(names, list) and len(names) == 1 and isinstance(names[0], list):
        (names,) = names
    count = _width(info, feature)
    if not isinstance(names, list) or len(names) != count:
        fix = f"name them in features, {feature}, names"
        place = f"{path.name}, {_INFO}, {feature}"
        raise LogError(f"{place}: {count} numbers and no name for each: {fix}")
    # a robot's own features are called shoulder_pan.pos; a point separates a joint and its column
    return [str(name).removesuffix(".pos").replace(".", " ") for name in names]


def _width(info: dict[str, Any], feature: str) -> int | None:
    """Number of values of a feature; None if it is not stated."""
    found = info["features"].get(feature)
    shape = found.get("shape") if isinstance(found, dict) else None
    return shape[0] if isinstance(shape, list) and shape else None


def _episode(
    path: Path, info: dict[str, Any], episode: str | None, widths: Mapping[str, int]
) -> tuple[Array, dict[str, Array]]:
    """Time, shape (n,), and each feature of so many numbers, shape (n, numbers)."""
    total = info.get("total_episodes")
    if episode is None and total == 1:
        episode = "0"
    if episode is None or not episode.isdecimal() or int(episode) >= int(total or 0):
        what = "several episodes" if episode is None else f"no episode {episode!r}"
        has = f"it has 0 to {int(total or 0) - 1}"
        raise LogError(f"{path.name}: {what}, {has}: name one as {path.name}#N")
    wanted = int(episode)
    columns, rule = ["timestamp", *widths], [("episode_index", "==", wanted)]
    tables = [parquet_rows(file, columns, rule) for file in _files(path, info, wanted)]
    if not any(table.num_rows for table in tables):
        raise LogError(f"{path.name}: no frame of episode {wanted} below data: is it whole?")
    table = {x: np.concatenate([t[x].to_numpy() for t in tables]) for x in columns}
    time = table["timestamp"].astype(np.float64)
    fps = info.get("fps")
    if isinstance(fps, int | float) and fps > 0.0:
        # stamps are multiples of the period in single precision: what they lost is known
        frame = np.round(time * fps)
        if np.all(np.abs(time * fps - frame) < 0.05) and np.all(np.diff(frame) > 0.0):
            time = frame / fps
    return time, {name: _rows(path, table[name], name, count) for name, count in widths.items()}


def _files(path: Path, info: dict[str, Any], episode: int) -> list[Path]:
    pattern = info.get("data_path")
    if isinstance(pattern, str) and "{episode_index" in pattern:
        size = info.get("chunks_size")
        chunk = episode // size if isinstance(size, int) and size > 0 else 0
        try:
            return [path / pattern.format(episode_chunk=chunk, episode_index=episode)]
        except (KeyError, IndexError, ValueError, AttributeError):
            what = f"data_path {pattern!r}"
            raise LogError(f"{path.name}, {_INFO}: {what} is not a valid pattern") from None
    return sorted((path / "data").glob("*/*.parquet"))


def _rows(path: Path, rows: NDArray[Any], feature: str, count: int) -> Array:
    if any(row is None or len(row) != count for row in rows):
        raise LogError(f"{path.name}, {feature}: not {count} numbers in every frame")
    return np.array(list(rows), dtype=np.float64)
