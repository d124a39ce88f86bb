"""Least-squares fit of shared causes, with every joint's law refitted.

A tree's torque is linear in the ten parameters of its bodies, in rotors and in shafts, but not in
the numbers that keep a body physically possible. So the torque is linearised once in the corrected
parameters, and the numbers are searched through that map: a large change of a body is as exact as a
small one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from frictionjoint.arrays import Array, Index
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import pseudo_inverse
from frictionjoint.robot.causes.cause import Cause, composed
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import gram_of, own_effects
from frictionjoint.robot.common import common_columns
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.found import Found
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import roots

# of the steepest slope, below which a number shows nothing
_FLAT = 1e-9


def descended(
    joints: Sequence[FittedJoint], blocks: Clock, found: Found, own: Callable[[str], bool]
) -> Found:
    """The causes with the numbers that minimise the residual of these joints.

    Args:
        joints: with the corrections of `found`; common effects that were fitted with their laws are
            refitted, equal in all joints. blocks: of time. own: effects of single joints, by label,
            which are refitted like the laws.
    """
    here = found.state
    places = _places(found)
    if not len(places):
        return found
    factor, target = _squares(joints, blocks, here, places, own)
    at = _read(here, places)
    prior = np.concatenate([c.prior for c in found.causes]) / np.sqrt(blocks.alike)
    ends = np.cumsum([len(n) for n in found.numbers])[:-1]
    steepest = np.linalg.norm(factor @ _moves(found.original, found.causes, found.numbers, places))
    # a number without presumption that moves no torque would wander off: it stays at nothing
    pull = np.hypot(1.0 / prior, _FLAT * steepest)

    def left(x: Array) -> Array:
        parts = tuple(np.split(x, ends))
        moved = _read(composed(found.causes, parts, found.original), places) - at
        return np.concatenate([factor @ moved - target, x * pull])

    def slopes(x: Array) -> Array:
        moves = _moves(found.original, found.causes, np.split(x, ends), places)
        return np.concatenate([factor @ moves, np.diag(pull)])

    bounds = np.concatenate([np.reshape(c.bounds, (-1, 2)) for c in found.causes]).T
    starts = _starts(found, left, bounds, places, factor, pull)
    least = _least(left, slopes, starts, bounds)
    return replace(found, numbers=tuple(np.split(least, ends)))


def _least(
    left: Callable[[Array], Array],
    slopes: Callable[[Array], Array],
    starts: Sequence[Array],
    bounds: Array,
) -> Array:
    """The numbers with the smallest residual, from several starts."""
    how: dict[str, Any] = {"bounds": tuple(bounds), "x_scale": "jac", "max_nfev": 60}
    tried = [least_squares(left, np.clip(x, *bounds), slopes, **how) for x in starts]
    return np.asarray(min(tried, key=lambda one: float(one.cost)).x)


def _starts(
    found: Found,
    left: Callable[[Array], Array],
    bounds: Array,
    places: "_Places",
    factor: Array,
    pull: Array,
) -> list[Array]:
    """Starting numbers: the given ones or those without a cause, whichever have the smaller
    residual.

    At zero the columns of a homogeneous cause are not informative. Then the best point along its
    rays is tried as well.

    Args:
        left: residual of all numbers, in which changes of `places` count by `factor` and the
            numbers by `pull`.
    """
    given = np.concatenate(found.numbers)
    nothing = np.concatenate(
        [n if c.homogeneous else c.start for c, n in zip(found.causes, found.numbers, strict=True)]
    )
    start = min((given, nothing), key=lambda x: float(np.sum(left(x) ** 2)))
    ends = np.cumsum([0, *(len(n) for n in found.numbers)])
    parts = tuple(np.split(start, ends[1:-1]))
    starts, here = [start], left(start)
    for i, (cause, x) in enumerate(zip(found.causes, found.numbers, strict=True)):
        if cause.homogeneous and not np.any(x):
            at = slice(int(ends[i]), int(ends[i + 1]))
            before = composed(found.causes[:i], parts[:i], found.original)
            own = np.eye(len(start))[:, at] * pull[at]
            ways = _Ways(cause, before, here, places, factor, own)
            first = np.linalg.lstsq(ways.slopes(x), -here, rcond=_FLAT)[0]
            rays = cause.rays(np.asarray(first))
            if rays:
                further = start.copy()
                further[at] += _least(ways.left, ways.slopes, rays, bounds[:, at])
                starts.append(further)
    return starts


@dataclass(frozen=True)
class _Ways:
    """Numbers of one cause, with all others as they are.

    Attributes:
        before: corrections by the causes before it. here: the residual without it.
        own: derivative of the residual by its numbers next to that through `places`.
    """

    cause: Cause
    before: Corrections
    here: Array
    places: "_Places"
    factor: Array
    own: Array

    def left(self, y: Array) -> Array:
        """Residual."""
        nothing, some = (
            _read(self.cause.applied(self.before, x), self.places) for x in (np.zeros(len(y)), y)
        )
        moved = self.factor @ (some - nothing)
        return np.asarray(self.here + np.concatenate([moved, self.own @ y]))

    def slopes(self, y: Array) -> Array:
        """Its derivative."""
        moves = _moves(self.before, (self.cause,), (y,), self.places)
        return np.concatenate([self.factor @ moves, self.own])


@dataclass(frozen=True)
class _Place:
    """A coordinate of the corrections: kind, body or joint or shaft, and which of its numbers."""

    kind: str
    which: int | str
    number: int = 0

    def of(self, state: Corrections) -> float:
        """Value of the coordinate, no body's."""
        if self.kind == "gravity":
            return float(state.gravity[self.number])
        if self.kind == "shaft":
            # the shafts of later causes are not there yet
            there = int(self.which) < len(state.shafts)
            return float(state.shafts[int(self.which)].numbers[self.number]) if there else 0.0
        values: dict[str, float] = getattr(state, self.kind)
        return values.get(str(self.which), 0.0)

    def moved(self, state: Corrections, by: float) -> Corrections:
        """The corrections with the coordinate changed."""
        if self.kind == "phi":
            phi = state.phi[int(self.which)].copy()
            phi[self.number] += by
            return state.with_body(int(self.which), phi)
        if self.kind == "gravity":
            return replace(state, gravity=state.gravity + by * np.eye(3)[self.number])
        if self.kind == "shaft":
            shafts = list(state.shafts)
            shafts[int(self.which)] = shafts[int(self.which)].moved(self.number, by)
            return replace(state, shafts=tuple(shafts))
        values = getattr(state, self.kind)
        here = {str(self.which): values.get(str(self.which), 0.0) + by}
        return replace(state, **{self.kind: values | here})


