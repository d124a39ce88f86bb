"""The kernel against the independent reference and against Jenkins elements."""

import dataclasses
from collections import Counter

import numpy as np
import pytest
from reference.continuous import continuous_torque
from reference.integrated_solver import reference_torque
from reference.jenkins import jenkins_torque
from reference.motions import random_motion, random_parameters, violent_motion
from test_reference import KNOTS, masing

from frictionjoint import friction_torque
from frictionjoint.parameters import FrictionParameters

MOTIONS = 100


def agreed(p, time, position):
    """Events along a motion on which both torques agree."""
    wanted, events = reference_torque(p, time, position)
    got = friction_torque(p, time, position)
    assert np.abs(got - wanted).max() <= 1e-6 * max(p.Fs_pos, p.Fs_neg), p
    return events


def test_random_motions_agree_and_reach_every_mechanism():
    total = Counter()
    for i in range(MOTIONS):
        rng = np.random.default_rng([0, i])
        p = random_parameters(rng)
        total += agreed(p, *random_motion(rng, p))
    assert total["reversal"] > 10 * MOTIONS
    assert total["closing"] > 2.5 * MOTIONS
    assert total["reset"] > 1.5 * MOTIONS
    assert total["several_closings_in_one_step"] > 0.25 * MOTIONS


def test_steps_of_fifteen_decades_agree():
    """1e-12 to 1e3 rad a step; without the terms in v, which dwarf Fh at 1e9 rad/s."""
    total = Counter()
    for i in range(MOTIONS):
        rng = np.random.default_rng([1, i])
        p = dataclasses.replace(random_parameters(rng), sigma1=0, sigma2_pos=0, sigma2_neg=0)
        total += agreed(p, *violent_motion(rng))
    assert min(total["reversal"], total["closing"], total["reset"]) > MOTIONS


def test_nested_loops_equal_jenkins_elements():
    for seed in range(20):
        turns = np.append(0.0, np.random.default_rng(seed).uniform(-2.2e-5, 2.2e-5, 60))
        position = np.interp(np.linspace(0.0, 60.0, 2401), np.arange(61), turns)
        wanted = jenkins_torque(KNOTS, position)
        assert 0.5 * 5.0 < np.abs(wanted).max() < 0.9 * 5.0
        got = friction_torque(masing(), np.arange(2401) * 0.01, position)
        assert np.abs(got - wanted).max() <= 1e-6 * 5.0


def test_torque_far_above_the_level_at_a_large_exponent_relaxes_without_overflow():
    """Fs / Fc of 333 and n = 730: r**n is beyond the largest double, the answer is not."""
    p = FrictionParameters.symmetric(
        Fs=5.0, Fc=0.015, Vs=3e-5, n=730, knots=KNOTS, variant="lampaert2002"
    )
    found = friction_torque(p, [0, 100, 100.000001], [0, 5e-5, 5e-5 + 1e-9])
    assert np.all(np.abs(found) <= 5.0)


@pytest.mark.parametrize("variant", ["ganseman1997", "lampaert2002"])
@pytest.mark.parametrize("n", [1.0, 2.0, 6.0])
def test_sampled_smooth_motion_converges_in_second_order_to_continuous_time(n, variant):
    """The motion is linear and S constant over a step: the error falls with its square."""
    p = FrictionParameters.symmetric(Fs=5.0, Fc=3.0, Vs=0.01, n=n, knots=KNOTS, variant=variant)
    samples = np.linspace(0.0, 2.0, 251)
    wanted = continuous_torque(p, lambda t: 8.4e-3 * np.cos(7 * t), samples)
    errors = []
    for m in (1000, 2000, 4000, 8000):
        t = np.linspace(0.0, 2.0, m + 1)
        found = friction_torque(p, t, 1.2e-3 * np.sin(7 * t))[:: m // 250]
        errors.append(np.abs(found - wanted).max() / 5.0)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 5e-5
    assert orders.min() > 1.5
    assert np.log2(errors[0] / errors[-1]) / 3 > 1.8
