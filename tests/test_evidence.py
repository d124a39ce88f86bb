"""What the evidence of a candidate means: gains and p-values against their definitions."""

from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.moves import look
from frictionjoint.diagnose.score import scored
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.layout import Layout
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
    return Blocks(of_sample, block % FOLDS, (block // FOLDS) % 2, log)


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


def candidates(rng):
    return [Candidate(t, rng.standard_normal((N, len(t.coefficients)))) for t in TERMS]


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
