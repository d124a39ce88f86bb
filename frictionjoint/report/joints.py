"""The joints in report.json: those of a robot in the form of a report of one joint."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from frictionjoint.errors import ParameterError
from frictionjoint.structured_files import read_json

# what belongs to a robot, not to one of its joints
_ROBOT = ("schema", "logs", "made")


def joint_content(content: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The content of one joint, in the form of a report-1."""
    if "joints" not in content:
        return dict(content)
    own = {key: content[key] for key in _ROBOT if key in content}
    return {**own, "joint": name, **content["joints"][name]}


def read_joints(path: Path) -> tuple[Path, dict[str, dict[str, Any]]]:
    """The report.json of a folder, or a file itself, and the content of each joint by name.

    Raises:
        ParameterError: the file is missing, or no report of a joint or a robot.
    """
    file = path / "report.json" if path.is_dir() else path
    content = read_json(file, "give report.json of close-loop")
    if isinstance(content, dict) and "spread" in content:
        raise ParameterError(f"{file}: a report of several robots: give the folder of one of them")
    if not isinstance(content, dict) or not content.keys() & {"joint", "joints", "after"}:
        raise ParameterError(f"{file}: not a report of a joint: give report.json of close-loop")
    names = content.get("joints", {content.get("joint", ""): content})
    return file, {name: joint_content(content, name) for name in names}


def read_joint(path: Path, joint: str | None) -> tuple[Path, str, dict[str, Any]]:
    """The file of a report, and name and content of one joint; None for the only one.

    Raises:
        ParameterError: see `read_joints`, or the joint is not in it, or there are several.
    """
    file, joints = read_joints(path)
    names = ", ".join(joints)
    if joint is None and len(joints) > 1:
        raise ParameterError(f"{file}: a report of a whole robot: choose one with --joint: {names}")
    if joint is not None and joint not in joints:
        raise ParameterError(f"{file}: no joint {joint!r} in it, it has {names}")
    name = next(iter(joints)) if joint is None else joint
    return file, name, joints[name]
