"""A plant as a folder: four logs, the believed model, the answer."""

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
