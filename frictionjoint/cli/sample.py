"""``frictionjoint sample``: parameter sets within the errors of a report."""

import json
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.logs import ReportJoint
from frictionjoint.cli.output import Force, require_writable
from frictionjoint.cli.plain_help import argument, option


def sample(
    report: Annotated[Path, argument("REPORT", "report.json of close-loop, or its folder.")],
    n: Annotated[int, typer.Option(min=1, max=100_000, help="Number of samples.")],
    out: Annotated[Path, option("JSON", "File to write.")],
    joint: ReportJoint = None,
    seed: Annotated[int, typer.Option(min=0, help="Equal seeds give equal samples.")] = 0,
    force: Force = False,
) -> None:
    """Draw parameter sets of a report, for domain randomisation.

    Writes a JSON list of tables with the keys of a parameter file. In Python,
    `frictionjoint.files.joint_friction(table)` makes the friction that `fj.install` adds.

    Examples:

    `frictionjoint sample out --n 1024 --out samples.json`

    `frictionjoint sample robot_report --joint elbow --n 1024 --out elbow.json`
    """
    from frictionjoint.errors import ParameterError
    from frictionjoint.files import toml_document
    from frictionjoint.refine.posterior import Posterior
    from frictionjoint.report.joints import read_joint
    from frictionjoint.report.write import write_files

    if out.suffix.lower() != ".json":
        raise ParameterError(f"--out {out}: the name must end in .json")
    file, _, own = read_joint(report, joint)
    require_writable(out, [file], force)
    if "posterior" not in own:
        raise ParameterError(
            f"{file}: it contains no parameter uncertainty: make the report from logs that "
            "determine the torque scale"
        )
    try:
        drawn = Posterior.from_dict(own["posterior"]).sample(n, seed)
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}") from None
    tables = [toml_document(x.parameters, x.effects).unwrap() for x in drawn]
    write_files(out.parent, {out.name: json.dumps(tables, indent=1) + "\n"})
    typer.echo(f"Wrote {n} parameter sets to {out}")
