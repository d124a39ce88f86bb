"""Damping of a contact: decided last, and where a fit finds no level there is none."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.identify import damping
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import Search
from frictionjoint.identify.shape import INTEGRATED


@pytest.fixture(scope="module")
def search(tmp_path_factory) -> Search:
    return Search(
        prepared_logs(PENDULUM, tmp_path_factory.mktemp("pendulum"), 1),
        (),
        replace(INTEGRATED[0], damped=True),
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


@pytest.mark.parametrize(("left", "taken"), [(0.9, True), (0.97, False)])
def test_a_law_is_damped_where_that_leaves_clearly_less(monkeypatch, left, taken):
    undamped = SimpleNamespace(shape=INTEGRATED[0], effects=("spring",), drive_rms=1.0)
    found = SimpleNamespace(drive_rms=left)

    def refitted(prepared, effects, law):
        assert (prepared, effects) == ("logs", ("spring",))
        assert law == replace(INTEGRATED[0], damped=True)
        return found

    monkeypatch.setattr(damping, "refit", refitted)
    assert damping.with_damping("logs", undamped) is (found if taken else undamped)


@pytest.mark.parametrize("law", [forms_of("lugre")[0], replace(INTEGRATED[0], damped=True)])
def test_a_law_that_is_damped_or_never_is_stays_as_it_is(law):
    fitted = SimpleNamespace(shape=law)
    assert damping.with_damping("logs", fitted) is fitted
