"""What an unrestricted least squares leaves of measured robots.

    python lab/robot_floor.py --data DIR [--only ur10]

All ten parameters of every link, every rotor, an offset, Coulomb and viscous friction and the root
of the speed, and shafts that turn with the sum and the difference of neighbouring joints, free of
any bound, on the samples and in the band of `frictionjoint close-loop`, in per cent of the rms of
each joint's torque over the fitted part of the logs. Fitted to the first 70% of each log and tested
on the rest: each joint with parameters of its own, then one set of bodies for all joints. Fitted to
the rest itself: no such model can leave less there.
"""

import argparse
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from real_robots import HELD_OUT, ROBOTS, ROOT

from frictionjoint.effects.signals import V
from frictionjoint.identify.design import kept
from frictionjoint.identify.fit import IN_MOTION
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import direction
from frictionjoint.identify.weights import errors_elsewhere, weighted
from frictionjoint.robot.along import Along
from frictionjoint.robot.corrections import Corrections, Shaft
from frictionjoint.robot.joint import first_fit
from frictionjoint.robot.logs import read_robot

# of the largest singular value, below which a direction of the parameters is not determined
_RCOND = 1e-6


@dataclass(frozen=True)
class Rows:
    """One joint's logs: columns common to all joints, its own, and what they are to explain."""

    common: np.ndarray
    own: np.ndarray
    torque: np.ndarray
    weight: np.ndarray

    @property
    def moving(self):
        return self.weight**2 > IN_MOTION


def rows(prepared, body, names):
    """Of one joint."""
    common, own, torque = [], [], []
    for segment in prepared.segments:
        along = Along(body, segment, Corrections.none(body.model))
        v = segment.signals[:, V]
        shafts = [shaft(along, *pair, c) for pair in itertools.pairwise(names) for c in (1.0, -1.0)]
        bodies = [along.bodies(b) for b in range(1, body.model.nbody)]
        common.append(np.column_stack([*bodies, *shafts]))
        root = direction(v) * np.sqrt(np.abs(v))
        friction = [along.acceleration, np.ones_like(v), direction(v), v, root]
        own.append(kept(segment, np.column_stack(friction)))
        torque.append(segment.balanced_drive()[segment.kept])
    weight = np.concatenate([s.kept_weight for s in prepared.segments])
    return Rows(np.concatenate(common), np.concatenate(own), np.concatenate(torque), weight)


def shaft(along, one, other, ratio):
    """Columns of a shaft that turns with two joints, concave friction up to its top speed."""
    v = along.motion(one)[1] + ratio * along.motion(other)[1]
    return along.kept_shaft(Shaft((one, other), ratio, float(np.abs(v).max())))


def solved(X, y):
    size = np.linalg.norm(X, axis=0)
    size[size < 1e-12 * size.max()] = np.inf
    return np.linalg.lstsq(X / size, y, rcond=_RCOND)[0] / size


def error(row, X, beta, size):
    """rms in motion, per cent of a torque."""
    e = (row.torque - X @ beta)[row.moving]
    return 100.0 * np.sqrt(np.mean(e**2)) / size


def alone(fit, held, size):
    X, Y = (np.column_stack([r.common, r.own]) for r in (fit, held))
    return error(held, Y, solved(X * fit.weight[:, None], fit.torque * fit.weight), size)


def together(fits, held, sizes):
    """One set of common parameters; each joint in units of what is left of it alone."""
    blocks, targets = [], []
    own = [r.own.shape[1] for r in fits.values()]
    starts = np.cumsum([0, *own])
    for i, r in enumerate(fits.values()):
        X = np.column_stack([r.common, r.own]) * r.weight[:, None]
        left = r.torque * r.weight - X @ solved(X, r.torque * r.weight)
        unit = r.weight / np.sqrt(np.mean(left**2))
        wide = np.zeros((len(X), r.common.shape[1] + starts[-1]))
        wide[:, : r.common.shape[1]] = r.common
        wide[:, r.common.shape[1] + starts[i] : r.common.shape[1] + starts[i + 1]] = r.own
        blocks.append(wide * unit[:, None])
        targets.append(r.torque * unit)
    beta = solved(np.concatenate(blocks), np.concatenate(targets))
    n = next(iter(fits.values())).common.shape[1]
    return {
        name: error(
            held[name],
            np.column_stack([held[name].common, held[name].own]),
            np.concatenate([beta[:n], beta[n + starts[i] : n + starts[i + 1]]]),
            sizes[name],
        )
        for i, name in enumerate(fits)
    }


def table(robot, data):
    model = ROOT / "models" / robot.model
    logs = read_robot([data / x for x in robot.logs], model, float(HELD_OUT))
    first = {}
    for name in logs.joints:
        try:
            first[name] = first_fit(logs.fit[name], model, name, None)
        except Exception as problem:
            print(f"{name}: {problem}")
    fits, held, sizes = {}, {}, {}
    for name, joint in first.items():
        body = joint.alongs[0].body
        kept_back = prepare(list(logs.held_out[name]), body, joint.prepared.band)
        cov = stated_covariance(joint.prepared, joint.fit)
        left = errors_elsewhere(joint.prepared, joint.fit, cov)
        kept_back = weighted(kept_back, joint.fit, left)
        fits[name] = rows(joint.prepared, body, list(first))
        held[name] = rows(kept_back, body, list(first))
        sizes[name] = joint.fit.target_rms
    columns = [
        {n: alone(fits[n], held[n], sizes[n]) for n in fits},
        together(fits, held, sizes),
        together(held, held, sizes),
    ]
    lines = ["| joint | each for itself | one set of bodies | fitted to the rest itself |"]
    lines.append("|---|---|---|---|")
    lines += [f"| {n} | " + " | ".join(f"{c[n]:.1f}%" for c in columns) + " |" for n in first]
    means = [np.mean(list(c.values())) for c in columns]
    return "\n".join([*lines, "| mean | " + " | ".join(f"{m:.2f}%" for m in means) + " |"])


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=ROBOTS)
    asked = parser.parse_args()
    for name in asked.only or ROBOTS:
        print(f"{name}\n\n{table(ROBOTS[name], asked.data)}\n", flush=True)


if __name__ == "__main__":
    main()
