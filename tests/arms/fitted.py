"""Logs of an arm's joints, each with its first fit."""

from frictionjoint.measured.log import JointLog
from frictionjoint.robot.joint import FittedJoint, first_fit

from .arm import Arm
from .run import run


def fitted_joints(arm: Arm, seeds: tuple[int, ...], seconds: float) -> list[FittedJoint]:
    """Every joint of an arm in one log a seed, fitted with the believed model."""
    logs = [run(arm, seed, seconds) for seed in seeds]
    joints = []
    for j in arm.joints:
        own = [
            JointLog(
                name=f"log{k}",
                joint=j,
                time=x["time_s"],
                position=x[f"{j}.position_rad"],
                torque=x[f"{j}.torque_nm"],
                temperature=x.get("temperature_c"),
                other_positions={n: x[f"{n}.position_rad"] for n in arm.joints if n != j},
            )
            for k, x in enumerate(logs)
        ]
        joints.append(first_fit(own, arm.believed, j, None))
    return joints
