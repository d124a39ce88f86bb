"""Least-squares fit of shared causes, with every joint's law refitted.

A tree's torque is linear in the ten parameters of its bodies, in rotors and in shafts, but not in
the numbers that keep a body physically possible. So the torque is linearised once in the corrected
parameters, and the numbers are searched through that map: a large change of a body is as exact as a
small one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from frictionjoint.arrays import Array
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import pseudo_inverse
from frictionjoint.robot.causes.cause import Cause, Found, composed
from frictionjoint.robot.clock import Clock
from frictionjoint.robot.columns import common_columns, gram_of, own_effects
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.inertia import TEN
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.stack import roots

# of the steepest slope, below which a number shows nothing
_FLAT = 1e-9


def fitted_causes(
    joints: Sequence[FittedJoint], blocks: Clock, found: Found, own: Callable[[str], bool]
) -> Found:
    """The causes with the numbers that minimise the residual of these joints.

    Args:
        joints: with the corrections of `found`; common effects that were fitted with their laws are
            refitted, equal in all joints. blocks: of time. own: effects of single joints, by label,
            which are refitted like the laws.
    """
    here, places = found.state, _places(found)
    if not places:
        return found
    factor, target = _squares(joints, blocks, here, places, own)
    prior = np.concatenate([c.prior for c in found.causes]) / np.sqrt(blocks.alike)
    steepest = np.linalg.norm(factor @ _moves(found.original, found.causes, found.numbers, places))
    # a number without a prior and without influence on any torque stays at zero
    pull = np.diag(np.hypot(1.0 / prior, _FLAT * steepest))
    at, left = _read(here, places), np.concatenate([-target, np.zeros(len(pull))])
    problem = _Problem(found.causes, found.original, places, at, left, factor, pull)
    least = problem.least(_starts(found, problem))
    return replace(found, numbers=tuple(problem.split(least)))


@dataclass(frozen=True)
class _Problem:
    """Residual of the joints, and prior around the model's values, by the numbers of causes.

    Attributes:
        before: corrections without the causes.
        at, here: coordinates of corrections, and the residual there.
        factor, pull: derivatives of the residual by coordinates, and next to that by the numbers.
    """

    causes: tuple[Cause, ...]
    before: Corrections
    places: Sequence["_Place"]
    at: Array
    here: Array
    factor: Array
    pull: Array

    def split(self, x: NDArray[Any]) -> list[NDArray[Any]]:
        """What belongs to each cause."""
        return np.split(x, np.cumsum([len(c.start) for c in self.causes])[:-1])

    def left(self, x: Array) -> Array:
        """Residual."""
        moved = _read(composed(self.causes, self.split(x), self.before), self.places) - self.at
        return np.asarray(self.here + np.concatenate([self.factor @ moved, self.pull @ x]))

    def slopes(self, x: Array) -> Array:
        """Its derivative."""
        moves = _moves(self.before, self.causes, self.split(x), self.places)
        return np.concatenate([self.factor @ moves, self.pull])

    def least(self, starts: Sequence[Array]) -> Array:
        """The numbers with the smallest residual, from several starts."""
        bounds = np.concatenate([np.reshape(c.bounds, (-1, 2)) for c in self.causes]).T
        # a valley between a mass and rotors takes hundreds of steps
        how: dict[str, Any] = {"bounds": tuple(bounds), "x_scale": "jac", "max_nfev": 600}
        tried = [least_squares(self.left, np.clip(x, *bounds), self.slopes, **how) for x in starts]
        return np.asarray(min(tried, key=lambda one: float(one.cost)).x)


def _starts(found: Found, whole: _Problem) -> list[Array]:
    """Starting numbers: the given ones or those without a cause, whichever have the smaller
    residual; and the best point along the rays of a homogeneous cause, uninformative at zero."""
    given = np.concatenate(found.numbers)
    nothing = np.concatenate(
        [n if c.homogeneous else c.start for c, n in zip(found.causes, found.numbers, strict=True)]
    )
    start = min((given, nothing), key=lambda x: float(np.sum(whole.left(x) ** 2)))
    parts = whole.split(start)
    columns = whole.split(np.arange(len(start)))
    starts, here = [start], whole.left(start)
    for i, (cause, x) in enumerate(zip(found.causes, found.numbers, strict=True)):
        if cause.homogeneous and not np.any(x):
            before = composed(found.causes[:i], parts[:i], found.original)
            at = _read(cause.applied(before, x), whole.places)
            pull = whole.pull[:, columns[i]]
            ways = _Problem((cause,), before, whole.places, at, here, whole.factor, pull)
            first = np.linalg.lstsq(ways.slopes(x), -here, rcond=_FLAT)[0]
            rays = cause.rays(np.asarray(first))
            if rays:
                further = start.copy()
                further[columns[i]] += ways.least(rays)
                starts.append(further)
    return starts


# a coordinate of the corrections: kind, body or joint or shaft, and which of its numbers
_Place = tuple[str, int | str, int]


def _coordinates(state: Corrections) -> dict[_Place, float]:
    """Value of each coordinate but those of bodies."""
    found: dict[_Place, float] = {("gravity", 0, k): x for k, x in enumerate(state.gravity)}
    found |= {("armature", name, 0): x for name, x in state.armature.items()}
    found |= {("offset", name, 0): x for name, x in state.offset.items()}
    for i, shaft in enumerate(state.shafts):
        found |= {("shaft", i, k): x for k, x in enumerate(shaft.numbers)}
    return found


def _moved(state: Corrections, place: _Place, by: float) -> Corrections:
    """Corrections with a coordinate changed."""
    kind, which, number = place
    if kind == "phi":
        body = int(which)
        return state.with_body(body, state.phi[body] + by * np.eye(TEN)[number])
    if kind == "gravity":
        return replace(state, gravity=state.gravity + by * np.eye(3)[number])
    if kind == "shaft":
        shafts = list(state.shafts)
        numbers = list(shafts[int(which)].numbers)
        numbers[number] += by
        shafts[int(which)] = replace(shafts[int(which)], numbers=tuple(numbers))
        return replace(state, shafts=tuple(shafts))
    values = getattr(state, kind)
    return replace(state, **{kind: values | {which: values.get(which, 0.0) + by}})


def _places(found: Found) -> list[_Place]:
    """Coordinates that causes change: parameters of bodies, then others."""
    bodies: dict[_Place, None] = {}
    others: dict[_Place, None] = {}
    for i in range(len(found.causes)):
        for low, high, _ in found.pairs(i):
            for b in np.flatnonzero(np.any(low.phi != high.phi, axis=1)).tolist():
                bodies |= dict.fromkeys(("phi", b, k) for k in range(TEN))
            if np.any(low.gravity != high.gravity):  # one that a small turn hardly changes, too
                others |= dict.fromkeys(("gravity", 0, k) for k in range(3))
            before, after = _coordinates(low), _coordinates(high)
            others |= dict.fromkeys(p for p in after if before.get(p) != after[p])
    return [*bodies, *others]


def _read(state: Corrections, places: Sequence[_Place]) -> Array:
    known = _coordinates(state)
    # the shafts of later causes are not there yet
    found = [state.phi[int(p[1]), p[2]] if p[0] == "phi" else known.get(p, 0.0) for p in places]
    return np.array(found, dtype=np.float64)


def _moves(
    state: Corrections, causes: Sequence[Cause], numbers: Sequence[Array], places: Sequence[_Place]
) -> Array:
    """Derivatives of coordinates by numbers, (coordinate, number): causes share no coordinate."""
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
    places: Sequence[_Place],
    own: Callable[[str], bool],
) -> tuple[Array, Array]:
    """Factor F and target y: |F dz - y|^2 is the residual of all joints, up to a constant, with the
    laws, effects of single joints and common effects projected out."""
    h = 1e-3  # of each coordinate, over 1 in SI units
    pairs = [(_moved(here, p, -h), _moved(here, p, h), 2.0 * h) for p in places]
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
