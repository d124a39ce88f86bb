"""The paired interval of an error's increase: narrow for what both have, honest about blocks."""

import numpy as np
from scipy.signal import lfilter

from frictionjoint.robot.explain import error_increase

N, LOGS = 4000, 2


def slow_noise(rng: np.random.Generator) -> np.ndarray:
    """Unit noise correlated over some tens of samples."""
    e = lfilter([1.0], [1.0, -0.95], rng.normal(size=N))
    return np.asarray(e / e.std())


def log_index() -> np.ndarray:
    return np.repeat(np.arange(LOGS), N // LOGS)


def test_errors_that_differ_by_chance_are_seldom_told_apart():
    beyond = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        both = slow_noise(rng)
        before, after = (both + 0.3 * slow_noise(rng) for _ in range(2))
        low, high = error_increase(before, after, log_index())
        beyond += not low <= 0.0 <= high
    assert beyond <= 8


def test_a_small_increase_shows_that_each_error_alone_hides():
    rng = np.random.default_rng(1)
    before = slow_noise(rng)
    after = before + 0.3 * slow_noise(rng)
    low, high = error_increase(before, after, log_index())
    rise = np.sqrt(np.mean(after**2)) - np.sqrt(np.mean(before**2))
    assert low < rise < high
    assert high - low < 0.1
