"""The part of `robot_rivals.py` that figaroh 1.0.2 runs in its own environment (Python 3.12).

    PYTHON lab/figaroh_robot.py IN.npz OUT.npz

Its regressor with friction, actuator inertia and joint offsets; its base parameters by QR; least
squares, then again with each joint's rows over what is left of them (Gautier 1997), as its own
`weigthed_least_squares` weights them. Nothing here imports frictionjoint.
"""

import sys
import time
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
from figaroh.tools.qrdecomposition import QRDecomposer
from figaroh.tools.regressor import build_regressor_basic, get_index_eliminate

OPTIONS = {"has_friction": True, "has_actuator_inertia": True, "has_joint_offset": True}
# s, of the forward simulation
STEP = 1e-3
# rad/s: no longer a motion of the arm
FASTEST = 1e2


def regressor(robot, q, v, a):
    """Of all joints in turn."""
    options = OPTIONS | {"act_idxv": range(robot.model.nv)}
    return build_regressor_basic(robot, q, v, a, options)


def rows(robot, motion, joint):
    """Regressor of one joint along a motion, shape (n, parameters)."""
    n = motion.shape[1]
    return regressor(robot, *motion)[joint * n : (joint + 1) * n]


def fitted(blocks, torques):
    """Kept columns, base columns among them, and the base parameters."""
    W, tau = np.concatenate(blocks), np.concatenate(torques)
    gone, names = get_index_eliminate(W, dict.fromkeys(map(str, range(W.shape[1]))))
    kept = np.setdiff1d(np.arange(W.shape[1]), gone)
    decomposer = QRDecomposer()
    _, _, _, phi = decomposer.double_decomposition(tau, W[:, kept], names)
    base = kept[decomposer.base_indices]
    unit = np.concatenate(
        [
            np.full(len(t), np.std(t - b[:, base] @ phi))
            for b, t in zip(blocks, torques, strict=True)
        ]
    )
    phi = np.linalg.lstsq(W[:, base] / unit[:, None], tau / unit, rcond=None)[0]
    return base, phi


def run(robot, base, phi, q, v, torques, dt):
    """Free run under logged torques, explicit in friction; positions at the log's samples.

    Nothing keeps the inertia of free base parameters positive: a run that leaves is infinite.
    """
    found = [q.copy()]
    substeps = max(1, round(dt / STEP))
    n = len(q)
    units = np.vstack([np.zeros(n), np.eye(n)])
    for k in range(len(torques) - 1):
        if not np.abs(v).max() < FASTEST:
            return np.full((len(torques), n), np.inf)
        for i in range(substeps):
            part = i / substeps
            torque = (1.0 - part) * torques[k] + part * torques[k + 1]
            Q, V = np.tile(q, (n + 1, 1)), np.tile(v, (n + 1, 1))
            T = (regressor(robot, Q, V, units)[:, base] @ phi).reshape(n, -1)
            a = np.linalg.solve(T[:, 1:] - T[:, :1], torque - T[:, 0])
            v = v + a * dt / substeps
            q = q + v * dt / substeps
        found.append(q.copy())
    return np.array(found)


def main() -> None:
    """Read, fit, predict, run, write."""
    given = np.load(sys.argv[1])
    model = pin.buildModelFromMJCF(str(given["model"]))
    robot = SimpleNamespace(model=model, data=model.createData())
    n = model.nv
    begin = time.perf_counter()
    blocks = [rows(robot, given[f"fit{j}"], j) for j in range(n)]
    base, phi = fitted(blocks, [given[f"torque{j}"] for j in range(n)])
    out = {"seconds": time.perf_counter() - begin, "parameters": len(phi)}
    for j in range(n):
        out[f"predicted{j}"] = rows(robot, given[f"held{j}"], j)[:, base] @ phi
    for w in range(int(given["windows"])):
        q, v = given[f"q{w}"], given[f"v{w}"]
        out[f"run{w}"] = run(robot, base, phi, q[0], v[0], given[f"drive{w}"], float(given["dt"]))
    np.savez(sys.argv[2], **out)


if __name__ == "__main__":
    main()
