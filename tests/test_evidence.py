"""What the evidence of a candidate means: gains and p-values against their definitions."""

from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.diagnose import chance
from frictionjoint.diagnose.gram import screen
from frictionjoint.diagnose.library import Candidate
from frictionjoint.diagnose.moves import look
from frictionjoint.diagnose.score import scored
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.signals import N_SIGNALS, A, Q, V
from frictionjoint.identify import blocks as blocking
from frictionjoint.identify.blocks import Blocks, correlation_time, make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.noise import Noise
from frictionjoint.identify.segment import Band, Prepared, Segment
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm

BLOCKS, LENGTH, FOLDS = 60, 20, 4
N = BLOCKS * LENGTH
NAMES = ("torque-bias", "spring", "gravity-error", "inertia-error", "load-dependent")
TERMS = [
    EffectTerm(next(e for e in CATALOGUE if e.name == name), shape)
    for name, shape in zip(NAMES, [(), (), (), (), (1e-3,)], strict=True)
]


def blocks():
    of_sample = np.arange(N) // LENGTH
    block = np.arange(BLOCKS)
    log = np.zeros(BLOCKS, dtype=int)
    return Blocks(of_sample, block % FOLDS, (block // FOLDS) % 2, log, np.zeros(1))


def fitted(y, X, weight=None):
    """Weighted least squares of a law of three columns."""
    weight = np.ones(N) if weight is None else weight
    beta = np.linalg.lstsq(X * weight[:, None], y * weight, rcond=None)[0]
    return Fit(
        shape=INTEGRATED[0], terms=(), drive="torque", beta=beta, gain=1.0,
        layout=Layout(("sigma2", "Fc", "sigma1"), (), ()), residual=y - X @ beta, jacobian=X,
        weight=weight, bound=np.zeros(3, dtype=bool),
        low=np.full(3, -np.inf), high=np.full(3, np.inf), log_index=np.zeros(N, dtype=int),
        begun=np.zeros((N, 0)), target_rms=1.0,
    )  # fmt: skip


def candidates(rng, names=None):
    return [Candidate(t, rng.standard_normal((N, len(t.coefficients)))) for t in TERMS[:names]]


@pytest.mark.parametrize("weighting", [False, True])
def test_a_gain_is_what_coefficients_of_other_folds_take_from_a_fold(weighting):
    rng = np.random.default_rng(0)
    X, found = rng.standard_normal((N, 3)), candidates(rng)
    y = X @ [1.0, 2.0, 0.1] + 0.4 * found[1].columns[:, 0] + rng.standard_normal(N)
    w = rng.uniform(0.1, 1.0, N) if weighting else np.ones(N)
    fit = fitted(y, X, w)
    seen, _ = look(fit, blocks(), found, np.random.default_rng(1))

    Xw = X * w[:, None]
    of_fold = blocks().fold[blocks().of_sample]

    def freed(Z):
        return Z - Xw @ np.linalg.lstsq(Xw, Z, rcond=None)[0]

    target = freed(y * w)
    for row in seen.rows:
        Z = freed(row.candidate.columns * w[:, None])
        left = target.copy()
        for fold in range(FOLDS):
            inside = of_fold == fold
            left[inside] -= Z[inside] @ np.linalg.lstsq(Z[~inside], target[~inside], rcond=None)[0]
        expected = 1.0 - np.sum(left**2) / np.sum(target**2)
        assert seen.gain(row) == pytest.approx(expected, abs=1e-9)
    assert seen.rows[0].name == NAMES[1]
    assert scored(fit, blocks()).total == pytest.approx(np.sum(target**2))


def test_chance_calls_no_more_than_it_may_over_the_whole_family(monkeypatch):
    """Noise with memory of a third of a block, five candidates: one call in twenty logs."""
    monkeypatch.setattr(chance, "FLIPS", 199)
    monkeypatch.setattr(blocking, "_HALVES", 2)
    rng = np.random.default_rng(2)
    called = 0
    for _ in range(120):
        white = rng.standard_normal(N + 6)
        noise = np.convolve(white, np.ones(7) / np.sqrt(7.0), "valid")
        X = rng.standard_normal((N, 3))
        seen, _ = look(fitted(noise, X), blocks(), candidates(rng), rng)
        called += min(r.p_value for r in seen.rows) <= 0.05
    # 6 on average; more than 13 once in two hundred times
    assert 1 <= called <= 13


def test_a_true_effect_is_no_chance_and_leads_on_half_of_the_data():
    rng = np.random.default_rng(3)
    X, found = rng.standard_normal((N, 3)), candidates(rng)
    y = 0.5 * found[3].columns[:, 0] + rng.standard_normal(N)
    seen, _ = look(fitted(y, X), blocks(), found, rng)
    first, *others = seen.rows
    assert first.name == "inertia-error"
    assert first.p_value <= 0.002
    assert first.frequency > 0.95
    assert all(row.p_value > 0.01 for row in others)


def test_what_acts_in_one_fold_alone_is_tested_on_its_halves():
    rng = np.random.default_rng(4)
    X, (candidate,) = rng.standard_normal((N, 3)), candidates(rng, 1)
    inside = blocks().fold[blocks().of_sample] == 2
    columns = candidate.columns * inside[:, None]
    y = 3.0 * columns[:, 0] + rng.standard_normal(N)
    seen, _ = look(fitted(y, X), blocks(), [Candidate(candidate.term, columns)], rng)
    # nine squares to one in a quarter of the samples
    assert seen.gain(seen.rows[0]) == pytest.approx(9.0 / 13.0, abs=0.1)


def test_what_the_law_knows_is_no_effect():
    rng = np.random.default_rng(5)
    X = rng.standard_normal((N, 3))
    columns = X[:, :1] + 1e-7 * rng.standard_normal((N, 1))
    y = X @ [1.0, 2.0, 0.1] + rng.standard_normal(N)
    found = screen(fitted(y, X), blocks(), [Candidate(TERMS[0], columns)])
    without, _ = found.held_out(found.terms)
    with_it, _ = found.held_out([*found.terms, found.candidates[0]])
    assert with_it.sum() > 0.98 * without.sum()


def test_what_another_law_would_explain_speaks_for_no_effect():
    """A candidate that resembles the law's own error; an effect beside an error larger than it."""
    rng = np.random.default_rng(8)
    X, found = rng.standard_normal((N, 3)), candidates(rng)
    error = 2.0 * rng.standard_normal(N)
    alike = Candidate(found[2].term, 0.5 * (error + 0.2 * rng.standard_normal(N))[:, None])
    y = error + 0.8 * found[1].columns[:, 0] + 0.2 * rng.standard_normal(N)
    fit, tried = fitted(y, X), [found[1], alike]

    def rows(law_errors):
        known = replace(blocks(), law_errors=law_errors)
        seen, _ = look(fit, known, tried, np.random.default_rng(1))
        return {row.name: (seen.gain(row), row.p_value) for row in seen.rows}

    blind, seeing = rows(None), rows(error[:, None])
    assert blind[NAMES[1]][0] < 0.3
    assert blind[NAMES[2]][0] > 0.7
    assert seeing[NAMES[1]][0] > 0.9
    assert seeing[NAMES[1]][1] <= 0.002
    assert seeing[NAMES[2]][0] < 0.05


def test_what_a_log_held_when_it_began_is_known_on_all_data():
    """An effect that begins in motion is seen at its size, and its beginning alone is none."""
    rng = np.random.default_rng(6)
    X, (candidate,) = rng.standard_normal((N, 3)), candidates(rng, 1)
    # it fades in the first block, which so is the only one that can tell of it
    begun = np.exp(-np.arange(N) / 8.0)[:, None]
    noise = rng.standard_normal(N)
    alone = Candidate(candidate.term, candidate.columns)
    together = Candidate(candidate.term, candidate.columns, begun=begun)
    of_both = 2.0 * candidate.columns[:, 0] + 60.0 * begun[:, 0] + noise
    seen, _ = look(fitted(of_both, X), blocks(), [together], np.random.default_rng(7))
    total, left = float(np.sum(of_both**2)), float(seen.rows[0].left.sum())
    assert left == pytest.approx(float(np.sum(noise**2)), rel=0.05)
    assert seen.gain(seen.rows[0]) == pytest.approx(1.0 - left / total, abs=0.05)
    assert seen.rows[0].p_value <= 0.002
    blind, _ = look(fitted(of_both, X), blocks(), [alone], np.random.default_rng(7))
    assert float(blind.rows[0].left.sum()) > 3.0 * left
    nothing, _ = look(fitted(noise + 60.0 * begun[:, 0], X), blocks(), [together], rng)
    assert nothing.rows[0].p_value > 0.01


def test_a_coefficient_on_its_bound_still_acts():
    """Squares predicted of a fold hold what a term on its bound explains of it."""
    rng = np.random.default_rng(8)
    X, (candidate,) = rng.standard_normal((N, 3)), candidates(rng, 1)
    column = candidate.columns[:, 0]
    y = 2.0 * column + 0.1 * rng.standard_normal(N)
    fit = fitted(y, np.column_stack([X, column]))
    at_most = np.array([0.0, 0.0, 0.0, 1.8])
    held = replace(
        fit,
        terms=(TERMS[0],), layout=Layout(("sigma2", "Fc", "sigma1"), (), (TERMS[0],)),
        beta=at_most, residual=y - 1.8 * column, bound=np.array([False, False, False, True]),
        low=np.full(4, -np.inf), high=np.array([np.inf, np.inf, np.inf, 1.8]),
    )  # fmt: skip
    assert scored(held, blocks()).total == pytest.approx(np.sum((0.2 * column) ** 2), rel=0.5)


def motion(seed, n=3000):
    """A log of sines at two speeds, as it is prepared."""
    rng = np.random.default_rng(seed)
    signals = np.zeros((n, N_SIGNALS))
    t = 0.02 * np.arange(n)
    for f in (0.1, 0.5):
        w, phase = 2.0 * np.pi * f, rng.uniform(0.0, 6.28)
        signals[:, Q] += np.sin(w * t + phase)
        signals[:, V] += w * np.cos(w * t + phase)
        signals[:, A] -= w * w * np.sin(w * t + phase)
    every = np.ones(n, dtype=bool)
    noise = Noise(0.0, np.zeros(1), np.zeros(1), 0.0, 0.0)
    return Segment(
        f"log{seed}", 0.02, 10.0, 1, signals, np.zeros(n), every, every, {}, noise, 0.02, 20.0
    )


@pytest.mark.parametrize("logs", [1, 2, 3, 5])
def test_blocks_cut_logs_in_time_and_folds_are_of_unlike_motion(logs):
    segments = tuple(motion(seed) for seed in range(logs))
    prepared = Prepared(segments, "joint", False, "torque", Band(10.0, 20.0))
    n = prepared.samples
    rng = np.random.default_rng(0)
    fit = Fit(
        shape=INTEGRATED[0], terms=(), drive="torque", beta=np.zeros(1), gain=1.0,
        layout=Layout(("Fc",), (), ()), residual=rng.standard_normal(n),
        jacobian=np.ones((n, 1)), weight=np.ones(n), bound=np.zeros(1, dtype=bool),
        low=np.full(1, -np.inf), high=np.full(1, np.inf),
        log_index=np.repeat(np.arange(logs), len(segments[0].drive)),
        begun=np.zeros((logs * len(segments[0].drive), 0)), target_rms=1.0,
    )  # fmt: skip
    found = make_blocks(prepared, fit)
    assert 40 <= found.count <= 250
    assert np.all(np.diff(found.of_sample) >= 0)
    assert np.array_equal(np.unique(found.of_sample), np.arange(found.count))
    assert np.array_equal(found.log[found.of_sample], fit.log_index)
    if logs >= 3:
        assert np.array_equal(found.fold, found.log)
        return
    v = np.concatenate([s.signals[:, V] for s in segments])
    speed = np.sqrt(np.bincount(found.of_sample, v**2) / np.bincount(found.of_sample))
    assert 2 <= len(np.unique(found.fold)) <= 4
    within = np.mean([np.var(speed[found.fold == k]) for k in np.unique(found.fold)])
    assert within < 0.7 * np.var(speed)


def test_the_correlation_time_of_a_moving_average_is_known():
    white = np.random.default_rng(0).standard_normal(200_000)
    # triangle of the autocorrelation: sums to the number averaged
    averaged = np.convolve(white, np.ones(10), "valid")
    assert correlation_time(averaged) == pytest.approx(10.0, rel=0.1)
    assert correlation_time(white) == pytest.approx(1.0, abs=0.05)
