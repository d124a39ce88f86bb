"""A plant as a folder: four logs, the believed model, the answer.

answer.json, torques in N m, those of {"fit", "held_out"} over the logs of that role:

kinds           what is hidden, empty if nothing is
accept          for each kind the catalogue's names that are right; "none" where adding nothing is
                right too; empty for what the catalogue does not hold
variable        for what the catalogue does not hold, quantities that are the right report
effects         for each kind the rms of its torque over the fitted logs, that over the noise and
                over the friction, and what a friction law with parameters of its own for each
                direction must leave of it, over the noise
noise_rms       white and coloured noise of the torque
true_rms        the same with the drive's ripple and the torque's resolution: torque logged less
                torque asked, which the true model leaves where the motion is known exactly
hold_rms        what sampling a torque that changes between samples adds to that
presliding_rms  and the error of the position, through the joint's stiffness while it sticks
position_rms    error of the logged positions, rad: counts, and instants that the log has wrong
parameters      the joint's fields, and of the logs: delay (s), growth from log to log, eccentricity
"""

import json
from pathlib import Path

import numpy as np

from .joint import Joint
from .plant import Plant

GRAVITY = 9.81


def write(plant: Plant, folder: Path) -> None:
    """answer.json comes last, so a folder that has one is whole."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, log in plant.logs.items():
        table = np.column_stack(list(log.values()))
        header = ",".join(log)
        np.savetxt(folder / f"{name}.csv", table, "%.9g", ",", header=header, comments="")
    (folder / "model.xml").write_text(believed_model(plant.joint))
    (folder / "answer.json").write_text(json.dumps(plant.answer, indent=1) + "\n")


def believed_model(joint: Joint) -> str:
    """An MJCF with the joint's inertia and gravity, and none of what it hides."""
    inertia, gravity = joint.inertia, joint.gravity
    mass, distance = inertia / 0.25, gravity * 0.25 / (GRAVITY * inertia)
    if mass * distance**2 >= inertia:  # the body must lie closer: half the inertia is its own
        mass = 2 * gravity**2 / (GRAVITY**2 * inertia)
        distance = gravity / (GRAVITY * mass)
    own = inertia - mass * distance**2
    x, z = -distance * np.sin(joint.tilt), -distance * np.cos(joint.tilt)
    return (
        '<mujoco model="plant">\n'
        '  <option timestep="0.001"/>\n'
        '  <worldbody>\n    <body name="link">\n'
        '      <joint name="joint1" type="hinge" axis="0 1 0"/>\n'
        f'      <inertial mass="{mass:.9g}" pos="{x:.9g} 0 {z:.9g}"'
        f' diaginertia="{own:.9g} {own:.9g} {own:.9g}"/>\n'
        "    </body>\n  </worldbody>\n"
        '  <actuator><motor joint="joint1"/></actuator>\n'
        "</mujoco>\n"
    )
