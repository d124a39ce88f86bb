"""The main commands as functions: `close_loop`, `identify`, `export`."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, overload

from frictionjoint.errors import ParameterError
from frictionjoint.export.targets import FILES, Target
from frictionjoint.law.names import LAWS
from frictionjoint.measured.arguments import expect

if TYPE_CHECKING:
    from frictionjoint.control.controller_file import GivenController
    from frictionjoint.export.run import Exported
    from frictionjoint.identify.fixed_joints import Pose
    from frictionjoint.identify.run import Identified
    from frictionjoint.measured.log import JointLog
    from frictionjoint.report.joint_report import Report
    from frictionjoint.report.robot_report import RobotReport


def _silent(text: str) -> None:
    """A progress function that prints nothing."""


@overload
def close_loop(
    logs: "Sequence[JointLog | str | Path]",
    model: "str | Path | Mapping[str, str | Path]",
    joint: str,
    held_out: "Sequence[JointLog | str | Path] | float" = ...,
    seed: int = ...,
    progress: Callable[[str], None] | None = ...,
    law: str | None = ...,
    fixed: "Mapping[str, Pose] | None" = ...,
    controller: "GivenController | None" = ...,
    refine: bool | None = ...,
    jobs: int | None = ...,
) -> "Report": ...


@overload
def close_loop(
    logs: "Sequence[JointLog | str | Path]",
    model: "str | Path | Mapping[str, str | Path]",
    joint: list[str] | tuple[str, ...] | None = ...,
    held_out: "Sequence[JointLog | str | Path] | float" = ...,
    seed: int = ...,
    progress: Callable[[str], None] | None = ...,
    law: str | None = ...,
    fixed: "Mapping[str, Pose] | None" = ...,
    controller: "GivenController | None" = ...,
    refine: bool | None = ...,
    jobs: int | None = ...,
) -> "RobotReport": ...


def close_loop(
    logs: "Sequence[JointLog | str | Path]",
    model: "str | Path | Mapping[str, str | Path]",
    joint: str | list[str] | tuple[str, ...] | None = None,
    held_out: "Sequence[JointLog | str | Path] | float" = 0.25,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    law: str | None = None,
    fixed: "Mapping[str, Pose] | None" = None,
    controller: "GivenController | None" = None,
    refine: bool | None = None,
    jobs: int | None = 1,
) -> "Report | RobotReport":
    """Identify friction from logs and find what the model lacks.

    Args:
        logs: to fit and to search, at least one; logs, their files, or folders of files. Logs of a
            folder that are held out are not fitted. For a robot: files.
        model: path or text of the MJCF or URDF; for one joint with different loads, one by a
            pattern of the logs' names, ``{"light*": "light.xml", "heavy*": "heavy.xml"}``.
        joint: name of one joint; names of several joints of a robot; None: all joints of the model
            whose position and drive every log contains.
        held_out: logs used for neither fit nor search, or the fraction of each log to hold out at
            its end.
        seed: equal seeds give equal reports.
        progress: called with a description of the current step.
        law: name of the friction law, one of ``frictionjoint.law.names.LAWS``; None: the integrated
            law.
        fixed: positions of joints that the logs do not contain, by name, rad (m).
        controller: what drove the joints to their targets: a `Controller`, its file, the name of a
            preset, one per joint by name, or "mjcf" for the model's own position servos.
        refine: whether all parameters are finally fitted to simulated motion. They are used if they
            predict logs better that were left out. None: if the logs have a target and the
            controller is known; True: also by runs of half a second with the measured torque;
            False: never.
        jobs: processes for the joints of a robot; None: one per core. With more than one, a script
            needs the guard ``if __name__ == "__main__":``. The result does not depend on it.
    Returns:
        the report of one joint, or of a robot. Both have ``summary()``, ``plot()``, ``to_dict()``.
    Raises:
        FrictionJointError: bad logs or model, in one line.
        TypeError: an argument of a wrong type.
    """
    from frictionjoint.measured.readers import each_log, require_logs

    require_logs(logs, held_out)
    fraction = float(held_out) if isinstance(held_out, float | int) else None
    kept = [] if isinstance(held_out, float | int) else each_log(held_out)
    logs = each_log(logs, kept)
    names = "give the name of one joint, a list of names, or None for all"
    expect(joint, (str, list, tuple, NoneType), "joint", names)
    expect(model, (str, Path, Mapping), "model", "give the path of an MJCF, or its text")
    from frictionjoint.robot.close_loop import Options, close_loop_logs
    from frictionjoint.robot.logs import RobotLogs

    how = Options(seed, progress or _silent, law, fixed, controller, refine, jobs)
    return close_loop_logs(RobotLogs.read(logs, kept, fraction, model, joint), model, how)


def identify(
    logs: "Sequence[JointLog | str | Path]",
    model: "str | Path | Mapping[str, str | Path]",
    joint: str,
    law: str = LAWS[0],
    fixed: "Mapping[str, Pose] | None" = None,
    controller: "GivenController | None" = None,
    progress: Callable[[str], None] | None = None,
) -> "Identified":
    """Fit the friction law of one joint, without a search for missing effects.

    Args:
        logs: at least one; logs, their files, or folders of files.
        joint: its name in the model and in the logs.
        law: name of the friction law, one of ``frictionjoint.law.names.LAWS``.
        model: see `close_loop`, also for fixed, controller and progress.
    Returns:
        parameters with standard errors; ``identified.parameters`` is what `install` takes.
    Raises:
        FrictionJointError: bad logs or model, in one line.
        TypeError: an argument of a wrong type.
    """
    from frictionjoint.identify.run import identify_law
    from frictionjoint.measured.log import JointLog
    from frictionjoint.measured.readers import each_log, read_log, require_logs

    require_logs(logs, 0.0)
    read = [x if isinstance(x, JointLog) else read_log(x, joint) for x in each_log(logs)]
    return identify_law(read, model, joint, law, fixed, controller, progress or _silent)


def export(
    model: str | Path,
    to: Target,
    out: str | Path,
    speeds: tuple[float, float] | None = None,
    log: str | Path | None = None,
    columns: Mapping[str, str] | None = None,
    lugre: bool = False,
    yielding: bool = False,
    force: bool = False,
) -> "Exported":
    """Convert the friction of a model for another program and write the file.

    Args:
        model: MJCF with friction.
        to: "c", "native", "mjx", "urdf", "mjlab", "newton" or "isaac".
        out: file to write, or a folder for it.
        speeds: lowest and highest, rad/s (m/s), over which plain friction is fitted.
        log: its motion is used instead of speeds, with `columns`, see `read_log`.
        lugre: for "native": MuJoCo's own LuGre friction.
        yielding: for "native" on MuJoCo 4.0: presliding with memory, by springs that yield.
        force: overwrite an existing file.
    Returns:
        the written text, and what the target cannot represent.
    Raises:
        FrictionJointError: no friction in the model, an existing file, or an unknown target.
    """
    from frictionjoint.export.run import export as run
    from frictionjoint.export.run import output_file
    from frictionjoint.report.write import write_files

    if to not in FILES:
        raise ParameterError(f"to is {to!r}: give one of {', '.join(FILES)}")
    if speeds is not None and log is not None:
        raise ParameterError("speeds and log are given: give one of them")
    file = output_file(Path(out), to)
    if file.exists() and not force:
        raise ParameterError(f"{file} exists already: give another out, or force=True")
    where = None if log is None else Path(log)
    done = run(Path(model), to, file, speeds, where, columns, lugre, yielding, _silent)
    write_files(file.parent, {file.name: done.text})
    return done
