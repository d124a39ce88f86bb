"""Other friction laws, for comparison with the requested one.

They never replace it. They show in which directions a law may be wrong, since none is exact, and
the error of each with the final effects.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array
from frictionjoint.decisions import APART, CLEARLY, SMALLEST_GAIN, TIE
from frictionjoint.identify.base_fit import CONSTRAINT, better_form
from frictionjoint.identify.basis import lengths, without
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of, prompt_maxwell_slip
from frictionjoint.identify.rounding import best_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, OF_NEGATIVE, Shape
from frictionjoint.identify.starts import refined_starts
from frictionjoint.identify.terms import Term
from frictionjoint.law.names import LAWS
from frictionjoint.threads import side_by_side

# Maxwell-slip must follow its sliding level promptly: its lag would hide an effect of that name
_RIVALS = (
    prompt_maxwell_slip(),
    forms_of("lugre"),
    forms_of("elastoplastic"),
    forms_of("dahl_stribeck"),
    forms_of("static"),
    CONSTRAINT,
)
# parameters that the laws share
_SHARED = ("Fc", "sigma2", "law.excess", "law.log Vs", "law.delta")
# the forms of every law by the names of its numbers
_FORMS = {forms_of(law)[0].variables: forms_of(law) for law in LAWS} | {
    forms[0].variables: forms for forms in (*_RIVALS, INTEGRATED)
}


def forms_like(shape: Shape) -> Sequence[Shape]:
    """The forms of a shape's law."""
    return _FORMS[shape.variables]


