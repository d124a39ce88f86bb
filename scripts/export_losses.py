"""What each export loses, as the table of docs/export.md.

    python scripts/export_losses.py MODEL[=LOG]...

Each MODEL is an MJCF that carries friction; with a log its motion is taken, else the stated one.
Friction: rms of the torque along the motion; lost: rms of exported less ours, N m (N for a slide).
Loop: rms position error, mrad (mm), of a soft position loop with ours and with the exported
friction, and the rms distance of the two.
"""

import argparse
import tempfile
from pathlib import Path

from frictionjoint.errors import FrictionJointError
from frictionjoint.export.run import Target, export

WAYS = [
    ("native", Target.NATIVE, False),
    ("native, LuGre", Target.NATIVE, True),
    ("urdf", Target.URDF, False),
    ("newton", Target.NEWTON, False),
    ("isaac", Target.ISAAC, False),
]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="+", metavar="MODEL[=LOG]")
    print("| model | joint | target | friction | lost | loop, ours | loop, exported | apart |")
    print("|---|---|---|---|---|---|---|---|")
    for text in parser.parse_args().models:
        model, _, log = text.partition("=")
        for name, target, lugre in WAYS:
            with tempfile.TemporaryDirectory() as folder:
                out = Path(folder) / "out.xml"
                motion = Path(log) if log else None
                try:
                    done = export(Path(model), target, out, log=motion, lugre=lugre)
                except FrictionJointError as error:
                    print(f"| {Path(model).stem} | | {name} | {error} | | | | |", flush=True)
                    continue
            for x in done.losses:
                share = x.torque_lost / x.torque
                errors = " | ".join(f"{1e3 * e:.3g}" for e in (x.error, x.error_exported, x.apart))
                print(
                    f"| {Path(model).stem} | {x.joint} | {name} | {x.torque:.3g} | "
                    f"{x.torque_lost:.3g} ({share:.0%}) | {errors} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
