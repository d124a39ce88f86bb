"""Several robots of one kind: the parameters of each unit, and their variation between units."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from frictionjoint.arrays import root_mean_square
from frictionjoint.control.controller_file import GivenController
from frictionjoint.errors import FrictionJointError, LogError
from frictionjoint.identify.held import Pose
from frictionjoint.identify.result import Estimate
from frictionjoint.robot.close_loop import close_loop_robot
from frictionjoint.robot.logs import RobotLogs
from frictionjoint.robot.report_data import RobotReport

SCHEMA = "frictionjoint/units-1"


@dataclass(frozen=True)
class Spread:
    """A parameter that several units have.

    Attributes:
        owner: the joint, or the shared cause with its place. name: of the parameter. unit: SI.
        of_unit: estimates by the unit's name.
    """

    owner: str
    name: str
    unit: str
    of_unit: dict[str, Estimate]

    @property
    def mean(self) -> float:
        """Mean over units."""
        return float(np.mean([x.value for x in self.of_unit.values()]))

    @property
    def deviation(self) -> float:
        """Standard deviation over units; 0 for one unit."""
        values = [x.value for x in self.of_unit.values()]
        return float(np.std(values, ddof=1)) if len(values) > 1 else 0.0

    @property
    def error(self) -> float | None:
        """Expected deviation if all units were equal: rms of the standard errors; None if one is
        unknown."""
        errors = [x.stderr for x in self.of_unit.values()]
        known = [e for e in errors if e is not None]
        return root_mean_square(np.array(known)) if len(known) == len(errors) else None

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "of": self.owner,
            "parameter": self.name,
            "unit": self.unit,
            "mean": self.mean,
            "deviation": self.deviation,
            "standard_error": self.error,
            "units": {name: x.to_dict() for name, x in self.of_unit.items()},
        }


@dataclass(frozen=True)
class UnitsReport:
    """Result of `close_loop_units`.

    Attributes:
        units: a report by the unit's name. failed: one line per unit without a result.
    """

    units: dict[str, RobotReport]
    failed: dict[str, str]

    @property
    def spreads(self) -> tuple[Spread, ...]:
        """Parameters of the final friction laws, joint by joint, then of the shared causes.

        Parameters of a single unit are left out.
        """
        rows: dict[tuple[str, str, str], dict[str, Estimate]] = {}
        for unit, report in self.units.items():
            for joint, result in report.joints.items():
                for name, x in result.report.final.items():
                    rows.setdefault((joint, name, x.unit), {})[unit] = x
            for cause in report.shared:
                owner = " of ".join(filter(None, (cause.cause, " and ".join(cause.place.values()))))
                for name, x in cause.parameters.items():
                    rows.setdefault((owner, name, x.unit), {})[unit] = x
        return tuple(Spread(*key, found) for key, found in rows.items() if len(found) > 1)

    def to_dict(self) -> dict[str, Any]:
        """The content of report.json."""
        return {
            "schema": SCHEMA,
            "units": {name: report.to_dict() for name, report in self.units.items()},
            "failed": self.failed,
            "spread": [row.to_dict() for row in self.spreads],
        }


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
