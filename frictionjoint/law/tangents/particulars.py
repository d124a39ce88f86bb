"""Facts about the kernels that differentiation requires and their source does not state."""

from typing import Any

from frictionjoint.law import dahl, elastoplastic, integrated, relaxation, stribeck
from frictionjoint.law.tangents import rules

# kernels with hand-written tangents, and the function that replaces each
RULES: dict[Any, Any] = {
    stribeck.stribeck_level: rules.stribeck_level,
    relaxation.advance: rules.advance,
    relaxation.distance: rules.distance,
    relaxation.rate: rules.rate,
    dahl.remaining: rules.remaining,
}
# an array element whose index contains all names of one of these is a count, a flag or a choice
_NAMES = """DIRECTION N_MIN N_MAX VIRGIN FORGOTTEN BOUND LAMPAERT MASING SLIDING N_ELEMENTS"""
COUNTS = (*(frozenset({name}) for name in _NAMES.split()), frozenset({"HEADER", "n"}))
# by module: the exponent is a fixed choice in the integrated law and a fitted number in Dahl's law
COUNTS_OF = {integrated: (frozenset({"EXPONENT"}),)}
# Statements that change no value. At the fixed point r = 1 the torque stays constant, but its
# tangent still changes.
LEFT_OUT = frozenset({"if r == 1.0:\n    break"})
# by kernel, expressions, each with one that is equal except for rounding and is differentiated
ROUNDED: dict[Any, dict[str, str]] = {
    integrated._slide: {"max(0.0, reach)": "reach"},
    elastoplastic._transition: {
        "1.0": "1.0 - math.exp(-(u + a))",
        "-math.expm1(-u)": "1.0 - math.exp(-u)",
    },
}
# Equality tests that hide no derivative: either the equality holds by assignment, or the joint is
# at rest, where the derivative with respect to the motion jumps.
HARMLESS = frozenset({"d == a", "dq != 0.0", "dq == 0.0", "v == 0.0"})
