"""Shape numbers of a set, refined together on the squares that it leaves (Gauss-Newton)."""

from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.effects.end_stop import BOTH, LOWER, UPPER
from frictionjoint.identify.terms import EffectTerm
from linear_search.columns import Candidate, Models, is_delay
from linear_search.experiment import Experiment
from linear_search.score import Score

# step of one unit: of a number that is positive, of its logarithm; of a wave, over the distance of
# two lines of the spectrum; of a stop, over the travel; of a delay, over a sample
_LOG, _LINE, _STOP, _SAMPLE = 0.4, 0.3, 0.03, 0.5
# units over which derivatives are taken: of what is smooth, of what leaps
_SMOOTH, _LEAPING = 0.05, 0.15
_STEPS, _TRIALS, _MOST = 8, 5, 2.0
# part of the squares by which a step must lower them for another to follow
_CLOSE = 2e-3
# waves that the usual travel must hold: fewer are any curve
_FEWEST_WAVES = 0.5
# finite steps of numbers with which a torque leaps: the first and the last
_FIRST, _LAST = 0.6, 0.1


def free_numbers(candidate: Candidate) -> range:
    """Places of the shape numbers that may move."""
    if not isinstance(candidate, EffectTerm):
        return range(0)
    return range(candidate.effect.shape_fixed, len(candidate.shape))


def moved(candidate: Candidate, j: int, by: float, own: Experiment) -> Candidate:
    """A candidate with shape number j moved by so many units, within its range."""
    assert isinstance(candidate, EffectTerm)
    effect, x = candidate.effect, candidate.shape[j]
    span = own.prepared.span
    if effect.proposed_by == "spectrum" and j == 0:
        fewest = 2.0 * np.pi * _FEWEST_WAVES / own.prepared.usual_travel
        x = max(x + by * _LINE * np.pi / span, min(x, fewest))
    elif effect in (UPPER, LOWER, BOTH):
        x += by * _STOP * span
    elif is_delay(candidate):
        x += by * _SAMPLE * own.sample
    else:
        x *= float(np.exp(by * _LOG))
    if effect.shape_bounds:
        x = float(np.clip(x, *effect.shape_bounds[j]))
    return replace(candidate, shape=(*candidate.shape[:j], float(x), *candidate.shape[j + 1 :]))


def refined(score: Score, models: Models) -> Models:
    """A set with the shape numbers at which it leaves least."""
    places = [(k, j) for k, c in enumerate(models) for j in free_numbers(c)]
    if not places:
        return models
    models = _descended(score, models, places)
    leaping = [(k, j) for k, j in places if _leaps(models[k])]
    return _stepped(score, models, leaping) if leaping else models


def _leaps(candidate: Candidate) -> bool:
    return isinstance(candidate, EffectTerm) and candidate.effect.leaps


def _descended(score: Score, models: Models, places: list[tuple[int, int]]) -> Models:
    (z, e), least, damping = score.solve(models), score.squares(models), 1e-2
    for _ in range(_STEPS):
        J = _derivatives(score, models, z, places)
        normal, slope = J.T @ J, J.T @ e
        scale = np.diag(np.maximum(np.diag(normal), 1e-12 * max(float(np.trace(normal)), 1e-300)))
        gained = 0.0
        for _ in range(_TRIALS):
            step = np.linalg.lstsq(normal + damping * scale, slope, rcond=1e-12)[0]
            there = _moved_by(score, models, places, np.clip(step, -_MOST, _MOST))
            squares = score.squares(there)
            if squares < least:
                gained = (least - squares) / least
                models, (z, e), least = there, score.solve(there), squares
                damping *= 0.3
                break
            damping *= 6.0
        if gained < _CLOSE:
            break
    return models


def _derivatives(
    score: Score, models: Models, coefficients: Array, places: list[tuple[int, int]]
) -> Array:
    """Of the set's torque by each number, without what its own columns hold, (n + m, places)."""
    x, *_ = score.stacked(models)
    Q, _ = np.linalg.qr(x)
    ends = np.cumsum([len(c.low) for c in score.columns.of(models)])[:-1]
    own = np.split(coefficients, ends)
    sides = []
    for k, j in places:
        h = _LEAPING if _leaps(models[k]) else _SMOOTH
        sides.append((k, h, *(moved(models[k], j, d, score.experiment) for d in (h, -h))))
    score.columns.make([c for _, _, *both in sides for c in both])
    found = []
    for k, h, *both in sides:
        # what comes on top of an effect of the drive changes with it
        up, down = (score.columns.of((*models[:k], c, *models[k + 1 :])) for c in both)
        moves = np.zeros(len(x))
        for u, d, z in zip(up, down, own, strict=True):
            if u is not d:
                moves += (u.out - d.out) @ z
        found.append(moves / (2.0 * h))
    J = np.column_stack(found)
    return np.asarray(J - Q @ (Q.T @ J))


def _moved_by(score: Score, models: Models, places: list[tuple[int, int]], step: Array) -> Models:
    there = list(models)
    for (k, j), by in zip(places, step, strict=True):
        there[k] = moved(there[k], j, float(by), score.experiment)
    return tuple(there)


def _stepped(score: Score, models: Models, places: list[tuple[int, int]]) -> Models:
    """Finite steps of what leaps: derivatives do not say where its squares are least."""
    least, step = score.squares(models), _FIRST
    while step > _LAST:
        better = False
        for place in places:
            for by in (step, -step):
                there = _moved_by(score, models, [place], np.array([by]))
                squares = score.squares(there)
                if squares < least * (1.0 - 1e-3):
                    models, least, better = there, squares, True
                    break
        if not better:
            step /= 2.0
    return models
