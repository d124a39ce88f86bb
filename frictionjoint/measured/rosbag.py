"""ROS bags with sensor_msgs/JointState: ROS 2 folders, single .db3 and .mcap files, ROS 1 .bag.

They are read with the ``rosbags`` library; no ROS installation is needed. ``effort`` is the torque,
N m (N for a slide). Time is the message's stamp, or the time of recording if there is no stamp.

Commands come from a topic that the user names: JointState messages with commanded positions; the
state of a joint trajectory controller, whose reference is the target of the position loop; or the
Float64MultiArray of a forward controller, whose joints are named in its order and whose time is
that of recording. A JointTrajectory is not sufficient, because its interpolation is up to its
controller.

Messages of any other type are read where their fields are named: ``position_rad=state.q[2]``.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import library, part_of, whole
from frictionjoint.measured.columns import HINGE, KNOWN, SLIDE, column_options, one_joint
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import ReadOptions, log_of

SUFFIXES = (".db3", ".mcap", ".bag")
_TYPE = "sensor_msgs/msg/JointState"
# messages that hold commanded positions by joint
_COMMANDS = (
    *(_TYPE, "control_msgs/msg/JointTrajectoryControllerState"),
    "std_msgs/msg/Float64MultiArray",
)
# rows of a joint: ns, then these, in the order of `HINGE`
_POSITION, _VELOCITY, _EFFORT, _TARGET = range(1, 5)
_Rows = dict[str, list[tuple[float, ...]]]


def is_bag(path: Path) -> bool:
    """Whether a path is a bag: a file by its name, a folder by its metadata."""
    return path.suffix.lower() in SUFFIXES or (path / "metadata.yaml").is_file()


def read_rosbag(path: Path, joint: str | None, how: ReadOptions) -> JointLog:
    """Read one joint; rows in messages are its samples, counted from 1.

    Args:
        how: columns ``{"topic": name}`` if the bag has several JointState topics, ``{"command":
            name}`` for the topic of commands, ``{"joints": "a,b"}`` for their joints in order if
            they carry no names, ``{"position_m": "position"}`` for a slide; or fields of any
            messages by our names: ``{"topic": name, "position_rad": "state.q[2]"}``.
    Raises:
        LogError: no such topic or joint, rosbags is missing, or see `validate`.
    """
    mapping, only = dict(how.columns), ReadOptions(units=how.units)
    if any(name in (*KNOWN, "time_s") for name in mapping if mapping[name] != "position"):
        return _read_fields(path, joint, mapping, only)
    known = ("topic", "command", "joints", "position_m")
    *topics, position = column_options(path.name, mapping, known, "a bag")
    names = SLIDE if position == "position" else HINGE
    samples = _by_joint(path, *topics)
    joint = one_joint(path.name, sorted(samples), joint)
    time, *columns = samples.pop(joint).T.copy()
    there = (pair for pair in zip(names, columns, strict=True) if not np.isnan(pair[1]).all())
    data = {"time_s": time, **dict(there)}
    if names[2] not in data and names[3] not in data:
        what = "no command names it" if topics[1] else "name the topic of its commands (command)"
        fix = "record torques or commands"
        raise LogError(f"{path.name}, {joint}: effort is empty and {what}: {fix}")
    for other, x in samples.items():
        if np.array_equal(x[:, 0], time):  # published in the same messages
            data[f"{other}.position_rad"] = x[:, _POSITION].copy()
            if np.isfinite(x[:, _VELOCITY]).all():
                data[f"{other}.velocity_rad_s"] = x[:, _VELOCITY].copy()
    return log_of(path, joint, data, only)


def _read_fields(
    path: Path, joint: str | None, mapping: dict[str, str], how: ReadOptions
) -> JointLog:
    """A log from named fields of the messages of a topic, of whatever type."""
    topic = mapping.pop("topic", None)
    alien = [name for name in mapping if name not in (*KNOWN, "time_s")]
    if alien:
        column = f"--column {alien[0]}"
        raise LogError(f"{path.name}: {column} cannot be used with named fields: omit it")
    found: dict[str, list[Array]] = {name: [] for name in ("time_s", *mapping)}
    try:
        for message, recorded in _messages(path, topic, None):
            sizes = []
            for ours, field in mapping.items():
                value = np.atleast_1d(np.asarray(part_of(message, field), dtype=np.float64))
                found[ours].append(value.ravel())
                sizes.append(value.size)
            if len(set(sizes)) > 1:
                what = f"the fields of a message have {min(sizes)} to {max(sizes)} numbers"
                fix = "name parts of the same length, e.g. position[0]"
                raise LogError(f"{path.name}: {what}: {fix}")
            if "time_s" not in mapping:
                found["time_s"].append(np.full(sizes[0], 1e-9 * _nanoseconds(message, recorded)))
    except LogError:
        raise
    except (AttributeError, IndexError, TypeError, ValueError) as error:
        raise LogError(f"{path.name}: a field is missing or contains no numbers: {error}") from None
    data = {name: np.concatenate(parts) for name, parts in found.items()}
    data["time_s"] = data["time_s"] - (0.0 if "time_s" in mapping else data["time_s"][0])
    return log_of(path, joint or "joint", data, how)


def joints_of_bag(path: Path, columns: Mapping[str, str] | None) -> list[str]:
    """Names of the joints with effort or commands in a bag."""
    mapping = dict(columns or {})
    samples = _by_joint(path, *(mapping.get(name) for name in ("topic", "command", "joints")))
    drives = [_EFFORT, _TARGET]
    return [name for name, x in samples.items() if not np.isnan(x[:, drives]).all()]


def _by_joint(
    path: Path, topic: str | None, command: str | None, joints: str | None
) -> dict[str, Array]:
    """Rows of time, position, velocity, effort, target by joint; missing values are NaN."""
    order = [name.strip() for name in joints.split(",")] if joints else []
    rows: _Rows = {}
    commands: _Rows = {}
    with whole(path):
        for message, recorded in _messages(path, topic, (_TYPE,), other_than=command):
            for i, name in enumerate(message.name):
                fields = (message.position, message.velocity, message.effort)
                values = (float(x[i]) if i < len(x) else np.nan for x in fields)
                rows.setdefault(str(name), []).append((_nanoseconds(message, recorded), *values))
        for message, recorded in _messages(path, command, _COMMANDS) if command else ():
            for name, position in _commanded(path, message, order):
                commands.setdefault(name, []).append((_nanoseconds(message, recorded), position))
    if not rows:
        raise LogError(f"{path.name}: its JointState messages name no joint")
    # from the first sample, in whole nanoseconds: stamps since 1970 lose digits in a float
    start = min(int(samples[0][0]) for samples in rows.values())
    return {
        name: _with_target(path, name, samples, commands.get(name, []), start)
        for name, samples in rows.items()
    }


def _nanoseconds(message: Any, recorded: int) -> int:
    if not hasattr(message, "header"):
        return recorded
    stamp = message.header.stamp
    return int(stamp.sec * 1_000_000_000 + stamp.nanosec) or recorded


def _commanded(path: Path, message: Any, order: list[str]) -> Iterator[tuple[str, float]]:
    """Joints of a command, or `order`, with positions; LogError if their numbers differ."""
    if hasattr(message, "data"):
        if len(order) != len(message.data):
            has = f"{len(message.data)} numbers without names, but {len(order)} names are given"
            fix = "give --column joints=NAME,NAME in that order"
            raise LogError(f"{path.name}: a command has {has}: {fix}")
        pairs = zip(order, message.data, strict=True)
    elif hasattr(message, "joint_names"):
        # called desired before ROS 2 Iron
        point = message.reference if hasattr(message, "reference") else message.desired
        pairs = zip(message.joint_names, point.positions, strict=False)
    else:
        pairs = zip(message.name, message.position, strict=False)
    for name, position in pairs:
        yield str(name), float(position)


def _with_target(
    path: Path,
    joint: str,
    samples: list[tuple[float, ...]],
    commands: list[tuple[float, ...]],
    start: int,
) -> Array:
    """Rows of a joint, (n, 5): a command holds until the next; before the first there is none."""
    found = np.full((len(samples), 5), np.nan)
    found[:, :4] = [((int(t) - start) * 1e-9, *rest) for t, *rest in samples]
    if not commands:
        return found
    commands = sorted(commands)
    given = np.array([(int(t) - start) * 1e-9 for t, _ in commands])
    at = np.searchsorted(given, found[:, 0] + 1e-9, side="right") - 1
    known = at >= 0
    if not known.any():
        late = f"{given[0] - found[-1, 0]:.3g} s after the last position"
        what = f"the first command comes {late}"
        raise LogError(f"{path.name}, {joint}: {what}: do both use one clock?")
    found[known, _TARGET] = np.array([x for _, x in commands])[at[known]]
    return found[known]


def _messages(
    path: Path, topic: str | None, kinds: tuple[str, ...] | None, other_than: str | None = None
) -> Iterator[tuple[Any, int]]:
    """Messages of one topic, but not `other_than`, with their recording times, ns."""
    rosbags, types = (library(path, "a bag", f"rosbags.{x}") for x in ("highlevel", "typesys"))
    types = types.get_typestore(types.Stores.ROS2_HUMBLE)
    with rosbags.AnyReader([path], default_typestore=types) as reader:
        found = [
            c
            for c in reader.connections
            if (kinds is None or c.msgtype in kinds) and c.topic != other_than
        ]
        topics = sorted({c.topic for c in found})
        if not topics or (topic is not None and topic not in topics):
            asked = f" named {topic}" if topic else ""
            there = sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections})
            raise LogError(
                f"{path.name}: no {' or '.join(kinds or ('such',))} topic{asked}, it has "
                f"{', '.join(there) or 'none'}; for other messages, name the fields: --column "
                "topic=TOPIC --column position_rad=FIELD"
            )
        if topic is None and len(topics) > 1:
            fix = f"name one with --column topic=: {', '.join(topics)}"
            raise LogError(f"{path.name}: several topics, {fix}")
        chosen = [c for c in found if c.topic == (topic or topics[0])]
        for connection, recorded, raw in reader.messages(connections=chosen):
            yield reader.deserialize(raw, connection.msgtype), recorded
