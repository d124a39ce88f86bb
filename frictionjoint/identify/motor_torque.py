"""The torque a motor gives, as a fit of its voltage or current sees it.

It is what the rest of the balance takes, so it follows from the coefficients that are solved for:
the column of a saturation and those coefficients are found in turn.
"""

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import MOTOR
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.terms import EffectTerm, Term

# solutions after the first, which knows no torque: torque and coefficients change each other little
_MORE = 3


def follows_motor(term: Term) -> bool:
    """Whether its column is the cube of the motor's torque."""
    return isinstance(term, EffectTerm) and MOTOR in term.effect.needs


def solutions(terms: tuple[Term, ...]) -> int:
    """How often coefficients are solved for until the torque of the motor is theirs."""
    return 1 + _MORE * any(follows_motor(term) for term in terms)


def saturated(X: Array, beta: Array, layout: Layout) -> Array:
    """The columns with that of a saturation, if there is one, filled in.

    The torque is all of the balance but what acts on the motor. It is taken behind the filter: the
    motion is known no finer, and there the edges of friction would stand alone.

    Args:
        X: columns in the order of the layout, shape (n, k), the first that of the load.
        beta: coefficients in units of the drive, shape (k,).
    """
    at = [layout.coefficients(i).start for i, t in enumerate(layout.terms) if follows_motor(t)]
    if not at:
        return X
    taken = beta.copy()
    for i, term in enumerate(layout.terms):
        if isinstance(term, EffectTerm) and term.effect.on_motor:
            taken[layout.coefficients(i)] = 0.0
    filled = X.copy()
    filled[:, at[0]] = (X @ taken / beta[0]) ** 3
    return filled
