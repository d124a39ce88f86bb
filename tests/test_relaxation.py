"""The flow of dr/da = 1 - sgn(r) |r|**n against quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad

from frictionjoint.law.relaxation import advance, distance, rate

EXPONENTS = [1.0, 1.3, 2.0, 2.5, 3.0, 4.0, 7.0, 50.0]
PAIRS = [
    (0.0, 0.3),
    (0.1, 0.7),
    (0.6, 0.9),
    (0.2, 0.999),
    (-0.3, -0.1),
    (-1.7, -0.2),
    (-2.0, 0.8),
    (-0.8, 0.2),
    (3.0, 1.5),
    (1.4, 1.001),
]


def slope(r, n):
    return 1 - np.sign(r) * abs(r) ** n


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize(("r0", "r1"), PAIRS)
def test_distance_is_the_integral_and_advance_its_inverse(n, r0, r1):
    inside = [x for x in (-1.0, -0.5, 0.0) if r0 < x < r1]
    wanted = quad(
        lambda r: 1 / slope(r, n),
        r0,
        r1,
        points=inside or None,
        epsabs=1e-14,
        epsrel=1e-12,
        limit=500,
    )[0]
    a = distance(r0, r1, n)
    assert a == pytest.approx(wanted, rel=1e-8)
    assert advance(r0, a, n) == pytest.approx(r1, rel=1e-8)
    assert rate(r0, n) == pytest.approx(slope(r0, n), rel=1e-12)


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("r0", [-0.9, 0.0, 0.15, 0.6, 1.5])
def test_small_steps_add_up(n, r0):
    r = r0
    for _ in range(40):
        r = advance(r, 0.2 / n / 40, n)
    assert r == pytest.approx(advance(r0, 0.2 / n, n), rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("r0", [-0.9, 0.3, 1.5, 4.0])
def test_long_way_ends_at_sliding_and_stays(n, r0):
    assert advance(r0, 1e6, n) == pytest.approx(1.0, rel=1e-14)
    assert advance(1.0, 5.0, n) == 1.0
    assert distance(r0, 1.0, n) == np.inf
    assert distance(1.0, 0.5, n) == distance(1.0, 2.0, n) == np.inf
