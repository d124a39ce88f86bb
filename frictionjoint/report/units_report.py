"""Results of several robots of one kind as plain data: the content of report.json."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from frictionjoint.arrays import root_mean_square
from frictionjoint.identify.result import Estimate
from frictionjoint.parameter_meanings import MEANINGS, by_direction, meaning
from frictionjoint.report.content import content_of
from frictionjoint.report.robot_report import RobotReport

SCHEMA = "frictionjoint/units-1"


@dataclass(frozen=True)
class Spread:
    """A parameter of a joint, or of a shared cause with its place (`owner`), that several units
    have: estimates by the unit's name, in the same SI unit."""

    owner: str
    name: str
    unit: str
    of_unit: dict[str, Estimate]

    @property
    def mean(self) -> float:
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
        return {
            "of": self.owner,
            "parameter": self.name,
            "unit": self.unit,
            "mean": self.mean,
            "deviation": self.deviation,
            "standard_error": self.error,
            "units": content_of(self.of_unit),
        }


@dataclass(frozen=True)
class UnitsReport:
    """Result of `close_loop_units`: a report by the unit's name, and one line per unit without a
    result."""

    units: dict[str, RobotReport]
    failed: dict[str, str]

    @property
    def spreads(self) -> tuple[Spread, ...]:
        """Parameters of the final friction laws, joint by joint, then of the shared causes.

        Parameters of a single unit are left out.
        """
        rows: dict[tuple[str, str, str], dict[str, Estimate]] = {}
        for unit, report in self.units.items():
            for joint, own in report.joints.items():
                for name, x in own.final.items():
                    rows.setdefault((joint, name, x.unit), {})[unit] = x
            for cause in report.shared:
                owner = " of ".join(filter(None, (cause.cause, " and ".join(cause.place.values()))))
                for name, x in cause.parameters.items():
                    rows.setdefault((owner, name, x.unit), {})[unit] = x
        return tuple(Spread(*key, found) for key, found in rows.items() if len(found) > 1)

    @property
    def rows(self) -> tuple[tuple[str, Spread], ...]:
        """Each spread with its parameter in words; one for both directions if they are equal."""
        owners: dict[tuple[str, str], dict[str, Spread]] = {}
        for x in self.spreads:
            owners.setdefault((x.owner, x.unit), {})[x.name] = x
        found = []
        for (_, unit), own in owners.items():
            for symbol, name in by_direction(own, lambda a, b: a.of_unit == b.of_unit):
                known = symbol.partition("_")[0] in MEANINGS
                words = meaning(symbol) if known else symbol
                found.append((words if unit == "1" else f"{words}, {unit}", own[name]))
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "units": content_of(self.units),
            "failed": self.failed,
            "spread": content_of(self.spreads),
        }
