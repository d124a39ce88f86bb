"""The same warming as `temperature-dependent`, with no thermometer in the log.

Every log starts cold at 25 C.
"""

from .temperature_dependent import draw
from .temperature_dependent import warming as build

__all__ = ["NAME", "build", "draw"]
NAME = "warm-up-drift"
