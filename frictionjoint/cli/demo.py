"""The command `demo`: the main job on what ships with the package."""

from importlib.resources import files
from pathlib import Path

import typer

from frictionjoint.cli.logs import Reading
from frictionjoint.cli.output import require_writable
from frictionjoint.cli.terminal import progress, show_report


def demo() -> None:
    """Stick-slip of the KUKA joint, then the loop on a shipped log.

    Writes ./frictionjoint-demo/ with report.html, report.json, model.xml and stick_slip.svg.

    Example: `frictionjoint demo`, then open frictionjoint-demo/report.html
    """
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.report.write import FILES, write_files, write_report
    from frictionjoint.simulate.stick_slip import draw, kuka_model, stick_slip

    out = Path("frictionjoint-demo")
    require_writable(out, (), force=False, files=FILES)
    with progress() as say:
        say("stick-slip of the KUKA IR 361 joint")
        ours, native = stick_slip(kuka_model()), stick_slip(kuka_model(), native=True)
        write_files(out, {"stick_slip.svg": draw(ours, native)})
        folder = Path(str(files("frictionjoint.demo")))
        logs = Reading("joint")
        read = [logs.read(folder / f"{n}.csv") for n in ("pick_and_place", "ramps")]
        kept = [logs.read(folder / "multisine.csv")]
        report = close_loop(read, folder / "joint.xml", "joint", kept, progress=say)
        write_report(report, out, "frictionjoint demo")
    typer.echo(ours.summary())
    typer.echo("")
    show_report(report)
    typer.echo(f"Open {out / 'report.html'} and {out / 'stick_slip.svg'}")
