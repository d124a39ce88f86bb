"""The torque a motor gives, as a fit of its voltage or current sees it.

It is what the rest of the balance takes, so it follows from the coefficients that are solved for:
the column of `motor-saturation` and those coefficients are found in turn.
"""

from frictionjoint.arrays import Array
from frictionjoint.effects import back_emf, motor_saturation
from frictionjoint.identify.terms import Term

# what stands between a voltage or a current and the torque of the motor
ON_THE_MOTOR = frozenset((back_emf.EFFECT.name, motor_saturation.EFFECT.name))
# solutions after the first, which knows no torque: torque and coefficients change each other little
_MORE = 3


def solutions(terms: tuple[Term, ...]) -> int:
    """How often coefficients are solved for until the torque of the motor is theirs."""
    return 1 + _MORE * any(term.name == motor_saturation.EFFECT.name for term in terms)


def saturated(X: Array, beta: Array, names: tuple[str, ...], terms: tuple[Term, ...]) -> Array:
    """The columns with that of `motor-saturation`, if there is one, filled in.

    The torque is all of the balance but what acts on the motor. It is taken behind the filter: the
    motion is known no finer, and beside it the edges of friction would stand alone.

    Args:
        X: columns in the order of `names`, shape (n, k), the first that of the load.
        beta: coefficients in units of the drive, shape (k,).
    """
    at = _column_of(motor_saturation.EFFECT.name, names, terms)
    if at is None:
        return X
    taken = beta.copy()
    for name in ON_THE_MOTOR:
        k = _column_of(name, names, terms)
        if k is not None:
            taken[k] = 0.0
    filled = X.copy()
    filled[:, at] = (X @ taken / beta[0]) ** 3
    return filled


def _column_of(name: str, names: tuple[str, ...], terms: tuple[Term, ...]) -> int | None:
    first = len(names) - sum(len(t.coefficients) for t in terms)
    for term in terms:
        if term.name == name:
            return first
        first += len(term.coefficients)
    return None
