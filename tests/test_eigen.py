"""Eigenvalues where LAPACK's divide and conquer does not converge."""

import numpy as np
import pytest

from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import pseudo_inverse


@pytest.fixture
def unconverged(monkeypatch):
    def fails(A):
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    monkeypatch.setattr(np.linalg, "eigh", fails)


@pytest.mark.parametrize("shape", [(4, 4), (3, 4, 4), (2, 3, 4, 4)])
def test_another_way_gives_the_same(unconverged, shape):
    half = np.random.default_rng(0).normal(size=shape)
    A = half @ np.swapaxes(half, -1, -2)
    values, vectors = eigh(A)
    assert values.shape == shape[:-1]
    np.testing.assert_allclose((vectors * values[..., None, :]) @ np.swapaxes(vectors, -1, -2), A)
    np.testing.assert_allclose(
        pseudo_inverse(A, 1e-12) @ A, np.broadcast_to(np.eye(4), shape), atol=1e-6
    )
