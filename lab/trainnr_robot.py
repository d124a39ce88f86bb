"""trainnr 0.1 on one log of a robot: the torque balance of its legged fit, next to ours.

    PYTHON lab/trainnr_robot.py LOG.npz MODEL.xml

PYTHON is one that has trainnr and mujoco. LOG.npz holds names, time, position, velocity,
acceleration and torque, shape (n, joints) each, and the number of rows to fit. Bounds are wide
enough for an arm. Prints the error on the other rows in motion, in per cent of the torque, as a
mean over the joints.
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
    lowpass,
    rigid_torque,
)

BOUNDS = TermBounds(armature=(0.0, 50.0), damping=(0.0, 500.0), frictionloss=(0.0, 500.0))
GATE, KNEE, BAND = VelocityGate(still=0.02), Coulomb(knee=0.01), Bandwidth(cutoff_hz=10.0)


def main():
    """Fit and print."""
    log, model = np.load(sys.argv[1]), mujoco.MjModel.from_xml_path(sys.argv[2])
    names, n = tuple(map(str, log["names"])), int(log["fit"])

    def samples(rows):
        fields = ("position", "velocity", "acceleration", "torque")
        return JointSamples(log["time"][rows], names, *(log[x][rows] for x in fields))

    begin = time.process_time()
    plan = BootstrapPlan(replicates=20)
    fitted = fit_terms(
        model, samples(slice(n)), bounds=BOUNDS, plan=plan, gate=GATE, bandwidth=BAND, coulomb=KNEE
    )
    seconds = time.process_time() - begin
    held = samples(slice(n, None))
    rigid, errors = rigid_torque(model, held), []
    for j, joint in enumerate(fitted.joints):
        v = held.velocity[:, j]
        torque = rigid[:, j] + joint.estimates["armature"] * held.acceleration[:, j]
        torque += joint.estimates["damping"] * v
        torque += joint.estimates["frictionloss"] * np.tanh(v / KNEE.knee)
        left, size = (
            lowpass(x, held.rate_hz, BAND) for x in (held.torque[:, j] - torque, held.torque[:, j])
        )
        moving = np.abs(v) > GATE.still
        errors.append(100.0 * np.sqrt(np.mean(left[moving] ** 2) / np.mean(size[moving] ** 2)))
    print(f"{np.mean(errors):.1f}% {seconds:.1f} s", " ".join(f"{x:.1f}" for x in errors))


if __name__ == "__main__":
    main()
