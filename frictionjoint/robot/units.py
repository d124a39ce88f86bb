"""Several robots of one kind: the parameters of each unit, and their variation between units."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.report.robot_report import RobotReport
from frictionjoint.report.units_report import UnitsReport
from frictionjoint.robot.close_loop import Options, close_loop_robot
from frictionjoint.robot.logs import RobotLogs


def close_loop_units(
    units: Mapping[str, RobotLogs], model: str | Path | Mapping[str, str | Path], how: Options
) -> UnitsReport:
    """`close_loop_robot` for the logs of each unit; a unit without a result does not stop the
    others. LogError if none has a result."""
    found: dict[str, RobotReport] = {}
    failed: dict[str, str] = {}
    for name, logs in units.items():

        def say(text: str, unit: str = name) -> None:
            how.progress(f"{unit}: {text}")

        try:
            found[name] = close_loop_robot(logs, model, replace(how, progress=say))
        except FrictionJointError as error:
            failed[name] = str(error)
    if not found:
        raise LogError(next(iter(failed.values())))
    return UnitsReport(found, failed)
