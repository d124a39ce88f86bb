"""The command `identify`: the friction law of one joint, without a search for effects."""

import json
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import (
    LAW_TO_FIT,
    LOG_FORMATS,
    Columns,
    ControllerFile,
    DropNan,
    Fixed,
    Gain,
    Join,
    Model,
    Reading,
    Signals,
    Units,
    Wrap,
    log_paths,
    models_of,
    paths_of,
    poses,
    the_joint,
)
from frictionjoint.cli.output import Force, Json, require_writable
from frictionjoint.cli.terminal import console, progress, show_estimates
from frictionjoint.law.names import LAWS

Logs = Annotated[
    list[Path],
    typer.Argument(metavar="LOG", help=LOG_FORMATS),
]
Joint = Annotated[
    str | None,
    typer.Option(
        "--joint",
        metavar="NAME",
        help="The joint in the MJCF and in the logs. Default: the model's only one.",
    ),
]
Law = Annotated[str, typer.Option("--law", help=LAW_TO_FIT)]


def identify(
    logs: Logs,
    model: Model,
    out: Annotated[Path, typer.Option("--out", metavar="TOML", help="Parameter file to write.")],
    joint: Joint = None,
    law: Law = LAWS[0],
    fixed: Fixed = None,
    controller: ControllerFile = None,
    gain: Gain = None,
    column: Columns = None,
    signal: Signals = None,
    wrap: Wrap = None,
    unit: Units = None,
    join: Join = False,
    drop_nan: DropNan = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit the friction law of one joint and write its parameters.

    Example: `frictionjoint identify a.csv --model arm.xml --joint elbow --out elbow.toml`

    Another law: `... --law lugre --out lugre.toml`, then `frictionjoint compare *.toml`
    """
    from frictionjoint.control.controller import unknown_notes
    from frictionjoint.control.controller_file import controller_of
    from frictionjoint.control.reconstruct import check_drive
    from frictionjoint.diagnose.intervals import stated_covariance
    from frictionjoint.diagnose.notes import inertia_note
    from frictionjoint.files import toml_text, toml_text_without_scale
    from frictionjoint.identify.bodies import Bodies
    from frictionjoint.identify.damping import with_damping
    from frictionjoint.identify.fit import without_scale
    from frictionjoint.identify.gate import check as check_balance
    from frictionjoint.identify.gate import check_fit, scale_is_determined
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.result import (
        law_estimates,
        law_parameters,
        scale_note,
        units_of,
    )
    from frictionjoint.identify.rival_shape import forms_of
    from frictionjoint.identify.starts import fit
    from frictionjoint.identify.weights import reweighed
    from frictionjoint.measured.bounded import bounded
    from frictionjoint.report.write import write_files

    with progress() as say:
        paths = log_paths(logs, [], join)
        logs = paths.logs
        require_writable(out, [*logs, *paths_of(model)], force)
        forms = forms_of(law)
        joint = the_joint(joint, model)
        bodies = Bodies(models_of(model), joint, poses(fixed))
        driven_by = controller_of(controller, joint, bodies.models)
        reading = Reading.of(joint, column, signal, wrap, gain, unit, paths.joined, drop_nan)
        read = bounded([reading.read(path) for path in logs])
        said = bodies.check(read, ())
        body = bodies.of(read)[0]
        if driven_by:
            said += tuple(note for log in read for note in check_drive(log, driven_by))
            said += unknown_notes(driven_by)
        prepared = prepare(read, bodies.of(read), controller=driven_by)
        check_balance(prepared)
        found = fit(prepared, forms=forms, progress=say)
        prepared, fitted = reweighed(prepared, found)
        fitted = with_damping(prepared, fitted)
        check_fit(prepared, fitted)
        scaled = scale_is_determined(prepared, fitted)
        if not scaled:
            fitted = without_scale(fitted)
        torque_unit, _ = units_of(fitted, body.slide)
        estimates = law_estimates(fitted, stated_covariance(prepared, fitted), body.slide)
        parameters = law_parameters(fitted)
        toml = toml_text(parameters) if scaled else toml_text_without_scale(parameters, torque_unit)
        write_files(out.parent, {out.name: toml})
    if as_json:
        rows = {name: x.to_dict() for name, x in estimates.items()}
        result = {"unit": torque_unit, "torque_rms": fitted.rms, "parameters": rows}
        typer.echo(json.dumps(result, indent=2))
        return
    show_estimates(list(estimates.items()))
    notes = (*said, *scale_note(fitted, body.slide), *inertia_note(prepared, fitted))
    for text in notes:
        console().print(f"* {text}", soft_wrap=True, markup=False)
    typer.echo(
        f"Residual {fitted.rms:.4g} {torque_unit} of {fitted.target_rms:.4g} {torque_unit}. "
        f"Wrote {out}"
    )
