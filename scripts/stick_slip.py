"""Stick-slip of the KUKA IR 361's first joint beside MuJoCo's native frictionloss.

    python scripts/stick_slip.py                          numbers, and stick_slip.svg
    python scripts/stick_slip.py --video stick_slip.gif   and a video (needs imageio and OpenGL)
    python scripts/stick_slip.py --json                   numbers for a script

The joint is under a proportional position controller of 1000 N m/rad; its target moves at
0.1 rad/s, as in the paper of Ganseman et al. (1997).
"""

import argparse
import json
import os
import sys
from pathlib import Path

import numpy as np

from frictionjoint.simulate.stick_slip import StickSlip, draw, kuka_model, stick_slip

FRAMES_PER_SECOND = 25


def main() -> int:
    """Run both, print, draw."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--duration", type=float, default=12.0, help="s")
    parser.add_argument("--out", type=Path, default=Path("stick_slip.svg"), help="drawing")
    parser.add_argument("--video", type=Path, help="GIF of the joint with our friction")
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
        return video(ours, arguments.video)
    return 0


def numbers(run: StickSlip) -> dict[str, list[float]]:
    """Slip distances and stick times."""
    return {
        "slip_distances_rad": run.slip_distances.tolist(),
        "stick_times_s": run.stick_times.tolist(),
    }


def video(run: StickSlip, path: Path) -> int:
    """Render the run off screen."""
    os.environ.setdefault("MUJOCO_GL", "egl")
    try:
        import imageio.v3 as imageio
        import mujoco

        model = mujoco.MjModel.from_xml_path(str(kuka_model()))
        data = mujoco.MjData(model)
        every = round(1.0 / FRAMES_PER_SECOND / model.opt.timestep)
        frames = []
        with mujoco.Renderer(model, 360, 480) as renderer:
            for q in run.position[::every]:
                data.qpos[0] = q
                mujoco.mj_forward(model, data)
                renderer.update_scene(data, camera="side")
                frames.append(renderer.render())
    except Exception as error:
        # OpenGL, drivers and imageio fail in many ways; the numbers above stand all the same
        print(f"no video: {' '.join(str(error).split())}; try MUJOCO_GL=osmesa", file=sys.stderr)
        return 2
    imageio.imwrite(path, np.stack(frames), duration=1000 / FRAMES_PER_SECOND, loop=0)
    return 0


if __name__ == "__main__":
    sys.exit(main())
