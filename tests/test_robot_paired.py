"""The paired interval of an error's increase: narrow for what both have, honest about blocks."""

import numpy as np
import pytest
from scipy.signal import lfilter

from frictionjoint.replay.free_runs import Replay
from frictionjoint.robot import explain
from frictionjoint.robot.paired import error_increase, replay_increase

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


def test_runs_are_blocks():
    rng = np.random.default_rng(2)
    before = rng.uniform(1.0, 5.0, 30)
    low, high = replay_increase(before, before * rng.uniform(1.1, 1.3, 30))
    assert 0.0 < low < high
    low, high = replay_increase(before, rng.permutation(before))
    assert low < 0.0 < high


def test_a_log_that_is_simulated_whole_is_compared_along_its_time():
    def increase(errors: np.ndarray) -> tuple[float, float]:
        first, then = (Replay((x,), 10.0) for x in (before, errors))
        return explain._replay_increase((first, first), (then, then))

    before = slow_noise(np.random.default_rng(3))
    low, high = increase(1.2 * before)
    assert 0.0 < low < 0.2 < high
    low, high = increase(slow_noise(np.random.default_rng(4)))
    assert low < 0.0 < high


@pytest.mark.parametrize("errors", [np.ones(1), np.zeros(5)])
def test_what_cannot_be_told_is_open(errors):
    assert replay_increase(errors, errors) == (-np.inf, np.inf)
