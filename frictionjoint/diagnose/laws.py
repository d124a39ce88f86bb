"""Which friction law the logs support: the integrated one, or a rival that fits clearly better."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import nnls

from frictionjoint.arrays import Array
from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.score import left_elsewhere, scored
from frictionjoint.identify.basis import without
from frictionjoint.identify.clearly import CLEARLY
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.design import lengths
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.rival_shape import forms_of, prompt_maxwell_slip, start_of
from frictionjoint.identify.rounding import best_of, in_order
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED, Shape
from frictionjoint.identify.starts import ripened
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import reweighed
from frictionjoint.law.names import LAWS
from frictionjoint.rivals import StaticParameters
from frictionjoint.threads import side_by_side

# laws that take the integrated one's place where the residual of one is clearly smaller.
# Maxwell-slip must follow its sliding level promptly: its lag would hide an effect of that name.
_CONSTRAINT: tuple[Shape, ...] = (ConstraintShape(start_of(StaticParameters)),)
_RIVALS = (
    prompt_maxwell_slip(),
    forms_of("lugre"),
    forms_of("elastoplastic"),
    forms_of("dahl_stribeck"),
    forms_of("static"),
    _CONSTRAINT,
)
# the forms of every law by the names of its numbers
_FORMS = {forms_of(law)[0].variables: forms_of(law) for law in LAWS} | {
    forms[0].variables: forms for forms in (*_RIVALS, INTEGRATED)
}


def forms_like(shape: Shape) -> Sequence[Shape]:
    """The forms of a shape's law."""
    return _FORMS[shape.variables]


class Laws:
    """The best shape known of each law, to start from when the model has changed.

    What the laws differ by tells in which directions one of them may be wrong, since none is exact.

    Args:
        prepared: the logs. base: the law that is fitted first.
        asked: only that law is wanted: the others tell where it may be wrong.
    """

    def __init__(
        self,
        prepared: Prepared,
        base: Fit,
        asked: bool,
        progress: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.own = base.shape.variables
        self.shapes: dict[tuple[str, ...], Shape] = {self.own: base.shape}
        self._asked = asked
        self._rivals = [forms for forms in _RIVALS if forms[0].variables != self.own]
        self._friction: dict[tuple[str, ...], Array] = {}
        self._progress = progress
        self.ripen(prepared, base.effects)
        self._alone = dict(self.shapes)

    def ripen(self, prepared: Prepared, effects: tuple[Term, ...]) -> None:
        """Fit the rivals' shapes together with some effects, from all starts."""
        self._progress("fitting other friction laws")

        def ripest(forms: tuple[Shape, ...]) -> Shape:
            place = ripened(prepared, effects, forms)[0]
            return place.search.split(place.x)[0]

        with side_by_side() as each:
            for shape in each(ripest, self._rivals):
                self.shapes[shape.variables] = shape

    @property
    def forms(self) -> list[Sequence[Shape]]:
        """Of each law that may be chosen."""
        return [_FORMS[self.own], *([] if self._asked else self._rivals)]

    def starts(self, shape: Shape) -> tuple[Shape, ...]:
        """Where to start with a law when effects go: as it is, and as no effect had bent it."""
        return tuple(dict.fromkeys((shape, self._alone[shape.variables])))

    def better(self, prepared: Prepared, fitted: Fit) -> tuple[Prepared, Fit]:
        """A fit of the same effects with another law where that is clearly better.

        By more than the spread over blocks of time, too: a few of them are not all motion. And it
        must leave less of motion that it was not fitted to.
        """
        self.shapes[fitted.shape.variables] = fitted.shape

        def refitted(shape: Shape) -> Fit:
            return refit(prepared, fitted.effects, shape, ROUGH)

        own = fitted.shape.variables
        with side_by_side() as each:
            others = list(each(refitted, [s for s in self.shapes.values() if s.variables != own]))
        self.shapes |= {other.shape.variables: other.shape for other in others}
        self._friction = {f.shape.variables: f.friction for f in (fitted, *others)}
        most = (1.0 - CLEARLY) * fitted.drive_rms
        clear = in_order([f for f in others if f.drive_rms < most], lambda f: f.drive_rms)
        if self._asked or not clear:
            return prepared, fitted
        blocks = make_blocks(prepared, fitted)
        now = scored(fitted, blocks)
        sure = [f for f in clear if scored(f, blocks).better(now)]
        # a law with more freedom may follow what it is fitted to and nothing else
        most = left_elsewhere(prepared, fitted, blocks) if sure else 0.0
        best = next((f for f in sure if left_elsewhere(prepared, f, blocks) < most), None)
        return (prepared, fitted) if best is None else reweighed(prepared, best)

    def first(
        self, prepared: Prepared, fitted: Fit, too_short: bool = False
    ) -> tuple[Prepared, Fit]:
        """The law fitted first, where another was taken that is no longer clearly better.

        It was when effects were missing that have been found since. Of logs that are too short to
        tell of an effect none is clearly better: a swing that never turns has any level of any law.
        """
        if fitted.shape.variables == self.own:
            return prepared, fitted
        fits = [
            refit(prepared, fitted.effects, s, ROUGH) for s in self.starts(self.shapes[self.own])
        ]
        own = best_of(fits, lambda f: f.drive_rms)
        if fitted.drive_rms < (1.0 - CLEARLY) * own.drive_rms and not too_short:
            return prepared, fitted
        return reweighed(prepared, own)

    def errors(self, fitted: Fit) -> Array:
        """The direction in which the law of a fit is wrong first of all, N m, shape (n, 1).

        Towards the laws, as last fitted, between which the true one lies: the shares of them that
        leave least. It is one number that is free and not one a law, which together would explain
        much that is no friction.
        """
        w = fitted.weight
        names = fitted.shape.variables
        others = [x - fitted.friction for law, x in self._friction.items() if law != names]
        known = fitted.free_jacobian * w[:, None]
        known /= lengths(known)
        towards = np.array(others).T
        free = without(np.column_stack([towards, fitted.residual]) * w[:, None], known)
        shares, _ = nnls(free[:, :-1], free[:, -1])
        return np.asarray(towards @ shares[:, None])

    def near(self, prepared: Prepared, fitted: Fit) -> list[Fit]:
        """Every law and valley of one that leaves hardly more than a fit, with its effects.

        As a coarse look has them, which is near enough to be simulated.
        """
        self._progress("fitting friction laws that explain as much")
        places = [p for f in self.forms for p in ripened(prepared, fitted.effects, f)]
        most = min(place.cost for place in places) / (1.0 - CLEARLY) ** 2
        return [p.search.result(p.x) for p in places if p.cost <= most]

    def unchosen(self, prepared: Prepared, final: Fit, base: Fit) -> Fit | None:
        """The final effects with the law of the base fit, where the final one is another."""
        if final.shape.variables == base.shape.variables:
            return None
        return refit(prepared, final.effects, self.shapes[self.own], ROUGH)
