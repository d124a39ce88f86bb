"""A thousand joints at once, each with a friction of its own: MuJoCo's Batch.

    python examples/thousand_joints.py [--joints 1024] [--seconds 4]

Every simulation is the KUKA joint pulled at 0.1 rad/s through 1000 N m/rad; breakaway torques are
drawn from 36 to 68 N m. Counts who stuck, by breakaway torque.
"""

import argparse

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.set_parameters import write_parameters
from frictionjoint.simulate.stick_slip import JOINT, SPEED, kuka_model

try:
    from mujoco.batch import Batch
except ImportError:
    raise SystemExit(
        f"MuJoCo {mujoco.__version__} has no Batch: pip install 'mujoco>=3.17'"
    ) from None


def main():
    """Draw, step, count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--joints", type=int, default=1024)
    parser.add_argument("--seconds", type=float, default=4.0)
    arguments = parser.parse_args()
    model = fj.load_model(kuka_model())
    base = read_friction(model)[JOINT].parameters
    Fs = np.random.default_rng(0).uniform(36.0, 68.0, arguments.joints)
    with fj.attach(model):
        batch = Batch(model, arguments.joints)
        numbers = batch.expand("numeric_data")
        knots = tuple((z, F * 1.25) for z, F in base.knots)
        for row, level in zip(numbers, Fs, strict=True):
            drawn = {"Fs_pos": level, "Fs_neg": level, "knots": knots}
            law = base.from_dict(base.to_dict() | drawn)
            write_parameters(row, blocks(model)[JOINT], law, JOINT)
        target, velocity = batch.bind("ctrl"), batch.bind("qvel")
        stuck = np.zeros(arguments.joints)
        steps = round(arguments.seconds / model.opt.timestep / 10)
        for k in range(steps):
            target[:, 0] = SPEED * k * 10 * model.opt.timestep
            batch.step(nstep=10)
            stuck += np.abs(velocity[:, 0]) < 0.01 * SPEED
    for low in range(36, 68, 8):
        those = (Fs >= low) & (Fs < low + 8)
        share = stuck[those].mean() / steps
        print(f"Fs {low} to {low + 8} N m: {those.sum():4} joints at rest {share:4.0%} of the time")


if __name__ == "__main__":
    main()
