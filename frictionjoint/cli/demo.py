"""The command `demo`: stick-slip, and the analysis of recordings that the package contains."""

from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from frictionjoint.cli.output import Force, Open, open_page, require_writable
from frictionjoint.cli.plain_help import option
from frictionjoint.cli.terminal import progress, show_report

_FOLDER = Path("frictionjoint-demo")


def demo(
    out: Annotated[Path, option("FOLDER", "Folder for the results.")] = _FOLDER,
    open_it: Open = False,
    force: Force = False,
) -> None:
    """Simulate stick-slip of a KUKA joint, then identify a recording that the package contains.

    Writes report.html, report.json, model.xml and stick_slip.svg into ./frictionjoint-demo/.

    Example: `frictionjoint demo --open`
    """
    from frictionjoint.commands import close_loop
    from frictionjoint.report.folder import FILES, write_report
    from frictionjoint.report.write import write_files
    from frictionjoint.simulate.stick_slip import draw, kuka_model, stick_slip

    # the demo's own folder contains nothing else
    again = out == _FOLDER and (out / FILES[0]).exists()
    require_writable(out, (), force or again, FILES)
    with progress() as say:
        say("stick-slip of the KUKA IR 361 joint")
        ours, native = stick_slip(kuka_model()), stick_slip(kuka_model(), native=True)
        write_files(out, {"stick_slip.svg": draw(ours, native)})
        folder = Path(str(files("frictionjoint.demo")))
        fit = [folder / f"{n}.csv" for n in ("pick_and_place", "ramps")]
        kept = [folder / "multisine.csv"]
        report = close_loop(fit, folder / "joint.xml", "joint", kept, progress=say)
        write_report(report, out, "frictionjoint demo")
    typer.echo(f"Part 1: stick-slip of a KUKA joint (see {out / 'stick_slip.svg'}).")
    typer.echo(ours.summary())
    typer.echo("\nPart 2: the friction of a joint and what its model lacks, from shipped logs.")
    show_report(report)
    done = "Replaced the files of an earlier run. " if again else ""
    typer.echo(f"\n{done}Open {out / 'report.html'} and {out / 'stick_slip.svg'}")
    if open_it:
        open_page(out / "report.html")
