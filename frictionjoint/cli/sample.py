"""``frictionjoint sample``: parameter sets to simulate every joint that this one could be."""

import json
from pathlib import Path
from typing import Annotated

import typer


def sample(
    report: Annotated[
        Path, typer.Argument(metavar="REPORT", help="report.json of close-loop, or its folder.")
    ],
    n: Annotated[int, typer.Option("--n", min=1, help="How many.")],
    out: Annotated[Path, typer.Option("--out", metavar="JSON", help="File to write.")],
    seed: Annotated[int, typer.Option(min=0, help="Equal seeds, equal samples.")] = 0,
) -> None:
    """Draw parameter sets of a report, for domain randomisation.

    Writes a list of tables, each as a parameter file holds it:
    `frictionjoint.files.joint_friction(table)` makes what `install` takes.

    Example: `frictionjoint sample out --n 1024 --out samples.json`
    """
    from frictionjoint.errors import ParameterError
    from frictionjoint.files import toml_document
    from frictionjoint.refine.posterior import Posterior
    from frictionjoint.report.write import write_files

    file = report / "report.json" if report.is_dir() else report
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{file}: cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise ParameterError(f"{file}: not JSON: give report.json of close-loop") from None
    if not isinstance(content, dict) or "posterior" not in content:
        raise ParameterError(
            f"{file}: it holds no posterior: make the report again, of logs that determine the "
            "friction's scale"
        )
    try:
        drawn = Posterior.from_dict(content["posterior"]).sample(n, seed)
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}") from None
    tables = [toml_document(x.parameters, x.effects).unwrap() for x in drawn]
    write_files(out.parent, {out.name: json.dumps(tables, indent=1) + "\n"})
    typer.echo(f"Wrote {n} parameter sets to {out}")
