"""Add a motor to the library, from what `identify` or `close-loop` wrote.

    python scripts/make_motor.py NAME --friction PARAMS.toml|MODEL.xml --fit FIT.json
        --title TITLE --joint JOINT --model MJCF --source ADDRESS --licence LICENCE
        --command COMMAND [--remark REMARK]

--friction is a parameter file, or an MJCF whose joint carries friction (a report's model.xml).
--fit is what `identify --json` printed, or a report's report.json.
"""

import argparse
import json
from pathlib import Path

import mujoco

from frictionjoint.files import read_parameters
from frictionjoint.motors.library import TEXTS, Motor, motor_text
from frictionjoint.simulate.carrier import JointFriction, load_model, read_friction

LIBRARY = Path(__file__).resolve().parents[1] / "frictionjoint/motors"


def friction_of(path: Path, joint: str) -> JointFriction:
    """Of a parameter file, or of the joint of an MJCF."""
    if path.suffix == ".toml":
        return read_parameters(path)
    return read_friction(load_model(path))[joint]


def fit_of(content: dict) -> dict[str, float]:
    """What a fit left, rms."""
    if "after" not in content:
        return {"torque_rms": content["torque_rms"]}
    before, after = (content[key]["torque_rms"] for key in ("before", "after"))
    return {
        "torque_rms": after["fit"],
        "torque_rms_before": before["fit"],
        "held_out_rms": after["held_out"],
        "held_out_rms_before": before["held_out"],
    }


def main() -> None:
    """Write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name")
    parser.add_argument("--friction", type=Path, required=True)
    parser.add_argument("--fit", type=Path, required=True)
    for text in TEXTS:
        parser.add_argument(f"--{text}", default="", required=text != "remark")
    asked = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(asked.model)
    slide = model.joint(asked.joint).type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    texts = {text: getattr(asked, text) for text in TEXTS}
    motor = Motor(
        name=asked.name,
        unit="N" if slide else "N m",
        fit=fit_of(json.loads(asked.fit.read_text())),
        friction=friction_of(asked.friction, asked.joint),
        **{**texts, "model": Path(asked.model).name},
    )
    out = LIBRARY / f"{asked.name}.toml"
    out.write_text(motor_text(motor))
    print(f"Wrote {out}")


if __name__ == "__main__":
    main()