@dataclass(frozen=True)
class _Places:
    """Coordinates that causes change: parameters of bodies, by body and number, then others."""

    bodies: Index
    numbers: Index
    others: tuple[_Place, ...]

    def __len__(self) -> int:
        return len(self.bodies) + len(self.others)

    def __iter__(self) -> Iterator[_Place]:
        for b, k in zip(self.bodies.tolist(), self.numbers.tolist(), strict=True):
            yield _Place("phi", b, k)
        yield from self.others


def _places(found: Found) -> _Places:
    bodies: dict[tuple[int, int], None] = {}
    places: dict[_Place, None] = {}
    for i in range(len(found.causes)):
        for low, high, _ in found.pairs(i):
            for b in np.flatnonzero(np.any(low.phi != high.phi, axis=1)):
                bodies |= dict.fromkeys((int(b), k) for k in range(low.phi.shape[1]))
            if np.any(low.gravity != high.gravity):
                places |= dict.fromkeys(_Place("gravity", 0, k) for k in range(3))
            for kind in ("armature", "offset"):
                one, other = getattr(low, kind), getattr(high, kind)
                places |= dict.fromkeys(_Place(kind, n) for n in other if one.get(n) != other[n])
            for k, (one, other) in enumerate(zip(low.shafts, high.shafts, strict=True)):
                at = np.flatnonzero(one.numbers != other.numbers)
                places |= dict.fromkeys(_Place("shaft", k, int(n)) for n in at)
    at, numbers = (np.array([key[k] for key in bodies], dtype=np.int64) for k in (0, 1))
    return _Places(at, numbers, tuple(places))


def _read(state: Corrections, places: _Places) -> Array:
    bodies = state.phi[places.bodies, places.numbers]
    return np.concatenate([bodies, [place.of(state) for place in places.others]])


def _moves(
    state: Corrections, causes: Sequence[Cause], numbers: Sequence[Array], places: _Places
) -> Array:
    """Derivatives of coordinates by each number, (coordinate, number), by differences.

    Each cause changes coordinates of its own, so later causes do not matter.
    """
    found = []
    for cause, x in zip(causes, numbers, strict=True):
        after = cause.applied(state, x)
        here = _read(after, places)
        for step, way in zip(cause.steps, np.eye(len(x)), strict=True):
            there = _read(cause.applied(state, x + step * way), places)
            found.append((there - here) / step)
        state = after
    return np.transpose(found)


def _squares(
    joints: Sequence[FittedJoint],
    blocks: Clock,
    here: Corrections,
    places: _Places,
    own: Callable[[str], bool],
) -> tuple[Array, Array]:
    """Factor F and target y: |F dz - y|^2 is the residual of all joints, up to a constant.

    Laws, effects of single joints and common effects are projected out.
    """
    h = 1e-3  # of each coordinate, over 1 in SI units
    pairs = [(p.moved(here, -h), p.moved(here, h), 2.0 * h) for p in places]
    n, grams = len(places), []
    for joint in joints:
        alike = common_columns(joint, joint.common_effects)
        single = own_effects(joint, blocks, own).values()
        columns = np.column_stack([joint.columns(pairs), *alike, *single])
        G = gram_of(joint, columns, np.arange(columns.shape[1]), blocks).grams.sum(axis=0)
        grams.append(_apart(G, n + sum(x.shape[1] for x in alike)))
    G = _apart(np.sum(grams, axis=0), n)
    A, b = G[:n, :n], G[:n, -1]
    scale = roots(A)
    values, vectors = eigh(A / np.outer(scale, scale))
    # directions of smaller eigenvalues move no torque
    kept = values > 1e-12 * values[-1]
    root = np.sqrt(values[kept])
    factor = root[:, None] * vectors[:, kept].T * scale
    return factor, (vectors[:, kept].T @ (b / scale)) / root


def _apart(G: Array, first: int) -> Array:
    """A Gram matrix, the residual last, with the columns from a given index on projected out."""
    inner, own = G[first:-1, first:-1], G[first:-1]
    kept = np.r_[:first, len(G) - 1]
    if not len(inner):
        return G
    through = pseudo_inverse(inner) @ own
    return np.asarray((G - own.T @ through)[np.ix_(kept, kept)])
