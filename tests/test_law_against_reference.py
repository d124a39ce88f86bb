"""The kernel against the independent reference; that against quadrature and Jenkins elements."""

import dataclasses
from collections import Counter

import numpy as np
import pytest
from reference.continuous import continuous_torque
from reference.integrated_solver import reference_torque
from reference.motions import random_motion, random_parameters, violent_motion
from reference.relaxation import advance, span
from scipy.integrate import quad

from frictionjoint import friction_torque
from frictionjoint.law import relaxation
from frictionjoint.parameters import FrictionParameters

MOTIONS = 100
KNOTS = ((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))


def masing(**others):
    return FrictionParameters.symmetric(
        Fs=5.0, Fc=5.0, Vs=0.01, n=200.0, knots=KNOTS, virgin="masing", **others
    )


def jenkins_torque(knots, position) -> np.ndarray:
    """Torque, N m, of parallel Jenkins elements equal to a Masing curve Fd(2z)/2.

    Stiffness drops of Fd at each knot, yield at z_i / 2.
    """
    z = np.array([k[0] for k in knots])
    F = np.array([k[1] for k in knots])
    slopes = np.diff(np.concatenate(([0.0], F))) / np.diff(np.concatenate(([0.0], z)))
    stiffness = slopes - np.concatenate((slopes[1:], [0.0]))
    limit = z / 2
    limit[-1] = np.inf  # the last slope goes on
    stretch = np.zeros(len(z))
    torque = np.zeros(len(position))
    for k in range(1, len(position)):
        stretch = np.clip(stretch + position[k] - position[k - 1], -limit, limit)
        torque[k] = float(stiffness @ stretch)
    return torque


@pytest.mark.parametrize("n", [1.0, 1.7, 4.0, 50.0])
@pytest.mark.parametrize(("r0", "r1"), [(0.0, 0.9), (-1.8, 0.5), (-0.4, -0.1), (1.6, 1.05)])
def test_span_is_the_integral_and_advance_its_inverse(n, r0, r1):
    wanted = quad(
        lambda r: 1 / (1 - np.sign(r) * abs(r) ** n),
        r0,
        r1,
        epsabs=1e-13,
        limit=400,
        points=[x for x in (-1.0, 0.0) if r0 < x < r1] or None,
    )[0]
    assert span(r0, r1, n) == pytest.approx(wanted, rel=1e-9)
    assert advance(r0, span(r0, r1, n), n) == pytest.approx(r1, rel=1e-10)


@pytest.mark.parametrize("n", [1.5, 3.0, 3.5, 7.5, 20.0, 60.0])
def test_the_kernel_follows_the_same_flow(n):
    for r, a in np.random.default_rng(5).uniform((-1.2, 1e-3), (1.05, 0.5), (99, 2)):
        for start in (r, 1.0 + (r - 1.0) / (9.0 * n)):
            assert relaxation.advance(start, a, n) == pytest.approx(advance(start, a, n), abs=1e-9)


def test_reference_equals_jenkins_elements_below_nine_tenths_of_breakaway():
    turns = np.array([0, 2.2, -1.0, 1.4, -0.4, 0.9, 0.1, 1.9, -1.8, 2.3, 0.3]) * 1e-5
    position = np.interp(np.linspace(0, 10, 201), np.arange(11), turns)
    wanted = jenkins_torque(KNOTS, position)
    assert np.abs(wanted).max() < 0.9 * 5.0
    got, events = reference_torque(masing(), np.arange(201) * 0.01, position)
    assert np.abs(got - wanted).max() <= 1e-6 * 5.0
    assert events["closing"] >= 4


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
