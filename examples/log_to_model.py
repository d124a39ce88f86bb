"""From a log to a model: fit the shipped log, write an MJCF that carries the friction, replay it.

    python examples/log_to_model.py [--out joint_with_friction.xml]

The command line does the same: `frictionjoint identify`, then `frictionjoint install`.
"""

import argparse
from importlib.resources import files
from pathlib import Path

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.measured.readers import read_log

DEMO = Path(str(files("frictionjoint.demo")))


def replay(model, log, seconds=0.5):
    """Position error, rad: `seconds` of the measured torque from the measured start of a move."""
    start = np.argmax(np.abs(np.gradient(log.position, log.time)) > 0.5)
    data = mujoco.MjData(model)
    data.qpos[0] = log.position[start]
    data.qvel[0] = np.gradient(log.position, log.time)[start]
    end = log.time[start] + seconds
    while log.time[start] + data.time < end:
        data.qfrc_applied[0] = np.interp(log.time[start] + data.time, log.time, log.torque)
        mujoco.mj_step(model, data)
    return float(data.qpos[0] - np.interp(end, log.time, log.position))


def main():
    """Fit, install, write, load, replay."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("joint_with_friction.xml"))
    out = parser.parse_args().out
    logs = [read_log(DEMO / name, "joint") for name in ("pick_and_place.csv", "ramps.csv")]
    parameters = law_parameters(fit(prepare(logs, RigidBody(DEMO / "joint.xml", "joint"))))
    print(f"Fs {parameters.Fs_pos:.3f} N m, Fc {parameters.Fc_pos:.3f} N m")
    spec = mujoco.MjSpec.from_file(str(DEMO / "joint.xml"))
    fj.install(spec, {"joint": parameters})
    spec.compile()
    out.write_text(spec.to_xml())

    log = read_log(DEMO / "multisine.csv", "joint")  # not used for the fit
    model = fj.load_model(out)
    print(f"error after 0.5 s without friction {1e3 * replay(model, log):8.2f} mrad")
    with fj.attach(model):
        print(f"error after 0.5 s with friction    {1e3 * replay(model, log):8.2f} mrad")


if __name__ == "__main__":
    main()
