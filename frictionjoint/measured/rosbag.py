"""ROS bags with sensor_msgs/JointState: ROS 2 folders, single .db3 and .mcap files, ROS 1 .bag.

Read with the ``rosbags`` library, no ROS installation needed. ``effort`` is the torque, N m (N for
a slide). Time is the message's stamp; where no stamp was set, the time of recording.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.arrays import corrupt
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.table import log_of

SUFFIXES = (".db3", ".mcap", ".bag")
_TYPE = "sensor_msgs/msg/JointState"


def is_bag(path: Path) -> bool:
    """Whether a path is a bag: a file by its name, a folder by its metadata."""
    return path.suffix.lower() in SUFFIXES or (path / "metadata.yaml").is_file()


def read_rosbag(
    path: Path, joint: str | None, columns: Mapping[str, str] | None = None
) -> JointLog:
    """Read one joint; rows in messages are its samples, counted from 1.

    Args:
        columns: ``{"topic": name}`` where the bag has several JointState topics, and
            ``{"position_m": "position"}`` to say that the joint is a slide.
    Raises:
        LogError: no such topic or joint, rosbags is missing, or see `validate`.
    """
    mapping = dict(columns or {})
    topic = mapping.pop("topic", None)
    slide = mapping.pop("position_m", None) == "position"
    if mapping:
        raise LogError(f"{path.name}: a bag takes the columns topic and position_m, not {mapping}")
    samples = _by_joint(path, topic)
    if joint is None and len(samples) == 1:
        joint = next(iter(samples))
    if joint is None or joint not in samples:
        what = f"no joint {joint!r}, it has" if joint else "several joints, name one of"
        raise LogError(f"{path.name}: {what} {', '.join(sorted(samples))}")
    own = samples.pop(joint)
    time = own[:, 0]
    units = (
        ("position_m", "velocity_m_s", "force_n")
        if slide
        else ("position_rad", "velocity_rad_s", "torque_nm")
    )
    data = {"time_s": time} | {
        name: own[:, k].copy()
        for k, name in enumerate(units, start=1)
        if not np.isnan(own[:, k]).all()
    }
    if units[2] not in data:
        raise LogError(f"{path.name}, {joint}: effort is empty, record a bag with torques")
    for other, x in samples.items():
        if np.array_equal(x[:, 0], time):  # published in the same messages
            data[f"{other}.position_rad"] = x[:, 1].copy()
            if np.isfinite(x[:, 2]).all():
                data[f"{other}.velocity_rad_s"] = x[:, 2].copy()
    return log_of(path, joint, data)


def joints_of_bag(path: Path, columns: Mapping[str, str] | None = None) -> list[str]:
    """Names of the joints whose effort a bag holds.

    Raises:
        LogError: see `read_rosbag`.
    """
    samples = _by_joint(path, dict(columns or {}).get("topic"))
    return [name for name, x in samples.items() if not np.isnan(x[:, 3]).all()]


def _by_joint(path: Path, topic: str | None) -> dict[str, Array]:
    """Rows of time, position, velocity, effort by joint; what a message leaves out is NaN."""
    rows: dict[str, list[tuple[float, ...]]] = {}
    try:
        for message, recorded in _messages(path, topic):
            stamp = message.header.stamp
            nanoseconds = stamp.sec * 1_000_000_000 + stamp.nanosec or recorded
            for i, name in enumerate(message.name):
                fields = (message.position, message.velocity, message.effort)
                values = (float(x[i]) if i < len(x) else np.nan for x in fields)
                rows.setdefault(str(name), []).append((nanoseconds, *values))
    except LogError:
        raise
    except Exception as error:  # a corrupt bag fails anywhere in the library
        raise corrupt(path, error) from None
    if not rows:
        raise LogError(f"{path.name}: its JointState messages name no joint")
    # from the first sample, in whole nanoseconds: stamps since 1970 lose digits in a float
    start = min(int(samples[0][0]) for samples in rows.values())
    return {
        name: np.array([((int(t) - start) * 1e-9, *rest) for t, *rest in samples])
        for name, samples in rows.items()
    }


def _messages(path: Path, topic: str | None) -> Iterator[tuple[Any, int]]:
    """JointState messages of one topic with their recording times, ns."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise LogError(f"{path.name}: reading a bag needs rosbags: pip install rosbags") from None
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        found = [c for c in reader.connections if c.msgtype == _TYPE]
        topics = sorted({c.topic for c in found})
        if not topics or (topic is not None and topic not in topics):
            asked = f" named {topic}" if topic else ""
            there = sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections})
            raise LogError(
                f"{path.name}: no {_TYPE} topic{asked}, it has {', '.join(there) or 'none'}"
            )
        if topic is None and len(topics) > 1:
            raise LogError(f"{path.name}: several topics, name one of {', '.join(topics)}")
        chosen = [c for c in found if c.topic == (topic or topics[0])]
        for connection, recorded, raw in reader.messages(connections=chosen):
            yield reader.deserialize(raw, connection.msgtype), recorded
