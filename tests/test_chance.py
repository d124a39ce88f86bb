"""What a candidate would explain by chance: a p-value is one, and a real effect has a small one."""

import itertools

import numpy as np
import pytest

from frictionjoint.diagnose.chance import p_values
from frictionjoint.diagnose.gram import Screen
from frictionjoint.identify.blocks import Blocks

COUNT, LENGTH, FOLDS = 60, 20, 4
N = COUNT * LENGTH
RNG = np.random.default_rng(5)
SLOW = np.cumsum(RNG.standard_normal(N))


def hats(x, k=7):
    """A curve's columns: linear between points of which the outer ones are seldom reached."""
    points = np.linspace(x.min(), x.max(), k)
    return np.maximum(0.0, 1.0 - np.abs(x[:, None] - points) * (k - 1) / np.ptp(x))


CURVE = hats(SLOW)
SELDOM = (np.arange(N) % 600 < 40).astype(float)[:, None]
WHOLE = np.sin(0.1 * np.arange(N))[:, None]
KINDS = {"curve": CURVE, "seldom": SELDOM, "whole": WHOLE}


def screen_of(sets, residual, low=-np.inf):
    """Candidates against a residual; nothing else is in the model."""
    of_sample = np.repeat(np.arange(COUNT), LENGTH)
    fold = np.arange(COUNT) * FOLDS // COUNT
    halves = np.arange(COUNT) % 2
    blocks = Blocks(of_sample, fold, halves, np.zeros(COUNT, dtype=np.int64))
    X = np.hstack(sets)
    columns = np.asfortranarray(np.column_stack([X / np.linalg.norm(X, axis=0), residual]))
    edges = np.cumsum([0, *(s.shape[1] for s in sets)])
    candidates = tuple(np.arange(a, b) for a, b in itertools.pairwise(edges))
    c = X.shape[1]
    return Screen(
        blocks, columns, columns, columns, np.full(c, low), np.full(c, np.inf),
        np.zeros(c, dtype=bool), (), candidates,
    )  # fmt: skip


def p_of(sets, residual, low=-np.inf, seed=0):
    found, _ = p_values(
        screen_of(sets, residual, low), [1.0] * len(sets), np.random.default_rng(seed)
    )
    return found


def least_by_chance(sets):
    rng = np.random.default_rng(1)
    return np.array([p_of(sets, rng.standard_normal(N), seed=i).min() for i in range(100)])


@pytest.mark.parametrize("kinds", [*([kind] for kind in KINDS), list(KINDS)])
def test_chance_is_seldom_significant_and_that_of_a_family_uniform(kinds):
    # 5 of 100, and three standard errors; the p-value of a candidate alone is too large
    found = least_by_chance([KINDS[kind] for kind in kinds])
    assert np.mean(found < 0.05) < 0.12
    assert len(kinds) == 1 or 0.35 < np.mean(found < 0.5) < 0.65


def test_chance_that_reaches_into_the_next_block_is_seldom_significant():
    rng, window = np.random.default_rng(4), np.ones(12) / np.sqrt(12.0)
    sets = list(KINDS.values())
    noise = [np.convolve(rng.standard_normal(N + 11), window, "valid") for _ in range(100)]
    found = np.array([p_of(sets, e, seed=i).min() for i, e in enumerate(noise)])
    assert np.mean(found < 0.05) < 0.12


@pytest.mark.parametrize("kind", KINDS)
def test_an_effect_of_the_size_of_the_noise_is_beyond_chance(kind):
    rng = np.random.default_rng(2)
    columns = KINDS[kind]
    acts = columns @ np.linspace(1.0, 2.0, columns.shape[1])
    p = p_of([columns, *(x for k, x in KINDS.items() if k != kind)], acts + rng.standard_normal(N))
    assert p[0] < 0.01


def test_a_sign_that_is_impossible_is_no_surprise():
    residual = -WHOLE[:, 0] + 0.5 * np.random.default_rng(3).standard_normal(N)
    assert p_of([WHOLE], residual)[0] < 0.01
    assert p_of([WHOLE], residual, low=0.0)[0] > 0.5
