"""What a shared cause would explain by chance, in the residuals of all joints together."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.chance import over_family
from frictionjoint.robot.stack import JointGram, Stack, joint_gram

COUNT, LENGTH, JOINTS, FOLDS = 60, 20, 2, 4
N = COUNT * LENGTH
OF_BLOCK = np.repeat(np.arange(COUNT), LENGTH)
CLOCK = SimpleNamespace(
    fold=np.arange(COUNT) * FOLDS // COUNT, log=np.zeros(COUNT, dtype=np.int64), count=COUNT
)
SPEED = np.cumsum(np.random.default_rng(5).standard_normal(N))
LAW = np.column_stack([np.ones(N), SPEED])
FREE = np.zeros((0, 2))


def curves(k, rng):
    """Smooth columns."""
    return np.cumsum(rng.standard_normal((N, k)), axis=0) / np.sqrt(N)


def stack_of(columns, residuals):
    """Joints that have all columns, each with a residual of its own."""
    at = np.arange(columns.shape[1])
    grams = [joint_gram(LAW, columns, e, OF_BLOCK, COUNT) for e in residuals]
    rest = at, 1.0, 1.0, np.zeros(COUNT)
    joints = [JointGram(f"j{i}", N, G, *rest) for i, G in enumerate(grams)]
    return Stack(joints, CLOCK, np.zeros(len(at)), np.zeros(len(at)))


def least_p(stack, sets, seed):
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], (399, COUNT))
    known = np.zeros(0, dtype=np.int64)
    return over_family(np.array([stack.surprise(at, known, FREE, signs) for at in sets])).min()


@pytest.mark.parametrize("window", [1, LENGTH])
def test_chance_that_reaches_into_the_next_block_is_seldom_significant(window):
    rng = np.random.default_rng(4)
    columns = curves(6, rng)
    sets = [np.arange(1), np.arange(1, 3), np.arange(3, 6)]
    found = []
    for seed in range(100):
        noise = rng.standard_normal((JOINTS, N + window - 1))
        residuals = [np.convolve(e, np.ones(window) / np.sqrt(window), "valid") for e in noise]
        found.append(least_p(stack_of(columns, residuals), sets, seed))
    # 5 of 100, and four standard errors; 21 where blocks as long as the window count as independent
    assert np.mean(np.array(found) < 0.05) < 0.14


def test_a_cause_of_many_numbers_that_is_there_is_no_chance():
    rng = np.random.default_rng(6)
    columns = curves(COUNT // 2, rng)
    size = rng.standard_normal(columns.shape[1])
    residuals = [columns @ size + 0.1 * rng.standard_normal(N) for _ in range(JOINTS)]
    assert least_p(stack_of(columns, residuals), [np.arange(len(size))], 0) < 0.01
