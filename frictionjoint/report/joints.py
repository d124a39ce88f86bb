"""The joints in report.json: those of a robot in the form of a report of one joint."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from frictionjoint.errors import ParameterError
from frictionjoint.files import joint_friction
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.parameter_checks import require
from frictionjoint.parameter_meanings import UNITS
from frictionjoint.refine.posterior import Posterior
from frictionjoint.report.entries import Added, LogEntry, Looked
from frictionjoint.report.joint_report import SCHEMA, Verdict
from frictionjoint.report.robot_report import SCHEMA as ROBOT
from frictionjoint.report.robot_report import UNITS_SCHEMA
from frictionjoint.structured_files import read_json, require_form

# what belongs to a robot, not to one of its joints
_ROBOT = ("schema", "logs", "made")
_LAW = {"law": str, "parameters": dict[str, Estimate]}
_ERRORS = {"torque_rms": Rms, "replay_rms?": Rms, "closed_loop_mae?": Rms}
# what is read of a joint, see `require_form`
_JOINT = {
    "joint": str,
    "verdict": Verdict,
    "logs": list[LogEntry],
    "log_errors?": [{"name": str, "role": str, "before": float | None, "after": float | None}],
    "units?": {"torque": str, "position": str},
    "slide?": bool,
    "drive?": {"source?": str, "rms?": dict[str, Rms]},
    "intervals?": dict[str, dict[str, list[float]] | None],
    "bandwidth_hz?": float,
    "at_rest?": float | None,
    "base": _LAW,
    "before": _ERRORS,
    "added": list[Added],
    "after": _LAW | _ERRORS,
    "refined?": {"taken": bool, "parameters": dict[str, Estimate]},
    "model?": dict[str, Any],
    "posterior?": {
        "parameters": dict[str, Any],
        "factor": list[list[float]],
        "of_gain?": int,
        "constraint?": {"lead": float, "V0": float},
    },
    "thresholds?": {"gain": float, "p_value": float},
    "candidates?": list[Looked],
    "smallest?": [{"name": str, "least": float | None, "most": float | None}],
    "law_errors?": dict[str, float],
    "noise_floor?": float | None,
    "unexplained": [{"variable": str, "share": float}],
    "unexplained_causes?": dict[str, str],
    "proposals?": list[str],
    "notes?": list[str],
}


def joint_content(content: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The content of one joint, in the form of a report-1."""
    if "joints" not in content:
        return dict(content)
    own = {key: content[key] for key in _ROBOT if key in content}
    # an effect that joints have in common is one of their own too
    shared = (x for x in content.get("shared", ()) if "common_to" not in x)
    own["shared"] = [x for x in shared if name in x["joints"]]
    return {**own, "joint": name, **content["joints"][name]}


def read_joints(path: Path) -> tuple[Path, dict[str, dict[str, Any]]]:
    """The report.json of a folder, or a file itself, and the content of each joint by name;
    ParameterError if it is missing, no report of a joint or a robot, or damaged."""
    file = path / "report.json" if path.is_dir() else path
    content = read_json(file, "give report.json of close-loop")
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema == UNITS_SCHEMA:
        raise ParameterError(f"{file}: a report of several robots: give the folder of one of them")
    if schema not in (SCHEMA, ROBOT):
        raise ParameterError(
            f"{file}: not a report of a joint that this version reads, its schema is {schema!r}: "
            "give report.json of close-loop"
        )
    joints: dict[str, dict[str, Any]] = {}
    try:
        if schema == ROBOT:
            require_form(content, {"joints": dict[str, dict[str, Any]]}, "report")
        for name in content["joints"] if schema == ROBOT else (content.get("joint"),):
            own = joint_content(content, name)
            require_form(own, _JOINT, f"joints.{name}" if schema == ROBOT else "report")
            for stage in ("base", "after"):
                for number, x in own[stage]["parameters"].items():
                    known = number.partition("_")[0] in UNITS
                    require(not known or x["value"] >= 0.0, number, x["value"], "0 or more")
            if "model" in own:
                joint_friction(own["model"])
            if "posterior" in own:
                Posterior.from_dict(own["posterior"])
            joints[name] = own
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}; make the report again with close-loop") from None
    return file, joints


def read_joint(path: Path, joint: str | None) -> tuple[Path, str, dict[str, Any]]:
    """The file of a report, and name and content of one joint; None for the only one.
    ParameterError: see `read_joints`, also if the joint is not in it, or there are several."""
    file, joints = read_joints(path)
    names = ", ".join(joints)
    if joint is None and len(joints) != 1:
        raise ParameterError(f"{file}: a report of a whole robot: choose one with --joint: {names}")
    if joint is not None and joint not in joints:
        raise ParameterError(f"{file}: no joint {joint!r} in it, it has {names}")
    name = next(iter(joints)) if joint is None else joint
    return file, name, joints[name]
