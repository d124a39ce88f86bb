"""What each export loses, as the table of lab/notes/exports.md.

    python lab/export_losses.py MODEL[=LOG]...

Each MODEL is an MJCF that carries friction, or the beginning of names in `frictionjoint motors`,
as ur10 of ur10_j1 to ur10_j6, installed in the MJCF they were identified with; with a log its
motion is taken, else the stated one.
Friction: rms of the torque along the motion; lost: rms of exported less ours, N m (N for a slide).
Loop: rms position error, mrad (mm), of a soft position loop with ours and with the exported
friction, and the rms distance of the two.
"""

import argparse
import tempfile
from pathlib import Path

import mujoco

from frictionjoint.errors import FrictionJointError
from frictionjoint.export.run import Target, export
from frictionjoint.motors.library import list_motors
from frictionjoint.simulate.carrier import install

MODELS = Path(__file__).resolve().parents[1] / "models"
WAYS = [
    ("native", Target.NATIVE, False),
    ("native, LuGre", Target.NATIVE, True),
    ("urdf", Target.URDF, False),
    ("newton", Target.NEWTON, False),
    ("isaac", Target.ISAAC, False),
]


def of_library(name: str, folder: Path) -> Path:
    """An MJCF with the motors whose names begin so.

    Raises:
        SystemExit: no motor is named so.
    """
    motors = [motor for motor in list_motors() if motor.name.startswith(name)]
    if not motors:
        raise SystemExit(f"{name}: no MJCF, and no motor of the library is named so")
    spec = mujoco.MjSpec.from_file(str(MODELS / motors[0].model))
    for motor in motors:
        # what saturates is a motor: one without a command, so that it gives no torque
        drive = spec.add_actuator(trntype=mujoco.mjtTrn.mjTRN_JOINT, target=motor.joint)
        drive.set_to_motor()
    effects = {motor.joint: motor.friction.effects for motor in motors}
    install(spec, {motor.joint: motor.friction.parameters for motor in motors}, effects)
    spec.compile()
    path = folder / f"{name}.xml"
    path.write_text(spec.to_xml())
    return path


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
                path = Path(model) if Path(model).exists() else of_library(model, Path(folder))
                try:
                    done = export(path, target, out, log=motion, lugre=lugre)
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
