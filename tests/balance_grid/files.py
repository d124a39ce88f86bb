"""A case as a folder: its logs, an MJCF of the inertia alone, and what went into it."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .case import Case

MODEL = """<mujoco model="inertia">
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="link">
      <joint name="joint1" type="hinge" axis="0 1 0"/>
      <inertial mass="1" pos="0 0 0" diaginertia="{J:.12g} {J:.12g} {J:.12g}"/>
    </body>
  </worldbody>
  <actuator><motor joint="joint1"/></actuator>
</mujoco>
"""


def write(case: Case, folder: Path) -> None:
    """log0.csv, log1.csv, ..., model.xml and case.json."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, log in enumerate(case.logs):
        table = np.column_stack(list(log.values()))
        header = ",".join(log)
        np.savetxt(folder / f"log{number}.csv", table, "%.12g", ",", header=header, comments="")
    (folder / "model.xml").write_text(MODEL.format(J=case.J))
    told = {
        "name": case.name,
        "inertia": case.J,
        "friction": asdict(case.friction) if case.friction else None,
        "noise_rms": case.noise,
        "counts": case.counts,
        "rate": case.rate,
        "held": case.held,
    }
    (folder / "case.json").write_text(json.dumps(told, indent=1) + "\n")
