"""Watch a joint's friction live: torque, hysteresis loop, stick or slip, in MuJoCo's viewer.

    python examples/viewer.py                                   the KUKA joint, pulled at 0.1 rad/s
    python examples/viewer.py --model arm.xml --joint elbow     yours; move it with the sliders
    python examples/viewer.py --seconds 8 --frame frame.png     off screen: the last frame
    python examples/viewer.py --seconds 8 --video friction.mp4  off screen: the whole run

Off screen needs OpenGL without a window: MUJOCO_GL=egl or osmesa. On macOS run with mjpython.
"""

import argparse
import os
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

if sys.platform == "linux":
    os.environ.setdefault("MUJOCO_GL", "egl")  # read when mujoco is imported; windows ignore it

import mujoco
import mujoco.viewer
import numpy as np
from scope import Scope

import frictionjoint as fj
from frictionjoint.simulate.stick_slip import kuka_model

FRAMES_PER_SECOND = 25


def pull(model, data):
    """The KUKA joint's target moves at 0.1 rad/s, as in the paper of 1997."""
    data.ctrl[0] = 0.1 * data.time


def advance(model, data, scope, drive):
    """Step for the length of a frame; returns the last sample."""
    end = data.time + 1 / FRAMES_PER_SECOND
    while data.time < end:
        drive(model, data)
        mujoco.mj_step(model, data)
        sample = scope.record(data)
    return sample


def watch(handle, model, data, scope, seconds, drive, sleep=time.sleep):
    """Run in real time in a viewer until it closes or the time is over."""
    start = time.monotonic() - data.time
    while handle.is_running() and data.time < seconds:
        with handle.lock():
            sample = advance(model, data, scope, drive)
            handle.user_scn.ngeom = 0
            scope.mark(handle.user_scn, model, data, sample)
        handle.set_figures(scope.figures(handle.viewport))
        place = mujoco.mjtGridPos.mjGRID_TOPRIGHT
        handle.set_texts((mujoco.mjtFontScale.mjFONTSCALE_150, place, *scope.text(sample)))
        handle.sync()
        sleep(max(0.0, data.time - (time.monotonic() - start)))


@contextmanager
def window(model, data, **options):
    """MuJoCo's passive viewer; leaving waits until the window is gone.

    `close` only asks for it. A program that ends while the viewer's thread still draws crashes in
    the graphics library.
    """
    before = set(threading.enumerate())
    with mujoco.viewer.launch_passive(model, data, **options) as handle:
        drawing = set(threading.enumerate()) - before
        yield handle
    for thread in drawing:
        thread.join(timeout=10)


def film(model, data, scope, seconds, drive, camera=-1, size=(1280, 720)):
    """Yield frames, uint8 of shape (height, width, 3), drawn without a window."""
    width, height = size
    model.vis.global_.offwidth, model.vis.global_.offheight = width, height
    context = mujoco.GLContext(width, height)
    context.make_current()
    gl = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, gl)
    scene, option, view = mujoco.MjvScene(model, 2000), mujoco.MjvOption(), mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, view)
    if camera != -1:
        view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(camera).id
    viewport = mujoco.MjrRect(0, 0, width, height)
    try:
        while data.time < seconds:
            sample = advance(model, data, scope, drive)
            everything = mujoco.mjtCatBit.mjCAT_ALL
            mujoco.mjv_updateScene(model, data, option, None, view, everything, scene)
            scope.mark(scene, model, data, sample)
            mujoco.mjr_render(viewport, scene, gl)
            for place, figure in scope.figures(viewport):
                mujoco.mjr_figure(place, figure, gl)
            corner, font = mujoco.mjtGridPos.mjGRID_TOPRIGHT, mujoco.mjtFont.mjFONT_NORMAL
            mujoco.mjr_overlay(font, corner, viewport, *scope.text(sample), gl)
            pixels = np.empty((height, width, 3), np.uint8)
            mujoco.mjr_readPixels(pixels, None, viewport, gl)
            yield np.flipud(pixels)
    finally:
        gl.free()
        context.free()


def save(path, frames):
    """Write an image of one frame, or a video of several."""
    import imageio.v3 as imageio  # only films need it

    frames = np.stack(frames)
    if len(frames) == 1:
        imageio.imwrite(path, frames[0])
    elif path.suffix == ".gif":
        imageio.imwrite(path, frames, duration=1000 / FRAMES_PER_SECOND, loop=0)
    else:
        imageio.imwrite(path, frames, fps=FRAMES_PER_SECOND)


def main():
    """A window, or a film."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--model", type=Path, help="MJCF that carries friction")
    parser.add_argument("--joint", default="joint1")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    film_of = parser.add_mutually_exclusive_group()
    film_of.add_argument("--frame", type=Path, help="PNG of the last frame")
    film_of.add_argument("--video", type=Path, help="MP4 or GIF of the run")
    asked = parser.parse_args()
    model = fj.load_model(asked.model or kuka_model())
    data = mujoco.MjData(model)
    scope = Scope(model, asked.joint)
    drive = (lambda model, data: None) if asked.model else pull
    with fj.attach(model):
        if not (asked.frame or asked.video):
            sides = {"show_left_ui": False, "show_right_ui": bool(asked.model)}
            with window(model, data, **sides) as handle:
                if not asked.model:
                    handle.cam.type = mujoco.mjtCamera.mjCAMERA_FIXED
                    handle.cam.fixedcamid = model.camera("side").id
                watch(handle, model, data, scope, asked.seconds, drive)
            return 0
        if asked.seconds == float("inf"):
            print("say how long: --seconds 8", file=sys.stderr)
            return 2
        while not asked.video and data.time < asked.seconds - 1 / FRAMES_PER_SECOND:
            advance(model, data, scope, drive)  # only the last frame is asked for
        camera = -1 if asked.model else "side"
        frames = list(film(model, data, scope, asked.seconds, drive, camera))
        save(asked.video or asked.frame, frames if asked.video else frames[-1:])
    return 0


if __name__ == "__main__":
    sys.exit(main())
