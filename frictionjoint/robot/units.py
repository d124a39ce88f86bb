"""Several robots of one kind: the parameters of each unit, and their variation between units."""

from collections.abc import Callable, Mapping
from pathlib import Path

from frictionjoint.control.controller_file import GivenController
from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.identify.held import Pose
from frictionjoint.report.robot_report import RobotReport
from frictionjoint.report.units_report import UnitsReport
from frictionjoint.robot.close_loop import close_loop_robot
from frictionjoint.robot.logs import RobotLogs


def close_loop_units(
    units: Mapping[str, RobotLogs],
    model: str | Path,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    law: str | None = None,
    fixed: Mapping[str, Pose] | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    controller: GivenController | None = None,
    refine: bool | None = None,
) -> UnitsReport:
    """`close_loop_robot` for each unit; a unit without a result does not stop the others.

    Args:
        units: logs by the unit's name. Others: see `close_loop_robot`.
    Raises:
        LogError: no unit has a result.
    """
    found: dict[str, RobotReport] = {}
    failed: dict[str, str] = {}
    for name, logs in units.items():

        def say(text: str, unit: str = name) -> None:
            progress(f"{unit}: {text}")

        try:
            found[name] = close_loop_robot(
                logs, model, seed, say, law, fixed, jobs, scheduler, controller, refine
            )
        except FrictionJointError as error:
            failed[name] = str(error)
    if not found:
        raise LogError(next(iter(failed.values())))
    return UnitsReport(found, failed)
