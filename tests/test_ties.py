"""Of effects that explain as much, which one is taken, and what is said of the others."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.candidate import Candidate
from frictionjoint.diagnose.choice import Tried, chosen
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.moves import Move
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import State
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.position import POSITION_PERIODIC
from frictionjoint.identify.smooth import EncoderTerm, SplineTerm
from frictionjoint.identify.terms import EffectTerm

BLOCKS = 48
FIT = SimpleNamespace(friction=np.ones(BLOCKS), weight=np.ones(BLOCKS), error_unit=1.0)
RNG = np.random.default_rng(2)
WITHOUT = RNG.uniform(0.5, 1.5, BLOCKS)


def tried(name, left):
    """An effect that leaves a part of the squares, hardly alike in the blocks."""
    effect = next(e for e in CATALOGUE if e.name == name)
    return of_term(EffectTerm(effect, tuple(1.0 for _ in effect.shape)), left)


def of_term(term, left):
    candidate = Candidate(term, RNG.normal(size=(100, len(term.coefficients))))
    score = Scored(FIT, left * WITHOUT * RNG.uniform(0.5, 1.5, BLOCKS))
    return Tried(Move((term,), (candidate,), score.squares, None), None, score)


@pytest.mark.parametrize("order", [1, -1])
def test_of_as_many_numbers_that_which_leaves_least_is_taken(order):
    leaders = [tried("torque-bias", 0.41), tried("inertia-error", 0.40)]
    best = min(leaders, key=lambda t: t.score.total)
    choice = chosen(Scored(FIT, WITHOUT), leaders[::order])
    assert choice.taken is best
    assert len(choice.ties) == 1


def test_fewer_numbers_are_taken_where_they_leave_hardly_more():
    simple, rich = tried("torque-bias", 0.41), tried("position-periodic", 0.39)
    choice = chosen(Scored(FIT, WITHOUT), [rich, simple])
    assert choice.taken is simple
    assert choice.ties == ("position-periodic",)


def test_what_has_no_name_does_not_take_the_place_of_an_effect_that_explains_hardly_less():
    """It leaves a fifth of what the effect leaves, of hardly anything."""
    named = tried("load-dependent", 0.01)
    curve = of_term(SplineTerm("load", -1.0, 1.0), 0.002)
    assert chosen(Scored(FIT, WITHOUT), [curve, named]).taken is named
    # what explains but a part of it is named beside it, if at all
    part = tried("load-dependent", 0.4)
    assert chosen(Scored(FIT, WITHOUT), [curve, part]).taken is curve
    assert chosen(Scored(FIT, WITHOUT), [curve]).taken is curve


def test_a_wave_of_the_encoder_takes_the_place_of_an_effect_that_explains_less():
    """A curve with as small a lead does not: it bends with the data."""
    named = tried("position-periodic", 0.45)
    wave = of_term(EncoderTerm("position", 1.0, 0.1, (1.0, 0.0), 0.1), 0.34)
    assert chosen(Scored(FIT, WITHOUT), [wave, named]).taken is wave
    curve = of_term(SplineTerm("position", -1.0, 1.0), 0.34)
    assert chosen(Scored(FIT, WITHOUT), [curve, named]).taken is named
    # of hardly anything that is left less is no lead
    close = tried("gravity-error", 0.01)
    less = of_term(EncoderTerm("position", 1.0, 0.1, (1.0, 0.0), 0.1), 0.002)
    assert chosen(Scored(FIT, WITHOUT), [less, close]).taken is close


def test_a_wave_keeps_its_own_finding_where_another_wave_is_dropped():
    waves = [EffectTerm(POSITION_PERIODIC, (N,)) for N in (7.0, 12.0)]
    findings = [
        Finding(w, None, None, gain, (), (), None)
        for w, gain in zip(waves, (0.9, 0.4), strict=True)
    ]
    left = waves[1].with_shape((12.1,))
    state = State(None, SimpleNamespace(effects=(left,)), findings, None, None)
    state.forget_dropped()
    assert [f.gain for f in state.findings] == [0.4]
