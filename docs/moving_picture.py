"""The moving picture of the README and the front page: our friction next to `frictionloss`.

    MUJOCO_GL=egl python docs/moving_picture.py docs/img/friction.webp

Left with our friction, right with MuJoCo's `frictionloss` of the same level. Above, an arm follows
a slow target through a soft drive; below, a robot without motors stands on its joints' friction.
"""

import sys
from pathlib import Path

import matplotlib
import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import frictionjoint as fj

SECONDS, FPS, STEP = 9.0, 12, 2e-3
WIDTH, HEIGHT, TITLE = 380, 200, 26
OURS, NATIVE, TARGET = (27, 158, 119), (217, 95, 2), (120, 124, 130)
# the reach: inertia kg m^2, drive N m/rad, target rad/s, friction N m
INERTIA, DRIVE, SPEED = 0.5, 12.0, 0.16
REACH = fj.FrictionParameters.symmetric(
    Fs=3.0, Fc=1.2, Vs=0.03, sigma2=1.0, n=2, knots=((5e-4, 3.0), (2e-3, 6.5))
)
LEG = fj.FrictionParameters.symmetric(
    Fs=12.0, Fc=10.0, Vs=0.05, sigma2=0.2, n=2, knots=((1e-3, 12.0), (4e-3, 26.0))
)
LOOK = """
  <visual><headlight diffuse="0.5 0.5 0.5" ambient="0.45 0.45 0.45"/><quality shadowsize="2048"/>
    <global offwidth="800" offheight="600"/></visual>
  <asset><texture name="sky" type="skybox" builtin="flat" rgb1="1 1 1" rgb2="1 1 1" width="8"
    height="8"/></asset>
"""

DARK = 'rgba="0.42 0.45 0.5 1"'
Frame = NDArray[np.uint8]


def arm() -> mujoco.MjSpec:
    """A link that a soft drive pulls to its target, seen from above."""
    return mujoco.MjSpec.from_string(
        f'<mujoco><compiler angle="radian"/><option timestep="{STEP}" integrator="implicitfast"/>'
        f'{LOOK}<worldbody><light pos="0.2 -0.6 2"/>'
        '<camera name="look" pos="0.1 0 1.75" fovy="40"/>'
        '<geom type="cylinder" size="0.07 0.02" rgba="0.35 0.37 0.42 1"/><body name="arm">'
        '<joint name="joint" axis="0 0 1"/>'
        '<geom type="capsule" fromto="0 0 0.06 0.6 0 0.06" size="0.035" rgba="0.3 0.5 0.75 1"/>'
        '<geom type="sphere" pos="0.6 0 0.06" size="0.055" rgba="0.3 0.5 0.75 1"/>'
        f'<inertial pos="0 0 0" mass="2" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body>'
        '<body name="target" mocap="true">'
        '<geom type="capsule" fromto="0.1 0 0 0.72 0 0" size="0.008" '
        'rgba="0.55 0.57 0.6 1" contype="0" conaffinity="0"/></body></worldbody>'
        f'<actuator><position joint="joint" kp="{DRIVE}"/></actuator></mujoco>'
    )


def robot() -> mujoco.MjSpec:
    """A body of 8 kg on four legs with a hip and a knee each; no motors."""
    legs = "".join(
        f'<body pos="{x} {y} 0"><joint name="hip{i}" axis="0 1 0" armature="0.01"/>'
        f'<geom type="capsule" fromto="0 0 0 -0.13 0 -0.15" size="0.022" {DARK}/>'
        f'<body pos="-0.13 0 -0.15"><joint name="knee{i}" axis="0 1 0" armature="0.01"/>'
        f'<geom type="capsule" fromto="0 0 0 0.1 0 -0.18" size="0.018" {DARK}/>'
        '<geom type="sphere" pos="0.1 0 -0.18" size="0.028" rgba="0.2 0.2 0.22 1" friction="1.2"/>'
        "</body></body>"
        for i, (x, y) in enumerate(((0.26, 0.13), (0.26, -0.13), (-0.2, 0.13), (-0.2, -0.13)))
    )
    return mujoco.MjSpec.from_string(
        f'<mujoco><compiler angle="radian"/><option timestep="{STEP}" integrator="implicitfast"/>'
        f'{LOOK}<default><geom density="400"/></default><worldbody>'
        '<light pos="0.5 -1.5 3" dir="-0.15 0.4 -1"/>'
        '<camera name="look" pos="0.03 -1.35 0.45" xyaxes="1 0 0 0 0.22 1" fovy="36"/>'
        '<geom type="plane" size="3 3 0.1" rgba="0.86 0.87 0.89 1"/>'
        '<body name="trunk" pos="0 0 0.358"><freejoint/>'
        '<geom type="box" size="0.3 0.11 0.06" mass="8" rgba="0.3 0.5 0.75 1"/>'
        f"{legs}</body></worldbody></mujoco>"
    )


