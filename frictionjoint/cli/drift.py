"""The command `drift`: whether the friction of a joint still agrees with its report."""

from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import NO_OPTIONS, LogOptions, Logs, ReportJoint, log_paths, reads_logs
from frictionjoint.cli.output import Json, print_json
from frictionjoint.cli.plain_help import argument
from frictionjoint.cli.terminal import progress, show_table


@reads_logs("gain", "fixed", "controller")
def drift(
    report: Annotated[Path, argument("REPORT", "Folder of a report of close-loop.")],
    logs: Logs,
    joint: ReportJoint = None,
    options: LogOptions = NO_OPTIONS,
    as_json: Json = False,
) -> None:
    """State which friction numbers of a report are confirmed by new logs and which have changed.

    *Changed*: the difference exceeds 5% and what the errors of report and logs explain; the exit
    code is then 1. *Not resolvable* (–): the new logs would not show a change by half of the
    number, or the report assumes it. Logs of target and position need the controller next to the
    report, or --controller.

    Example: `frictionjoint drift report today.csv`
    """
    from dataclasses import asdict, replace

    from frictionjoint.control.controller_file import controller_of
    from frictionjoint.control.reconstruct import with_known_drive
    from frictionjoint.model_files import compile_model
    from frictionjoint.recordings.drift import drift as compared
    from frictionjoint.recordings.drift import known_of
    from frictionjoint.report.folder import controller_file

    with progress() as say:
        paths = log_paths(logs, [], options.join)
        known = replace(known_of(report, joint), fixed=options.poses)
        read = options.reader(paths)
        say("comparing")
        given = options.controller or controller_file(report, known.joint)
        drives = controller_of(given, known.joint, [compile_model(known.model)])
        new = [with_known_drive(read(path, known.joint), drives) for path in paths.logs]
        rows = compared(known, new)
    changed = [x.number for x in rows if x.state == "changed"]
    if as_json:
        content = {
            "joint": known.joint,
            "drift": bool(changed),
            "numbers": [asdict(x) for x in rows],
        }
        print_json(content)
    else:
        cells = (
            (
                f"{n.words}, {x.number}",
                f"{x.before:.4g}",
                "–" if x.now is None else f"{x.now:.4g}",
                "–" if x.stderr is None else f"{x.stderr:.2g}",
                x.state,
            )
            for n, x in zip(known.numbers, rows, strict=True)
        )
        show_table(("number", "report", "new logs", "standard error", "result"), cells)
    if changed:
        raise typer.Exit(1)
