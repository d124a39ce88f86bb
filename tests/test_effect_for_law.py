"""An effect beside the law fitted first in the place of a law with more freedom."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from frictionjoint.diagnose import trace
from frictionjoint.diagnose.state import State
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.terms import EffectTerm
from tests.leaving import leaving, model

OIL = EffectTerm(next(e for e in CATALOGUE if e.name == "nonlinear-viscous"))


def a_model(law, *effects):
    found = model(effects)
    found.shape, found.terms = law, effects
    return found


@pytest.fixture
def after(monkeypatch):
    """The model that a search takes, where another law leaves all of 1.0."""

    def taken(
        beside: float, elsewhere: float = 0.5, found: bool = True, noise: float = 0.0
    ) -> tuple[str, tuple]:
        """Of squares that the first law leaves with an effect, and with all fitted elsewhere."""
        rival, first, richer = a_model("rival"), a_model("first"), a_model("first", OIL)
        left = {("rival", ()): (1.0, 1.0), ("first", (OIL,)): (beside, elsewhere)}

        def key(fit):
            return fit.shape, fit.effects

        def score(fit, blocks):
            found = leaving(fit, left[key(fit)][0])
            return replace(found, noise=noise * found.total)

        def look_beside(state: State, rng: object) -> list[str]:
            state.fit = richer if found else state.fit
            return ["nonlinear-viscous"] if found else []

        monkeypatch.setattr(trace, "_of_joint", look_beside)
        monkeypatch.setattr(trace, "reweighed", lambda prepared, fit: (prepared, fit))
        monkeypatch.setattr(trace, "compared", lambda prepared, terms, law: a_model(law, *terms))
        monkeypatch.setattr(trace, "scored", score)
        monkeypatch.setattr(
            trace, "left_elsewhere", lambda prepared, fit, blocks: left[key(fit)][1]
        )
        monkeypatch.setattr(State, "blocks", None)
        laws = SimpleNamespace(first_with=lambda prepared, fit: None if fit is first else first)
        state = State(None, rival, [], None, laws)
        changed = trace._effect_for_law(state, None)
        assert changed == (state.fit is not rival)
        return key(state.fit)

    return taken


def test_an_effect_that_predicts_better_beside_the_first_law_is_taken(after):
    assert after(beside=0.3) == ("first", (OIL,))


def test_one_that_predicts_hardly_better_is_not(after):
    assert after(beside=0.9) == ("rival", ())


def test_one_that_follows_only_what_it_is_fitted_to_is_not(after):
    assert after(beside=0.3, elsewhere=1.2) == ("rival", ())


def test_a_law_beside_which_nothing_is_found_leaves_the_other(after):
    assert after(beside=0.3, found=False) == ("rival", ())


def test_beside_a_law_that_leaves_the_noise_none_is_sought(after):
    assert after(beside=0.3, noise=1.0) == ("rival", ())
