"""Models of which only the effects and what they leave is known, for decisions that ask no more."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from frictionjoint.diagnose.score import Scored

BLOCKS = 40


def model(terms: Any) -> Any:
    """A fit with these effects."""
    ones = np.ones(BLOCKS)
    return SimpleNamespace(effects=terms, shape=None, friction=ones, weight=ones, error_unit=1.0)


def leaving(fit: Any, fraction: float) -> Scored:
    """Its score where it leaves that fraction of the squares in every block."""
    return Scored(fit, np.full(BLOCKS, fraction))
