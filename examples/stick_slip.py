"""Stick-slip of the KUKA IR 361's first joint next to MuJoCo's native frictionloss.

    python examples/stick_slip.py                          numbers, and stick_slip.svg
    python examples/stick_slip.py --video stick_slip.gif   and a video (needs imageio, OpenGL)
    python examples/stick_slip.py --json                   numbers for a script

The joint is under a proportional position controller of 1000 N m/rad; its target moves at
0.1 rad/s, as in the paper of Ganseman et al. (1997).
"""

import argparse
import json
import os
import sys
from pathlib import Path

if sys.platform == "linux":
    os.environ.setdefault("MUJOCO_GL", "egl")  # read when mujoco is imported

import mujoco
from scope import Scope
from viewer import film, pull, save

import frictionjoint as fj
from frictionjoint.simulate.stick_slip import JOINT, StickSlip, draw, kuka_model, stick_slip


def main() -> int:
    """Run both, print, draw."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--duration", type=float, default=12.0, help="s")
    parser.add_argument("--out", type=Path, default=Path("stick_slip.svg"), help="drawing")
    parser.add_argument("--video", type=Path, help="GIF or MP4 of the joint with our friction")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    ours = stick_slip(kuka_model(), arguments.duration)
    native = stick_slip(kuka_model(), arguments.duration, native=True)
    if arguments.json:
        print(
            json.dumps({"frictionjoint": numbers(ours), "frictionloss": numbers(native)}, indent=2)
        )
    else:
        print("frictionjoint\n" + ours.summary())
        print("native frictionloss\n" + native.summary())
    arguments.out.write_text(draw(ours, native))
    if arguments.video:
        return video(arguments.duration, arguments.video)
    return 0


def numbers(run: StickSlip) -> dict[str, list[float]]:
    """Slip distances and stick times."""
    return {
        "slip_distances_rad": run.slip_distances.tolist(),
        "stick_times_s": run.stick_times.tolist(),
    }


def video(seconds: float, path: Path) -> int:
    """Render the run off screen, with its torque and hysteresis loop."""
    try:
        model = fj.load_model(kuka_model())
        data, scope = mujoco.MjData(model), Scope(model, JOINT)
        with fj.attach(model):
            save(path, list(film(model, data, scope, seconds, pull, "side", (960, 540))))
    except Exception as error:
        # OpenGL, drivers and imageio fail in many ways; the numbers above stand all the same
        print(f"no video: {' '.join(str(error).split())}; try MUJOCO_GL=osmesa", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