class OtherLaws:
    """The best known shape of each law, as a start when the model has changed.

    Attributes:
        followed: the model with whose effects all laws are fitted.
    Args:
        prepared: the logs. base: the requested law, fitted to them.
    """

    def __init__(
        self, prepared: Prepared, base: Fit, progress: Callable[[str], None] = lambda text: None
    ) -> None:
        own = base.shape.variables
        integrated = (INTEGRATED[0].variables, CONSTRAINT[0].variables)
        self._own = integrated if own in integrated else (own,)
        self.shapes: dict[tuple[str, ...], Shape] = {own: base.shape}
        every = [forms for forms in (*_RIVALS, INTEGRATED) if forms[0].variables != own]
        self._rivals = [f for f in every if f is not INTEGRATED or f[0].variables in self._own]
        self._fits: list[Fit] = []
        self.followed: Fit | None = None
        self._progress = progress
        self.fit_from_all_starts(prepared, base.effects)
        self._alone = dict(self.shapes)

    def fit_from_all_starts(self, prepared: Prepared, effects: tuple[Term, ...]) -> None:
        """Fit the other laws together with some effects, from all starts."""
        self._progress("fit: other laws")
        self.followed = None
        with side_by_side() as each:
            for shape in each(lambda f: refined_starts(prepared, effects, f)[0].law, self._rivals):
                self.shapes[shape.variables] = shape

    def starts(self, shape: Shape) -> tuple[Shape, ...]:
        """Starts for a law after effects are removed: the present shape, and an unbiased one."""
        return tuple(dict.fromkeys((shape, self._alone.get(shape.variables, shape))))

    def follow(self, prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
        """Fit all laws with the effects of a model.

        Returns:
            the model with another form of its law if that is clearly better, see `CONSTRAINT`.
        """
        self._fit_all(prepared, fitted)
        self.followed = fitted
        forms = [f for f in self._fits[1:] if f.shape.variables in self._own]
        return better_form(prepared, fitted, forms)

    def _fit_all(self, prepared: Prepared, fitted: Fit) -> None:
        own = fitted.shape.variables
        self.shapes[own] = fitted.shape
        others = self._refitted(prepared, fitted.effects, (own,))
        self.shapes |= {other.shape.variables: other.shape for other in others}
        self._fits = [fitted, *others]

    def errors(self, fitted: Fit) -> Array:
        """The main direction of possible errors of a fitted law, N m, shape (n, 1).

        It points from the law to the mixture of all fitted laws with the smallest residual. One
        free number for all laws, not one per law, which together would explain much that is not
        friction.
        """
        w = fitted.weight
        names = fitted.shape.variables
        others = [f.friction - fitted.friction for f in self._fits if f.shape.variables != names]
        known = fitted.free_jacobian * w[:, None]
        known /= lengths(known)
        towards = np.array(others).T
        free = without(np.column_stack([towards, fitted.residual]) * w[:, None], known)
        shares, _ = nnls(free[:, :-1], free[:, -1])
        return np.asarray(towards @ shares[:, None])

    def near(self, prepared: Prepared, fitted: Fit) -> list[Fit]:
        """Local minima of the law that fit nearly as well as a given fit, with its effects.

        They come from a coarse search, accurate enough for simulation.
        """
        self._progress("fit: other minima")
        own = [_FORMS[names] for names in self._own]
        places = [p for forms in own for p in refined_starts(prepared, fitted.effects, forms)]
        most = min(place.cost for place in places) / (1.0 - CLEARLY) ** 2
        return [p.search.result(p.x) for p in places if p.cost <= most]

    def suffice(self, prepared: Prepared, before: Fit, after: Fit) -> bool:
        """Whether a change only compensates for an error of the law: another law fits better.

        False if the change leaves less than half of what every law leaves without it, or if it
        clearly improves the other law too.

        Args:
            prepared: logs with the weights of the model before, which favour neither.
            before, after: the model without and with the change.
        """
        if before is not self._fits[0]:
            self._fit_all(prepared, before)
        others = [f for f in self._fits if f.shape.variables not in self._own]
        best = best_of(others, lambda f: f.drive_rms)
        changed = refit(prepared, after.terms, after.shape, ROUGH)
        now, its, most = (f.drive_rms**2 for f in (before, best, changed))
        if its > now or most < APART * its:
            return False
        needed = refit(prepared, after.effects, best.shape, ROUGH)
        least = SMALLEST_GAIN if most > its else TIE
        return needed.drive_rms**2 > (1.0 - least) * its

    def _refitted(
        self, prepared: Prepared, effects: tuple[Term, ...], but: Sequence[tuple[str, ...]]
    ) -> list[Fit]:
        """The laws fitted with some effects from their best known shapes.

        Args:
            but: names of the numbers of the laws to leave out.
        """
        shapes = [s for names, s in self.shapes.items() if names not in but]
        with side_by_side() as each:
            return list(each(lambda s: refit(prepared, effects, s, ROUGH), shapes))

    def compared(self, prepared: Prepared, fitted: Fit) -> "Comparison":
        """The effects of a model with each other law."""
        fits = self._refitted(prepared, fitted.effects, self._own)
        left = {law_parameters(f).law: f.rms_in_motion for f in fits}
        alike = [f for f in fits if APART * f.drive_rms < fitted.drive_rms]
        return Comparison(
            tuple(sorted(left.items(), key=lambda pair: pair[1])),
            tuple(_differences(prepared, fitted, other) for other in alike),
        )


@dataclass(frozen=True)
class Comparison:
    """A fit compared with those of other laws."""

    errors: tuple[tuple[str, float], ...]  # name and error in motion, N m, smallest first
    # by name, of the parameters that laws share, for each law that does not leave twice as much
    differences: tuple[dict[str, float], ...]

    def covariance(self, fitted: Fit) -> Array:
        """What the choice of a law adds to the covariance of a fit, shape (p, p).

        A level that the logs do not show differs between laws, however small the residual of each.
        """
        names = fitted.layout.names
        rows = [[d.get(n.removesuffix(OF_NEGATIVE), 0.0) for n in names] for d in self.differences]
        D = np.reshape(rows, (len(rows), len(names)))
        return np.asarray(D.T @ D / max(1, len(rows)))

    def over(self, gain: float) -> Self:
        """The comparison with errors in units of the drive."""
        return replace(self, errors=tuple((law, x / gain) for law, x in self.errors))


def _differences(prepared: Prepared, fitted: Fit, other: Fit) -> dict[str, float]:
    """Parameters of another law less those of a fit, by name; the stiffness is that of the fit.

    Each is reduced by the other one's own error: a law that does not determine a parameter says
    nothing of it.
    """
    own, others = _law_values(fitted), _law_values(other)
    variance = dict(
        zip(other.layout.names, np.diag(stated_covariance(prepared, other)), strict=True)
    )
    found = {}
    for name in _SHARED:
        if name in own and name in others:
            difference = others[name] - own[name]
            beyond = difference**2 - variance[name]
            found[name] = math.copysign(math.sqrt(beyond), difference) if beyond > 0.0 else 0.0
    if "law.excess" in found:
        # to first order, as a covariance is
        higher = found["Fc"] / own["Fc"] + found["law.excess"] / (1.0 + own["law.excess"])
        found |= dict.fromkeys(own.keys() & {"law.log length", "law.log end"}, higher)
    return found


def _law_values(fitted: Fit) -> dict[str, float]:
    """Linear coefficients and numbers of the law's shape by name."""
    values = np.concatenate([fitted.beta, fitted.shape.vector()]).tolist()
    return dict(zip(fitted.layout.names, values, strict=False))
