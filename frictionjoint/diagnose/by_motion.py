"""Effects that the simulated motion asks for, and the balance of torques is too rough to name.

The balance is of a narrow band and leaves out what the position does not determine; whole motions
in closed loop hold more. So after a refinement every effect is screened on the simulated motion of
the logs, to first order in its coefficients and in all numbers of the model, and the leaders are
fitted and refined with it. One is taken where logs are predicted clearly better by what was fitted
to other kinds of logs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.diagnose.closed_loop import Course
from frictionjoint.diagnose.drive import sign_flips
from frictionjoint.diagnose.finding import Finding, Trace
from frictionjoint.diagnose.intervals import stated_covariance
from frictionjoint.diagnose.library import Candidate, effect_terms, signals_of
from frictionjoint.diagnose.moves import Look, Looked
from frictionjoint.diagnose.replay import simulated_whole
from frictionjoint.diagnose.state import SMALLEST_GAIN
from frictionjoint.diagnose.trace import SIGNIFICANCE
from frictionjoint.identify.fit import Fit, refit
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed
from frictionjoint.refine.motion import WINDOW_S
from frictionjoint.refine.objective import Objective
from frictionjoint.refine.refine import Refined, refine
from frictionjoint.refine.secant import differences

# of the torque's rms, by which a coefficient moves it for a difference
_STEP = 0.01
# of the soft squares of the motion, that an effect must promise to be refined
_PROMISE = 0.1
# effects that are refined in a look, and looks
_LEADERS, _MOST_LOOKS = 2, 3


def named_by_motion(
    found: Trace,
    courses: Sequence[Course],
    armature: float,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[Trace, Refined]:
    """What was found with what the motion asks for besides, and its refinement.

    Args:
        found: by the balance. courses: of the logs it was found in. armature: of the MJCF.
    """
    now = _refined(found.prepared, found.final, courses, progress)
    if 0.5 ** len(courses) > SIGNIFICANCE:  # what so few logs say may as well be chance
        return found, now
    for _ in range(_MOST_LOOKS):
        progress("effects by motion")
        for term in _promising(found.prepared, now, courses, armature):
            fitted = refit(found.prepared, (*found.final.effects, term), found.final.shape)
            prepared, fitted = reweighed(found.prepared, fitted)
            other = _refined(prepared, fitted, courses, lambda text: None)
            told = _told(other, now)
            (row,) = told.rows
            gain = told.gain(row)
            progress(f"effects by motion: {term.name} gains {gain:.0%}, p {row.p_value:.3f}")
            if _clearly(told):
                break
        else:
            return found, now
        own = Finding(fitted.effects[-1], told, row, gain, (), (), fitted)
        findings = (*_moved(found.findings, fitted), own)
        found = replace(found, prepared=prepared, final=fitted, findings=findings)
        now = other
    return found, now


def _refined(
    prepared: Prepared, fitted: Fit, courses: Sequence[Course], progress: Callable[[str], None]
) -> Refined:
    return refine(prepared, fitted, stated_covariance(prepared, fitted), courses, progress)


def _told(other: Refined, now: Refined) -> Look:
    """What logs of kinds left out say of the effect that came last, a block a log."""
    term = other.fit.effects[-1]
    own, without = other.left_out[1], now.left_out[1]
    p_value = sign_flips(without - own, np.random.default_rng(0))
    better = float(np.mean(own < without))
    row = Looked(Candidate(term, np.zeros((0, 0))), own**2, p_value, better)
    return Look((row,), without**2, 0.0)


def _clearly(told: Look) -> bool:
    """Whether they are predicted better, by as much as the balance asks for."""
    (row,) = told.rows
    return row.p_value <= SIGNIFICANCE and told.gain(row) >= SMALLEST_GAIN


def _promising(
    prepared: Prepared, refined: Refined, courses: Sequence[Course], armature: float
) -> list[EffectTerm]:
    """Effects that would take most of the squares that the refined motion leaves, best first."""
    vector, x = refined.vector, refined.values
    fitted = vector.fit(x)
    objective = Objective(vector, courses, WINDOW_S, x)
    z = objective.units(x)
    r = objective(z)
    J = differences(objective, objective.bounds, z, r)
    e, n = objective.errors(z), len(r) - len(z)
    best: dict[str, tuple[float, EffectTerm]] = {}
    for term, moved in _changed(prepared, fitted, armature):
        C = np.zeros((len(r), len(moved)))
        for column, other in zip(C.T, moved, strict=True):
            there = np.concatenate(objective.errors_of(other))
            column[:n] = objective.soft(there) - objective.soft(e)
        gain = _gain(r, J, C, [low == 0.0 for low, _ in term.effect.bounds] or [False] * len(moved))
        if gain > best.get(term.name, (_PROMISE, term))[0]:
            best[term.name] = gain, term
    order = sorted(best.values(), key=lambda pair: -pair[0])
    return [term for _, term in order[:_LEADERS]]


def _changed(
    prepared: Prepared, fitted: Fit, armature: float
) -> Iterator[tuple[EffectTerm, list[Fit]]]:
    """Every effect on its grid that a simulation holds, with a fit for each coefficient moved."""
    signals = signals_of(prepared, fitted)
    for term in effect_terms(prepared, signals, fitted.terms):
        if not isinstance(term, EffectTerm):
            continue
        pairs = list(zip(prepared.segments, signals, strict=True))
        columns = np.concatenate([term.columns(s, x) for s, x in pairs])
        size = np.sqrt(np.mean(columns**2, axis=0))
        if not np.all(np.isfinite(size)) or np.any(size == 0.0):
            continue
        steps = np.diag(_STEP * fitted.target_rms / size)
        moved = [_with(prepared, fitted, term, step) for step in steps]
        if all(simulated_whole(f, armature) for f in moved):
            yield term, moved


def _with(prepared: Prepared, fitted: Fit, term: EffectTerm, coefficients: Array) -> Fit:
    """A fit with one effect more, of given coefficients, N m."""
    terms = (*fitted.terms, term)
    return replace(
        fitted,
        terms=terms,
        layout=layout_of(prepared, fitted.shape, terms),
        beta=np.concatenate([fitted.beta, coefficients / fitted.gain]),
    )


def _gain(r: Array, J: Array, C: Array, positive: Sequence[bool]) -> float:
    """Fraction of the squares r'r that columns C take besides J, to first order."""
    Q, _ = np.linalg.qr(J)
    left = r - Q @ (Q.T @ r)
    own = C - Q @ (Q.T @ C)
    change, *_ = np.linalg.lstsq(own, -left, rcond=1e-8)
    if any(least and c < 0.0 for least, c in zip(positive, change, strict=True)):
        return 0.0
    return float(1.0 - np.sum((left + own @ change) ** 2) / np.sum(left**2))


def _moved(findings: Sequence[Finding], fitted: Fit) -> tuple[Finding, ...]:
    """Findings with their terms as a later fit has them."""
    return tuple(replace(f, term=t) for f, t in zip(findings, fitted.effects, strict=False))