def with_friction(spec: mujoco.MjSpec, law: fj.FrictionParameters, ours: bool) -> mujoco.MjModel:
    """The model with our friction, or with `frictionloss` at the breakaway torque."""
    joints = [j for j in spec.joints if j.type == mujoco.mjtJoint.mjJNT_HINGE]
    if ours:
        fj.install(spec, {j.name: law for j in joints})
    else:
        for j in joints:
            j.frictionloss = law.Fc_pos
            j.damping = np.array([law.sigma2_pos, 0.0, 0.0])
    return spec.compile()


def film(model: mujoco.MjModel, pulled: bool) -> tuple[list[Frame], list[float]]:
    """Frames, and the position of the first joint at each of them."""
    data = mujoco.MjData(model)
    frames, positions = [], []
    every = round(1.0 / FPS / STEP)
    with mujoco.Renderer(model, HEIGHT, WIDTH) as renderer:
        for k in range(round(SECONDS / STEP)):
            if pulled:
                angle = -0.5 + SPEED * max(0.0, data.time - 0.5)
                data.ctrl[0] = angle
                data.mocap_quat[0] = [np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)]
                if k == 0:
                    data.qpos[0] = angle
            mujoco.mj_step(model, data)
            if k % every == 0:
                renderer.update_scene(data, "look")
                frames.append(renderer.render().copy())
                positions.append(float(data.qpos[0 if pulled else 2]))
    return frames, positions


def graph(runs: dict[tuple[int, int, int], list[float]], upto: int, label: str) -> Image.Image:
    """Lines over time up to a frame, both simulations in one graph."""
    picture = Image.new("RGB", (2 * WIDTH, 90), "white")
    draw = ImageDraw.Draw(picture)
    values = [v for run in runs.values() for v in run]
    low, high = min(values), max(values)
    for colour, run in runs.items():
        points = [
            (70 + (2 * WIDTH - 90) * i / (len(run) - 1), 80 - 70 * (v - low) / (high - low))
            for i, v in enumerate(run[: upto + 1])
        ]
        if len(points) > 1:
            draw.line(points, fill=colour, width=3 if colour != TARGET else 1)
    draw.line([(66, 5), (66, 84), (2 * WIDTH - 16, 84)], fill=(150, 150, 150), width=1)
    draw.multiline_text((8, 28), label, fill=(70, 72, 78), font=FONT_SMALL)
    return picture


FONT_FILE = Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans.ttf"
FONT = ImageFont.truetype(str(FONT_FILE), 15)
FONT_SMALL = ImageFont.truetype(str(FONT_FILE), 12)


def main(path: Path) -> None:
    """Simulate, draw, write."""
    fj.enable()
    scenes = []
    for make, law, pulled in ((arm, REACH, True), (robot, LEG, False)):
        scenes.append([film(with_friction(make(), law, ours), pulled) for ours in (True, False)])
    (reach_ours, reach_native), (stand_ours, stand_native) = scenes
    count = len(reach_ours[0])
    times = np.arange(count) / FPS
    target = list(-0.5 + SPEED * np.maximum(0.0, times - 0.5))
    pictures = []
    for i in range(count):
        page = Image.new("RGB", (2 * WIDTH, TITLE + 2 * (HEIGHT + 90)), "white")
        draw = ImageDraw.Draw(page)
        draw.text((12, 4), "frictionjoint", fill=OURS, font=FONT)
        draw.text((WIDTH + 12, 4), "MuJoCo frictionloss", fill=NATIVE, font=FONT)
        for row, (ours, native) in enumerate(
            ((reach_ours, reach_native), (stand_ours, stand_native))
        ):
            y = TITLE + row * (HEIGHT + 90)
            page.paste(Image.fromarray(ours[0][i]), (0, y))
            page.paste(Image.fromarray(native[0][i]), (WIDTH, y))
        reach = {TARGET: target, NATIVE: reach_native[1], OURS: reach_ours[1]}
        page.paste(graph(reach, i, "joint\nangle"), (0, TITLE + HEIGHT))
        stand = {NATIVE: stand_native[1], OURS: stand_ours[1]}
        page.paste(graph(stand, i, "trunk\nheight"), (0, TITLE + 2 * HEIGHT + 90))
        pictures.append(page)
    # the end comes first: where the picture does not move, its first frame is all that is seen
    pictures[-1].save(
        path,
        save_all=True,
        append_images=[pictures[-1]] * FPS + pictures[:-1],
        duration=round(1000 / FPS),
        loop=0,
        quality=55,
        method=4,
    )
    print(f"{path}: {path.stat().st_size / 1e3:.0f} kB, {count} frames")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
