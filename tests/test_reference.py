"""The reference itself: against quadrature, Jenkins elements, and with a mechanism broken."""

import numpy as np
import pytest
from reference.integrated_solver import reference_torque
from reference.jenkins import jenkins_torque
from reference.relaxation import advance, span
from scipy.integrate import quad

from frictionjoint.law import relaxation
from frictionjoint.parameters import FrictionParameters

KNOTS = ((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0))


def masing(**others):
    return FrictionParameters.symmetric(
        Fs=5.0, Fc=5.0, Vs=0.01, n=200.0, knots=KNOTS, virgin="masing", **others
    )


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
