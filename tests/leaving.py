"""Models of which only the effects and what they leave is known, for decisions that ask no more."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from frictionjoint.diagnose.score import Scored

BLOCKS = 40


def model(terms: Any, drive: float = 1.0) -> Any:
    """A fit with these effects.

    Args:
        drive: rms of the drive, over that of what a model leaves without any effect.
    """
    ones = np.ones(BLOCKS)
    return SimpleNamespace(
        effects=terms,
        shape=None,
        friction=ones,
        residual=ones,
        weight=ones,
        error_unit=1.0,
        target_rms=drive,
    )


def leaving(fit: Any, fraction: float) -> Scored:
    """Its score where it leaves that fraction of the squares in every block."""
    return Scored(fit, np.full(BLOCKS, fraction))
