"""A Gymnasium environment with and without joint friction: the KUKA joint tracks a slow target.

    python examples/gym_joint.py [--seconds 20]

Prints the tracking error of the policy "command the target" without friction, with MuJoCo's
frictionloss and damping, and with the friction the model carries; then the same from four
environments in a vector.
"""

import argparse

import gymnasium
import mujoco
import numpy as np
from gymnasium.envs.mujoco import MujocoEnv

from frictionjoint.simulate.gymnasium import Friction
from frictionjoint.simulate.stick_slip import kuka_model, native_model

CONTROL_STEP = 0.01


class JointTracking(MujocoEnv):
    """Action: commanded position, rad. Reward: minus the squared distance from the target, rad^2.

    The target is a sine of 0.3 rad at 0.1 Hz; observed are position, velocity and the target.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / CONTROL_STEP)}  # noqa: RUF012

    def __init__(self, model=None, render_mode=None):
        self._given = model
        space = gymnasium.spaces.Box(-np.inf, np.inf, (3,), np.float64)
        super().__init__(str(kuka_model()), 10, space, render_mode, camera_name="side", width=640)

    def _initialize_simulation(self):
        if self._given is None:
            return super()._initialize_simulation()
        return self._given, mujoco.MjData(self._given)

    def _set_action_space(self):
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float64)
        return self.action_space

    def _target(self):
        return 0.3 * np.sin(2 * np.pi * 0.1 * self.data.time)

    def _observe(self):
        return np.array([self.data.qpos[0], self.data.qvel[0], self._target()])

    def step(self, action):
        self.do_simulation(action, self.frame_skip)
        reward = -float((self.data.qpos[0] - self._target()) ** 2)
        return self._observe(), reward, False, False, {}

    def reset_model(self):
        self.set_state(self.init_qpos, self.init_qvel)
        return self._observe()


def rms_error(environment, seconds):
    """Tracking error, rad; one value an environment."""
    observation, _ = environment.reset(seed=0)
    rewards = []
    for _ in range(round(seconds / CONTROL_STEP)):
        observation, reward, *_ = environment.step(observation[..., 2:])
        rewards.append(reward)
    environment.close()
    return np.sqrt(-np.mean(rewards, axis=0))


def main():
    """Four runs, four lines."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    seconds = parser.parse_args().seconds
    native = native_model(kuka_model())
    print(f"no friction     {1e3 * rms_error(JointTracking(), seconds):6.1f} mrad")
    print(f"frictionloss    {1e3 * rms_error(JointTracking(native), seconds):6.1f} mrad")
    print(f"frictionjoint   {1e3 * rms_error(Friction(JointTracking()), seconds):6.1f} mrad")
    four = gymnasium.vector.SyncVectorEnv([lambda: Friction(JointTracking())] * 4)
    print("four at once   ", 1e3 * rms_error(four, seconds).round(4), "mrad")


if __name__ == "__main__":
    main()
