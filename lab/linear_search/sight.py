"""The smallest effects that the logs would have shown, each by the part of it that no law holds."""

from dataclasses import replace

import numpy as np

from frictionjoint.diagnose.finding import Sight, sight
from frictionjoint.diagnose.moves import Look
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from linear_search.columns import Candidate, effects, is_cause
from linear_search.decisions import CLEAR_TORQUE, LEAST_TORQUE
from linear_search.sets import Set, Sets


def smallest(sets: Sets, chosen: Set, candidate: Candidate) -> float:
    """Least rms of a candidate's torque with which it would have been named, in the drive's unit.

    What the law holds of it, and what is where samples count little, shows nothing. What remains
    must be enough of friction, and as large a part of what is left as the search asks for.
    """
    own = sets.experiment
    column = sets.columns.of((*chosen.models, candidate))[-1]
    whole, out = np.linalg.norm(column.torque), np.linalg.norm(column.out)
    needed = sets.part(candidate, chosen.models)
    of_left = np.sqrt(needed / (1.0 - needed) * chosen.total)
    least = max(LEAST_TORQUE * own.friction, min(of_left, CLEAR_TORQUE * own.friction))
    return float(least * whole / max(out, 1e-300) / np.sqrt(len(own.target)))


def smallest_of_each(sets: Sets, chosen: Set) -> dict[str, float]:
    """The same for the shapes of each effect that is not named, the median."""
    return {
        name: float(np.median([smallest(sets, chosen, c) for c in some]))
        for name, some in sets.by_name.items()
        if name not in chosen.names and effects(some) and all(map(is_cause, some))
    }


def seen(sets: Sets, chosen: Set, prepared: Prepared, final: Fit, last: Look) -> Sight:
    """Torque above which half of the effects would have been named, of those that the logs show."""
    found = sight(prepared, final, last)
    each = [x / final.gain for x in smallest_of_each(sets, chosen).values()]
    return replace(found, torque=max(found.torque, float(np.median(each)) if each else 0.0))
