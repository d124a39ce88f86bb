"""Damping of a contact: decided last, and where a fit finds no level there is none."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.identify import last_freedoms
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


@pytest.mark.parametrize("left", list(itertools.product((0.9, 0.97), repeat=2)))
def test_a_law_is_freed_where_that_leaves_clearly_less(monkeypatch, left):
    """Each freedom by itself: of those that do not, none stays."""
    bare = SimpleNamespace(shape=INTEGRATED[0], effects=("spring",), drive_rms=1.0)

    def refitted(prepared, effects, law, closeness=None):
        assert (prepared, effects) == ("logs", ("spring",))
        rms = (left[0] if law.damped else 1.0) * (left[1] if law.negative else 1.0)
        return SimpleNamespace(shape=law, effects=effects, drive_rms=rms)

    monkeypatch.setattr(last_freedoms, "refit", refitted)
    shape = last_freedoms.with_last_freedoms("logs", bare).shape
    assert shape.damped == (left[0] < 0.95)
    assert (shape.negative is not None) == (left[1] < 0.95)


@pytest.mark.parametrize(
    "law",
    [
        forms_of("lugre")[0],
        replace(INTEGRATED[0].with_sharp_sliding()[0], damped=True).by_direction(),
    ],
)
def test_a_law_that_is_free_or_never_is_stays_as_it_is(law):
    fitted = SimpleNamespace(shape=law)
    assert last_freedoms.with_last_freedoms("logs", fitted) is fitted
