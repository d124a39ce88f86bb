"""A refinement as the report states it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from frictionjoint.identify.fit import without_scale
from frictionjoint.identify.result import Estimate, law_estimates, term_estimates
from frictionjoint.refine.refine import Refined
from frictionjoint.replay.loops import LoopErrors, Loops


@dataclass(frozen=True)
class RefinedModel:
    """A refinement in a report."""

    taken: bool  # whether it is the result: left-out logs are predicted better than by the fit
    guard: tuple[float, float]  # mean absolute errors on left-out logs, before and after, rad (m)
    loops: LoopErrors | None  # whole logs in closed loop; None if the drive was measured
    parameters: dict[str, Estimate]  # by name, with standard errors

    @classmethod
    def of(cls, outcome: Refined, loops: Loops | None, slide: bool, scaled: bool) -> "RefinedModel":
        """From a refinement, used or not.

        Args:
            scaled: whether the gain of the drive is determined; otherwise all is in units of the
                drive.
        """
        numbers = outcome.found
        whole = numbers.vector.fit(numbers.values)
        cov = numbers.vector.own_covariance(whole, numbers.cov)
        fitted = whole if scaled else without_scale(whole)
        found = law_estimates(fitted, cov, slide)
        for i, term in enumerate(fitted.effects):
            found |= {
                f"{term.name} {name}": x
                for name, x in term_estimates(fitted, cov, i, slide).items()
            }
        errors = loops.errors([whole])[0] if loops else None
        guard = float(np.mean(outcome.before)), float(np.mean(numbers.left_out))
        return cls(outcome.taken, guard, errors, found)

    def to_dict(self) -> dict[str, Any]:
        """As in report.json."""
        return {
            "taken": self.taken,
            "left_out_mae": {"before": self.guard[0], "after": self.guard[1]},
            **(self.loops.figures() if self.loops else {}),
            "parameters": self.parameters,
        }
