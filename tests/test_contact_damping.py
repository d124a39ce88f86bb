"""Damping of a contact belongs to its level: where a fit finds no level there is no damping."""

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.identify.search import Search
from frictionjoint.identify.shape import INTEGRATED


@pytest.fixture(scope="module")
def search(tmp_path_factory) -> Search:
    return Search(
        prepared_logs(PENDULUM, tmp_path_factory.mktemp("pendulum"), 1), (), INTEGRATED[0]
    )


def found(search: Search, monkeypatch, Fc: float, sigma1: float) -> dict[str, float]:
    """Coefficients fitted to a torque that the law makes with these two, and 0.1 N m s/rad."""
    X, _ = search.balance.columns(search.law, search.terms)
    true = {"Fc": Fc, "sigma1": sigma1, "sigma2": 0.1}
    y = X @ np.array([true.get(name, 0.0) for name in search.layout.names[search.layout.linear]])
    monkeypatch.setattr(search.balance, "columns", lambda *arguments: (X, y))
    monkeypatch.setattr(search, "_last", None)
    beta = search.solved(search.start).beta
    return dict(zip(search.layout.base, beta, strict=False))


def test_a_contact_with_a_level_may_have_damping(search, monkeypatch):
    beta = found(search, monkeypatch, Fc=0.5, sigma1=2.0)
    assert beta["Fc"] == pytest.approx(0.5, rel=1e-6)
    assert beta["sigma1"] == pytest.approx(2.0, rel=1e-6)


def test_without_a_level_there_is_no_damping(search, monkeypatch):
    beta = found(search, monkeypatch, Fc=-0.5, sigma1=20.0)
    assert beta["Fc"] == pytest.approx(0.0, abs=1e-9)
    assert beta["sigma1"] == 0.0
    assert beta["sigma2"] >= 0.0
