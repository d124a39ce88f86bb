"""A dm_control task with and without joint friction: the KUKA joint tracks a slow target.

    python examples/dm_control_joint.py [--seconds 8]

The joint is under its position controller of 1000 N m/rad; the target swings by 0.3 rad. Prints
the tracking error of the same task with no friction, with MuJoCo's frictionloss and damping, and
with the friction the model carries.
"""

import argparse
import os

os.environ.setdefault("MUJOCO_GL", "disable")  # before dm_control is imported: no window needed

import mujoco
import numpy as np
from dm_control import mujoco as dm_mujoco
from dm_control.rl import control

from frictionjoint.simulate.dm_control import attach
from frictionjoint.simulate.stick_slip import kuka_model, native_model


class Track(control.Task):
    """Reward: minus the squared distance from a sine of 0.3 rad at 0.1 Hz."""

    def target(self, physics):
        """Position wanted now, rad."""
        return 0.3 * np.sin(2 * np.pi * 0.1 * physics.time())

    def initialize_episode(self, physics):
        pass

    def before_step(self, action, physics):
        physics.set_control(action)

    def after_step(self, physics):
        pass

    def action_spec(self, physics):
        return dm_mujoco.action_spec(physics)

    def get_observation(self, physics):
        return {"position": physics.position(), "target": np.array([self.target(physics)])}

    def get_reward(self, physics):
        return -float((physics.position()[0] - self.target(physics)) ** 2)


def rms_error(environment, seconds):
    """Tracking error in rad of the policy "command the target"."""
    step = environment.reset()
    rewards = []
    for _ in range(round(seconds / environment.control_timestep())):
        step = environment.step(step.observation["target"])
        rewards.append(step.reward)
    return float(np.sqrt(-np.mean(rewards)))


def environment(model):
    """The task on a compiled model, a control step of 10 ms."""
    physics = dm_mujoco.Physics.from_model(dm_mujoco.wrapper.MjModel(model))
    return control.Environment(physics, Track(), control_timestep=0.01)


def main():
    """Three runs, three lines."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    seconds = parser.parse_args().seconds
    ours = environment(mujoco.MjModel.from_xml_path(str(kuka_model())))
    native = environment(native_model(kuka_model()))
    print(f"no friction     {1e3 * rms_error(ours, seconds):6.1f} mrad")
    print(f"frictionloss    {1e3 * rms_error(native, seconds):6.1f} mrad")
    with attach(ours):
        print(f"frictionjoint   {1e3 * rms_error(ours, seconds):6.1f} mrad")


if __name__ == "__main__":
    main()
