"""Effects found by simulated motion, too small for the torque balance to name.

The torque balance covers a narrow band and leaves out samples whose torque the position does not
determine; whole motions in closed loop contain more. So after a refinement every effect is screened
on the simulated motion of the logs, to first order in its coefficients and in all numbers of the
model. The best ones are fitted and refined. An effect is accepted if it improves the prediction of
logs of kinds that it was not fitted to, and if its contribution is about as large as the remaining
error.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import COUNT
from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN, TIE
from frictionjoint.diagnose.candidate import signals_of, without_columns
from frictionjoint.diagnose.drive import sign_flips
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.library import effect_terms, effects
from frictionjoint.diagnose.moves import ALTERNATIVES, Look, Looked, look
from frictionjoint.effects.rigid_body import INERTIA_ERROR
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.rounding import rounded
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.identify.weights import reweighed
from frictionjoint.refine.guard import clearly_less
from frictionjoint.refine.objective import LONGEST_WINDOW_S, Objective, differences
from frictionjoint.refine.refine import Refined, Tried, judged, on_whole_logs, on_windows, refine
from frictionjoint.refine.vector import Vector, with_term
from frictionjoint.replay.closed_loop import Course
from frictionjoint.replay.free_runs import simulated_whole


def named_by_motion(
    found: Trace,
    courses: Sequence[Course],
    armature: float,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[Trace, Refined]:
    """Findings together with the effects that the simulated motion supports, and their refinement.

    Args:
        found: outcome of the search by torque. courses: the fitted logs. armature: of the MJCF.
    """
    now = refine(found.prepared, found.final, courses, progress)
    # what very few logs say may as well be chance
    rounds = 3 if 0.5 ** len(courses) <= SIGNIFICANCE else 0
    count = float(np.mean([course.run.block[COUNT] ** 2 for course in courses]))
    for _ in range(rounds):
        progress("checking effects by the simulated motion")
        best, before = None, float(np.mean(now.near.fitted**2))
        for fitted, coefficients in _promising(found, now, courses, armature):
            prepared, fitted = reweighed(found.prepared, fitted)
            term = fitted.effects[-1]
            other = _near(prepared, fitted, courses, armature, now, coefficients)
            # of models fitted to all logs: without a kind of logs, both would lose parameters that
            # only this kind determines, which would hide what the effect removes
            removed = float(np.mean(now.near.fitted**2 - other.fitted**2))
            part = removed / before
            progress(f"checking {term.name} by the simulated motion: error down by {part:.0%}")
            # less may come from an error of the law, and no encoder shows less than a count
            if not removed >= max(SMALLEST_GAIN * before, count):
                continue
            seen = held_out_evidence(term, other, now)
            (row,) = seen.rows
            gain = seen.gain(row)
            progress(f"checking {term.name} by the simulated motion: p {row.p_value:.3f}")
            if row.p_value <= SIGNIFICANCE and (best is None or gain > best[0].gain):
                own = Finding(term, seen, row, gain, (), (), fitted)
                best = own, prepared, other
        if best is None:
            break
        own, prepared, chosen = best
        now = judged(prepared, chosen, on_whole_logs(chosen, courses), courses)
        pairs = zip(found.findings, own.fit.effects, strict=False)
        findings = (*(replace(f, term=t) for f, t in pairs), own)
        found = replace(found, prepared=prepared, final=own.fit, findings=findings)
    return found, _with_armature(found, now, courses, progress)


def _with_armature(
    found: Trace, now: Refined, courses: Sequence[Course], progress: Callable[[str], None]
) -> Refined:
    """Refine with the armature of the MJCF free, if that improves the prediction of left-out logs.

    A rotor's inertia is rarely measured, and the torque balance can mistake it for a delay. But it
    can also imitate effects that whole motions show, so it is tried after them, and on windows too.
    """
    if any(t.effect.is_inertia for t in found.final.terms):
        return now
    terms = (*found.final.effects, EffectTerm(INERTIA_ERROR))
    prepared, fitted = found.prepared, refit(found.prepared, terms, found.final.shape, ROUGH)
    progress("refining the armature")
    near = _near(prepared, fitted, courses, now.found.vector.armature, now, np.zeros(1))
    if clearly_less(near.left_out, now.near.left_out):
        other = on_whole_logs(near, courses)
        if clearly_less(other.left_out, now.left_out):
            return Refined(near, other, now.before, taken=True)
    return now


def _near(
    prepared: Prepared,
    fitted: Fit,
    courses: Sequence[Course],
    armature: float,
    now: Refined,
    coefficients: Array,
) -> Tried:
    """A model with one more effect, refined on windows from two starting points.

    The first is the fit to torque. The second is the refined model with the new effect added.

    Args:
        coefficients: of the new effect, which is the last one, N m.
    """
    vector = Vector(prepared, fitted, stated_covariance(prepared, fitted), armature)
    x = vector.carried(now.near.vector, now.near.values)
    new = vector.fitted.terms.index(vector.fitted.effects[-1])
    x[vector.layout.coefficients(new)] = coefficients
    return on_windows(vector, courses, [vector.start, np.clip(x, vector.low, vector.high)])


def held_out_evidence(term: Term, other: Tried, now: Refined) -> Look:
    """Evidence for an effect from held-out kinds of logs, one block per log.

    It comes from windows that start at the measured motion. In a simulation of a whole log, a joint
    that sticks once too early stays at another position, and a single such log would decide.
    """
    own, without = other.left_out, now.near.left_out
    p_value = sign_flips(without - own, np.random.default_rng(0))
    better = float(np.mean(own < without))
    row = Looked(without_columns(term), own**2, p_value, better)
    return Look((row,), without**2, 0.0)


def _promising(
    found: Trace, now: Refined, courses: Sequence[Course], armature: float
) -> list[tuple[Fit, Array]]:
    """Models with one more effect whose simulated motion is nearest to the logs, best first.

    An effect is tried if it reduces the error to first order, either with the refined parameters or
    in the torque balance, with the coefficients found there, N m. The refined parameters alone are
    not enough: parameters that compensate for a missing effect must first return to their true
    values, as in the torque balance with the effect.
    """
    prepared, final = found.prepared, found.final
    objective = Objective(now.near.vector, courses, LONGEST_WINDOW_S, now.near.values)

    def squares(fitted: Fit) -> float:
        return float(np.sum(objective.soft(np.concatenate(objective.errors_of(fitted))) ** 2))

    before = squares(final)
    models = []
    screened = _first_order_gains(prepared, now, objective, armature)
    taken = {term.name for term, _ in screened}
    left_open: list[tuple[EffectTerm, Array | None]] = [
        (term, None) for term in _nearly_named(prepared, final) if term.name not in taken
    ]
    for term, coefficients in [*screened, *left_open]:
        fitted = refit(prepared, (*final.effects, term), final.shape, ROUGH)
        if not simulated_whole(fitted, armature, in_closed_loop=True):
            continue
        if coefficients is None:
            coefficients = fitted.term_coefficients(len(final.effects))
        models.append((1.0 - squares(fitted) / before, fitted, coefficients))
    models.sort(key=lambda model: -model[0])
    least = max(TIE, (1.0 - SMALLEST_GAIN) * models[0][0]) if models else 0.0
    return [(fitted, c) for gain, fitted, c in models[:ALTERNATIVES] if gain >= least]


def _nearly_named(prepared: Prepared, final: Fit) -> list[EffectTerm]:
    """Effects for which the torque balance gives evidence, but not enough to name them."""
    blocks = make_blocks(prepared, final)
    candidates = effects(prepared, final, blocks)
    if not candidates:
        return []
    seen, _ = look(final, blocks, candidates, np.random.default_rng(0))
    return [
        row.candidate.term
        for row in seen.rows
        if row.p_value <= SIGNIFICANCE and seen.gain(row) >= TIE
        if isinstance(row.candidate.term, EffectTerm)
    ]


def _first_order_gains(
    prepared: Prepared, now: Refined, objective: Objective, armature: float
) -> list[tuple[EffectTerm, Array]]:
    """Effects that reduce the squared error of the refined motion to first order, and their
    coefficients, N m."""
    x = now.near.values
    fitted = now.near.vector.fit(x)
    z = objective.units(x)
    r = objective(z)
    J = differences(objective, objective.bounds, z, r)
    e, n = objective.errors(z), len(r) - len(z)
    law, _ = np.linalg.qr(J)
    left = _without(law, r)
    best: dict[str, tuple[float, EffectTerm, Array]] = {}
    for term, moved, steps in _changed(prepared, fitted, armature):
        C = np.zeros((len(r), len(moved)))
        for column, other in zip(C.T, moved, strict=True):
            there = np.concatenate(objective.errors_of(other))
            column[:n] = objective.soft(there) - objective.soft(e)
        gain, change = _gain(left, _without(law, C))
        bounds = term.effect.bounds
        if any(low == 0.0 and c < 0.0 for (low, _), c in zip(bounds, change, strict=bool(bounds))):
            continue
        if gain > best.get(term.name, (TIE,))[0]:
            best[term.name] = gain, term, change * steps
    return [(term, coefficients) for _, term, coefficients in best.values()]


def _changed(
    prepared: Prepared, fitted: Fit, armature: float
) -> Iterator[tuple[EffectTerm, list[Fit], Array]]:
    """A fit for each coefficient of each effect on its grid, and the change of that coefficient, N
    m."""
    signals = signals_of(prepared, fitted)
    for term in effect_terms(prepared, signals, fitted.terms):
        pairs = list(zip(prepared.segments, signals, strict=True))
        columns = np.concatenate([term.columns(s, x) for s, x in pairs])
        size = np.sqrt(np.mean(columns**2, axis=0))
        if not np.all(np.isfinite(size)) or np.any(size == 0.0):
            continue
        # a difference moves the torque by 1% of its rms
        steps = rounded(0.01 * fitted.target_rms / size)
        moved = [with_term(prepared, fitted, term, step) for step in np.diag(steps)]
        if all(simulated_whole(f, armature, in_closed_loop=True) for f in moved):
            yield term, moved, steps


def _without(law: Array, X: Array) -> Array:
    """Columns after removing their projection on the orthonormal columns of the model."""
    return np.asarray(X - law @ (law.T @ X))


def _gain(r: Array, C: Array) -> tuple[float, Array]:
    """Fraction of r'r that columns C remove to first order, and the changes that do so."""
    change = np.asarray(np.linalg.lstsq(C, -r, rcond=1e-8)[0])
    return float(1.0 - np.sum((r + C @ change) ** 2) / np.sum(r**2)), change
