"""The part of `robot_rivals.py` that trainnr 0.1 runs in its own environment, with MuJoCo 3.5.

    PYTHON lab/trainnr_robot.py IN.npz OUT.npz

The torque balance of its fit for legged robots: armature, damping and frictionloss of each joint,
after its 10 Hz filter, with bounds wide enough for an arm. Nothing here imports frictionjoint.
"""

import sys
import time

import mujoco
import numpy as np
from trainnr.robot.torque_balance import (
    Bandwidth,
    BootstrapPlan,
    Coulomb,
    JointSamples,
    TermBounds,
    VelocityGate,
    fit_terms,
    rigid_torque,
)

BOUNDS = TermBounds(armature=(0.0, 50.0), damping=(0.0, 500.0), frictionloss=(0.0, 500.0))
GATE, KNEE, BAND = VelocityGate(still=0.02), Coulomb(knee=0.01), Bandwidth(cutoff_hz=10.0)
TERMS = ("armature", "damping", "frictionloss")


def main():
    """Read, fit, predict, write."""
    given = np.load(sys.argv[1])
    model, names = (
        mujoco.MjModel.from_xml_path(str(given["model"])),
        tuple(map(str, given["names"])),
    )
    motion = [given[key] for key in ("position", "velocity", "acceleration", "torque")]
    begin = time.process_time()
    fitted = fit_terms(
        model,
        JointSamples(given["time"], names, *motion),
        bounds=BOUNDS,
        plan=BootstrapPlan(replicates=20),
        gate=GATE,
        bandwidth=BAND,
        coulomb=KNEE,
    )
    out = {"seconds": time.process_time() - begin}
    terms = np.array([[joint.estimates[key] for key in TERMS] for joint in fitted.joints])
    for j in range(len(names)):
        q, v, a = given[f"held{j}"]
        rigid = rigid_torque(model, JointSamples(np.arange(len(q)), names, q, v, a, 0.0 * q))[:, j]
        own = np.column_stack([a[:, j], v[:, j], np.tanh(v[:, j] / KNEE.knee)])
        out[f"predicted{j}"] = rigid + own @ terms[j]
    np.savez(sys.argv[2], terms=terms, **out)


if __name__ == "__main__":
    main()
