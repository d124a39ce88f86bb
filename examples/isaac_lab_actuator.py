"""An Isaac Lab actuator whose joints have our friction, for environments in PyTorch.

    python examples/isaac_lab_actuator.py

`FrictionActuator` follows the interface of Isaac Lab's `ActuatorBase`: `compute` takes the wanted
joint positions, velocities and efforts with the measured state, and returns efforts; `reset` takes
indices of environments. Where Isaac Lab is not installed a stand-in of that base class is used, and
where PyTorch is not, NumPy arrays: the run below is then the same.
"""

from types import SimpleNamespace

import numpy as np

import frictionjoint as fj

try:
    import torch as xp
except ImportError:
    xp = np
try:
    from isaaclab.actuators import ActuatorBase
except ImportError:

    class ActuatorBase:
        """What `FrictionActuator` needs of Isaac Lab's class."""

        def __init__(self, cfg, num_envs, num_joints, stiffness, damping, effort_limit):
            self.cfg, self._num_envs, self.num_joints = cfg, num_envs, num_joints
            self.stiffness, self.damping, self.effort_limit = stiffness, damping, effort_limit

        def _clip_effort(self, effort):
            return effort.clip(-self.effort_limit, self.effort_limit)


class FrictionActuator(ActuatorBase):
    """A PD actuator with joint friction that holds at rest.

    ``cfg`` has, besides Isaac Lab's own fields, ``friction``: parameters of all joints or a list
    with those of each, ``dt``: physics step, s, and ``inertia``: of the joints, kg m^2, for the
    step's end. ``cfg.device`` is None for the CPU, else "cuda:0".
    """

    def __init__(self, cfg, *args, **kwargs):
        super().__init__(cfg, *args, **kwargs)
        shape = (self._num_envs, self.num_joints)
        self._friction = fj.FrictionBatch(cfg.friction, shape, device=cfg.device)

    def reset(self, env_ids):
        chosen = np.zeros(self._num_envs, dtype=bool)
        chosen[env_ids] = True
        self._friction.reset(chosen)

    def compute(self, control_action, joint_pos, joint_vel):
        effort = self.stiffness * (control_action.joint_positions - joint_pos)
        effort = effort + self.damping * (control_action.joint_velocities - joint_vel)
        effort = self._clip_effort(effort + control_action.joint_efforts)
        h, J = self.cfg.dt, self.cfg.inertia
        torque, stiffness, damping = self._friction.step(joint_pos, joint_vel, h)
        # friction at the end of the step, where it holds: with its own stiffness and damping
        gain = h * stiffness + damping
        end = (J * joint_vel + h * (effort - torque + damping * joint_vel)) / (J + h * gain)
        friction = torque + h * stiffness * end + damping * (end - joint_vel)
        control_action.joint_efforts = effort - friction
        control_action.joint_positions = control_action.joint_velocities = None
        return control_action


def main() -> None:
    envs, joints, h, J = 64, 3, 5e-3, 0.05
    friction = fj.FrictionParameters.symmetric(
        Fs=1.0, Fc=0.8, Vs=0.1, sigma2=0.05, knots=((1e-3, 1.0), (4e-3, 2.0))
    )
    cfg = SimpleNamespace(friction=friction, dt=h, inertia=J, device=None)
    gains = (xp.full((envs, joints), k) for k in (20.0, 1.0))
    actuator = FrictionActuator(cfg, envs, joints, *gains, effort_limit=50.0)
    q, v, zero = (xp.zeros((envs, joints)) for _ in range(3))
    actuator.reset(np.arange(envs))
    positions = []
    for k in range(int(4.0 / h)):
        # a target that calls for less than breakaway at first, then for more
        wanted = xp.full((envs, joints), 0.03 if k * h < 2.0 else 0.3)
        action = SimpleNamespace(joint_positions=wanted, joint_velocities=zero, joint_efforts=zero)
        v = v + h / J * actuator.compute(action, q, v).joint_efforts
        q = q + h * v
        positions.append(float(q[0, 0]))
    print(f"arrays of {type(q).__module__.partition('.')[0]} (torch if it is installed)")
    print(f"target 0.03 rad, below breakaway: the joint stays at {positions[399]:.4f} rad")
    print(f"target 0.30 rad: the joint goes to {positions[-1]:.4f} rad")


if __name__ == "__main__":
    main()
