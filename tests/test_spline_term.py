"""The cubic spline of an unnamed dependence."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import BSpline

from frictionjoint.effects.signals import N_SIGNALS
from frictionjoint.identify.smooth import VARIABLES, SplineTerm


def test_its_columns_are_cubic_b_splines_of_uniform_knots_but_for_the_last():
    low, high, pieces = -1.3, 2.1, 5
    term = SplineTerm("position", low, high, pieces=pieces)
    x = np.linspace(low - 1.0, high + 1.0, 301)
    width = (high - low) / pieces
    knots = low + width * np.arange(-3, pieces + 4)
    inside = np.clip(x, low, high - 1e-12)  # constant beyond its ends
    expected = BSpline.design_matrix(inside, knots, 3).toarray()
    assert term._basis(x) == pytest.approx(expected[:, :-1], abs=1e-10)
    assert len(term.coefficients) == pieces + 2


@pytest.mark.parametrize("variable", ["velocity", "load"])
def test_beside_the_models_own_multiple_of_the_quantity_a_curve_holds_no_bias(variable):
    rng = np.random.default_rng(3)
    signals = np.zeros((2000, N_SIGNALS))
    # the joint ends elsewhere than it began, so the mean is not zero
    x = 0.3 + np.sin(np.linspace(0.0, 40.0, 2000)) + 0.1 * rng.standard_normal(2000)
    signals[:, VARIABLES[variable]] = x
    segment = SimpleNamespace(signals=signals, mask=rng.random(2000) < 0.9, others={})
    curve = SplineTerm(variable, *np.quantile(x, (0.005, 0.995))).centred([segment], [signals])
    known = np.column_stack([curve.columns(segment, signals), x])[segment.mask]
    one = np.ones(len(known))
    explained = known @ np.linalg.lstsq(known, one, rcond=1e-10)[0]
    # the part of a constant that the multiple alone has
    alone = np.sum(known[:, -1]) ** 2 / np.sum(known[:, -1] ** 2)
    assert np.sum(explained**2) == pytest.approx(alone, rel=0.05)
