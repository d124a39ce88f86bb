"""Logs of an arm's joints, each with its first fit."""

from frictionjoint.measured.log import JointLog
from frictionjoint.robot.joint import FittedJoint, first_fit

from .arm import Arm
from .run import run


def joint_logs(arm: Arm, seeds: tuple[int, ...], seconds: float) -> dict[str, list[JointLog]]:
    """One log a seed of every joint of an arm, by its name."""
    logs = [run(arm, seed, seconds) for seed in seeds]
    return {
        j: [
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
        for j in arm.joints
    }


def fitted_joints(arm: Arm, seeds: tuple[int, ...], seconds: float) -> list[FittedJoint]:
    """Every joint of an arm in one log a seed, fitted with the believed model."""
    logs = joint_logs(arm, seeds, seconds)
    return [first_fit(own, arm.believed, j, None) for j, own in logs.items()]
