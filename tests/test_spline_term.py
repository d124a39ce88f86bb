"""The cubic spline of an unnamed dependence."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from frictionjoint.identify.smooth import SplineTerm


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
