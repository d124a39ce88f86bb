"""The torque balance of a model: columns and target of each log, and their derivatives.

    torque  = load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms       (torque known)
    current = (load + Fc H(q; shape) + sigma1 dz/dt + sigma2 v + sum of terms) / g
    voltage = (load + Fc H(q; shape) + sigma1 dz/dt + sum of terms) / g            (gains unknown)

All columns and the target pass the same filter (`Segment.lowpass`).
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

import numpy as np
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import MOTOR, RATE, H
from frictionjoint.identify.basis import lengths
from frictionjoint.identify.bundle import Bundle, Spectra
from frictionjoint.identify.layout import Layout, layout_of, term_bounds
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.terms import (
    DampingAge,
    DriveTerm,
    TargetTiming,
    Term,
    Timing,
    VelocityAge,
    age_of,
    changing_drive,
    delay_of,
    drive_changes,
    in_place,
)
from frictionjoint.threads import side_by_side, threads_here

# step of such a number over that: the kernels of effects carry no tangents of their own, and a gap
# or a stop has none at an impact
_STEP = 0.015


class Balance:
    """The torque balance of some logs, for models with one law and one list of terms."""

    def __init__(self, prepared: Prepared, law: Shape, terms: tuple[Term, ...]) -> None:
        self.prepared = prepared
        self.layout: Layout = layout_of(prepared, law, terms)
        self.span = prepared.span
        self._parts = prepared.bundles(threads_here())
        self._latest: dict[Bundle, tuple[object, Spectra]] = {}

    def columns(
        self, law: Shape, terms: tuple[Term, ...], beta: Array | None = None
    ) -> tuple[Array, Array]:
        """Columns, shape (n, k), and target, shape (n,), on the kept samples of all logs. Without
        the coefficients, those that depend on the motor torque are zero, see `with_motor`."""
        whole = np.concatenate(self._each(partial(self._some_columns, law, terms)))
        y = np.concatenate(self._each(partial(self._target, terms)))
        if beta is not None:
            whole = with_motor(whole, beta, self.layout, self.prepared.segments)
        return whole, y

    def moves(
        self, law: Shape, terms: tuple[Term, ...], beta: Array, through_terms: bool = True
    ) -> Array:
        """Derivative of columns times `beta` minus target by every nonlinear number, shape (n, m),
        of terms that follow the law only if `through_terms`, which a search omits."""
        make = partial(self._some_moves, law, terms, beta, through_terms)
        return np.concatenate(self._each(make))

    def differentiate(self, law: Shape) -> None:
        """Evaluate a law and its derivatives in one pass for `columns` and `moves`, not in two."""
        self._each(partial(self._unit_moves, law))

    def _each(self, make: Callable[[Bundle], Array]) -> list[Array]:
        """Result of a function for each part of the logs, in parallel."""
        with side_by_side() as each:
            return list(each(make, self._parts))

    def _some_columns(self, law: Shape, terms: tuple[Term, ...], part: Bundle) -> Array:
        """Columns for a part of the logs."""
        known, names = part.load_and_velocity, self.layout.base
        age = age_of(terms, DampingAge)
        if age:
            known = known - np.outer(part.rate, [0.0, age])
        parts = [known[:, k : k + 1] for k, x in enumerate(("load", "sigma2")) if x in names]
        stored = part.store.get
        parts.append(
            stored(("law", names, law), lambda: self._columns_of(self._track(law, part), part))
        )
        for term in terms:
            if term.coefficients:
                key = "term", term, law if term.follows_law else None
                parts.append(stored(key, partial(self._term, term, law, part)))
        return np.column_stack(parts)

    def of_law(self, law: Shape, terms: tuple[Term, ...], beta: Array, held: Array) -> Array:
        """Sum of the law and of the terms that depend on the law, shape (n,), with other friction
        over Fc at the first sample of each log."""
        at = [self.layout.base.index(x) for x in ("Fc", "sigma1") if x in self.layout.base]
        found, first = [], 0
        for part in self._parts:
            tracks = part.tracks.begun(held[first : first + len(part.logs)])
            track = tracks.along(law)
            some = self._columns_of(track, part) @ beta[at]
            for k, term in enumerate(terms):
                if term.follows_law:
                    columns = columns_of_term(term, with_track(track, part), part)
                    some += columns @ beta[self.layout.coefficients(k)]
            found.append(some)
            first += len(part.logs)
        return np.concatenate(found)

    def _target(self, terms: tuple[Term, ...], part: Bundle) -> Array:
        key = "target", delay_of(terms), age_of(terms), *changing_drive(terms)
        return part.store.get(key, lambda: self._target_of(self._driven(terms, part), terms, part))

    def _target_of(self, driven: Spectra, terms: tuple[Term, ...], part: Bundle) -> Array:
        """Target of the columns, with the drive as changed by the terms."""
        drive, age = part.balanced(driven, delay_of(terms)), age_of(terms)
        if age:
            drive = drive + age * self._damping_rate(terms, part)
        known = part.load_and_velocity[:, 0]
        return drive if self.prepared.gain_unknown else drive - known

    def _damping_rate(self, terms: tuple[Term, ...], part: Bundle) -> Array:
        """Damping rate of the drive as changed by the terms, see `Bundle`."""
        key = "damping rate", *changing_drive(terms)
        return part.store.get(key, lambda: part.damping_rate(drive_changes(terms)))

    def answer(self, terms: tuple[Term, ...]) -> Array:
        """Change of the drive per small error of position, (n,); zero for a measured drive."""
        key, changes = ("answer", *changing_drive(terms)), drive_changes(terms)
        found = [part.store.get(key, partial(part.answer, changes)) for part in self._parts]
        return np.concatenate(found)

    def _columns_of(self, track: Array, part: Bundle) -> Array:
        if "sigma1" in self.layout.base:
            return part.kept(np.stack([track[0], track[1] * part.velocity]))
        return part.kept(track[:1])

    def _term(self, term: Term, law: Shape, part: Bundle) -> Array:
        return columns_of_term(term, self._signals(term, law, part), part)

    def _signals(self, term: Term, law: Shape, part: Bundle) -> list[Array]:
        """Signals of each log in the form that a term requires."""
        if term.follows_law:
            return list(with_track(self._track(law, part), part))
        return [s.signals for s in part.logs]

    def _driven(self, terms: tuple[Term, ...], part: Bundle) -> Spectra:
        """Drives that these terms compute from the logs' commands; the latest are cached."""
        changes = changing_drive(terms)
        known, found = self._latest.get(part, (None, None))
        if found is None or known != changes:
            found = part.changed(drive_changes(terms))
            self._latest[part] = changes, found
        return found

    def _track(self, law: Shape, part: Bundle) -> Array:
        """H and dz/dq, shape (2, n)."""
        return part.store.get(("track", law), lambda: part.tracks.along(law))

    def _some_moves(
        self, law: Shape, terms: tuple[Term, ...], beta: Array, through_terms: bool, part: Bundle
    ) -> Array:
        found = list(self._law_moves(law, terms if through_terms else (), beta, part).T)
        for k, term in enumerate(terms):
            along = self._signals(term, law, part) if term.free_shape else []
            for j, (x, reach) in enumerate(reaches(term, self.span)):
                if isinstance(term, DriveTerm | TargetTiming):
                    found.append(self._drive_move(terms, k, j, part))
                elif isinstance(term, DampingAge):
                    names = self.layout.base
                    sigma2 = beta[names.index("sigma2")] if "sigma2" in names else 0.0
                    found.append(-sigma2 * part.rate)
                elif isinstance(term, VelocityAge):
                    found.append(-self._damping_rate(terms, part))
                elif not term.coefficients:  # the drive of an earlier time
                    found.append(part.balanced(self._driven(terms, part), delay_of(terms), 1))
                else:
                    h = _STEP * reach if np.isfinite(reach) else 1e-4
                    ends = [term.with_shape(in_place(term.free_shape, j, x + d)) for d in (h, -h)]
                    own = beta[self.layout.coefficients(k)]
                    logs = list(zip(part.logs, along, strict=True))
                    above, below = (
                        np.concatenate([end.torque(s, signals, own) for s, signals in logs])
                        for end in ends
                    )
                    found.append(part.kept((above - below)[None] / (2.0 * h))[:, 0])
        kept = len(part.load_and_velocity)
        return np.column_stack(found) if found else np.zeros((kept, 0))

    def _drive_move(self, terms: tuple[Term, ...], k: int, j: int, part: Bundle) -> Array:
        """Derivative by number j of term k, an effect of the drive, shape (n,)."""
        term, x = terms[k], terms[k].free_shape[j]
        # a smaller step of a time offset would only see threshold crossings
        h = 0.1 * term.sample if isinstance(term, Timing) else _STEP * (abs(x) or 1.0)
        moved = term.with_shape(in_place(term.free_shape, j, x + h))
        changed = in_place(terms, k, moved)
        there = self._target_of(part.changed(drive_changes(changed)), changed, part)
        return np.asarray((self._target(terms, part) - there) / h)

    def _law_moves(self, law: Shape, terms: tuple[Term, ...], beta: Array, part: Bundle) -> Array:
        """Derivatives by the numbers of the law, shape (n, number)."""
        layout = self.layout
        levels = [beta[layout.base.index(x)] for x in ("Fc", "sigma1") if x in layout.base]
        found = np.tensordot(np.array(levels), self._unit_moves(law, part), axes=1)
        following = [k for k, term in enumerate(terms) if term.follows_law]
        if not following:
            return found
        _, dH, _ = part.tracks.tangents(law, of_rate=False)
        torque = np.zeros_like(dH)
        for k in following:
            term, weights = terms[k], beta[layout.coefficients(k)]
            logs = zip(part.logs, part.places, self._signals(term, law, part), strict=True)
            for s, own, signals in logs:
                level = signals[:, H].copy()
                here = term.torque(s, signals, weights)
                for j, tangent in enumerate(dH[:, own]):
                    # these columns are linear in H, but for a bound on it; a tangent of next to
                    # nothing needs no step without end
                    h = 1e-4 / max(float(np.abs(tangent).max()), 1e-4)
                    signals[:, H] = level + h * tangent
                    torque[j, own] += (term.torque(s, signals, weights) - here) / h
        return found + part.kept(torque)

    def _unit_moves(self, law: Shape, part: Bundle) -> Array:
        """Derivatives of the columns of a law by its numbers, shape (columns, n, number)."""
        damped = "sigma1" in self.layout.base

        def make() -> Array:
            track, dH, drate = part.tracks.tangents(law, damped)
            part.store.get(("track", law), lambda: track)
            rows = [track[:1], dH]
            if drate is not None:
                rows += [track[1:] * part.velocity, drate * part.velocity]
            # one transform for all rows; the first of each is the column itself
            both = part.kept(np.concatenate(rows)).reshape(-1, len(rows) // 2, 1 + len(dH))
            part.store.get(("law", self.layout.base, law), lambda: both[..., 0].copy())
            return np.ascontiguousarray(both[..., 1:].transpose(1, 0, 2))

        return part.store.get(("moves", law, damped), make)


def with_track(track: Array, bundle: Bundle) -> Iterator[Array]:
    """Signals of each log with H and RATE of a law, shape (2, n), filled in."""
    for segment, own in zip(bundle.logs, bundle.places, strict=True):
        signals = segment.signals.copy()
        signals[:, H], signals[:, RATE] = track[:, own]
        yield signals


def columns_of_term(term: Term, signals: Iterable[Array], part: Bundle) -> Array:
    """Columns of a term along each log of a bundle, on the kept samples, (m, k)."""
    logs = zip(part.logs, signals, strict=True)
    return part.kept(np.concatenate([term.columns(s, x) for s, x in logs]).T)


def with_motor(X: Array, beta: Array, layout: Layout, segments: Sequence[Segment]) -> Array:
    """The columns, including those that depend on the motor torque, in a fit to voltage or current.

    The motor torque equals the rest of the balance, without what acts on the motor. So it follows
    from the unknown coefficients: these columns and the coefficients are computed alternately. It
    is filtered, because the motion is known no finer, and unfiltered steps of friction would stand
    out.

    Args:
        X: shape (n, k), rows of the logs' kept samples; the first column is that of the load.
        beta: in units of the drive, shape (k,).
    """
    at = [i for i, term in enumerate(layout.terms) if MOTOR in term.effect.needs]
    if not at:
        return X
    taken = beta.copy()
    for i, term in enumerate(layout.terms):
        if term.effect.on_motor:
            taken[layout.coefficients(i)] = 0.0
    torque = X @ taken / beta[0]
    filled, begin = X.copy(), 0
    for segment in segments:
        signals = segment.at_kept(segment.signals)
        end = begin + len(signals)
        signals[:, MOTOR] = torque[begin:end]
        for i in at:
            filled[begin:end, layout.coefficients(i)] = layout.terms[i].columns(segment, signals)
        begin = end
    return np.asarray(filled)


def reaches(term: Term, span: float) -> list[tuple[float, float]]:
    """Each free shape number of a term, and by how much one search may change it, by the travel."""
    found = []
    for i, x in enumerate(term.free_shape):
        if isinstance(term, Timing):
            reach = np.inf
        elif term.effect.is_wave and i == 0:
            reach = np.pi / span / 2.0  # between the lines of a spectrum
        else:
            # a zero was not searched yet: the physical range decides
            # how far a term's shape number may move in one search, over itself
            reach = 0.6 * abs(x) + 1e-12 if x else np.inf
        found.append((x, reach))
    return found


def coefficient_bounds(prepared: Prepared, layout: Layout) -> tuple[Array, Array]:
    """Physical signs: levels and gains are positive, terms have the bounds of their effects."""
    least = {"load": 1e-12, "Fc": prepared.least_level, "sigma1": 0.0, "sigma2": 0.0}
    pairs = [(least[name], np.inf) for name in layout.base]
    for term in layout.terms:
        pairs += term_bounds(prepared, term)
    low, high = np.array(pairs).T
    return low, high


def solve(X: Array, y: Array, low: Array, high: Array) -> Array:
    """Linear least squares, bounded only if the free solution violates a bound."""
    scale, k = lengths(X), X.shape[1]
    # the triangle says all that the columns do, free or bounded, and is small
    triangle = np.asarray(np.linalg.qr(np.column_stack([X / scale, y]), mode="r"))
    R, z = triangle[:k, :k], triangle[:k, k]
    beta: Array = np.linalg.lstsq(R, z, rcond=1e-10)[0] / scale
    if np.all(beta >= low) and np.all(beta <= high):
        return beta
    found = lsq_linear(R, z, (low * scale, high * scale), method="bvls")
    # rounding puts a coefficient that is on its bound beyond it
    return np.asarray(np.clip(found.x / scale, low, high))
