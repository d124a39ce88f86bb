"""Which effects take each other's place in a model."""

from functools import partial
from types import SimpleNamespace

import pytest

from frictionjoint.diagnose import exchange
from frictionjoint.diagnose.decisions import DRIVE_DISCREPANCY
from frictionjoint.diagnose.finding import Finding, with_changed
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from tests.leaving import leaving, model

RICH, SIMPLE = (
    EffectTerm(next(e for e in CATALOGUE if e.name == name)) for name in ("spring", "inertia-error")
)


GAIN = EffectTerm(next(e for e in CATALOGUE if e.name == "torque-gain"))


@pytest.fixture
def weighed(monkeypatch):
    """What a model's first effect is called once an inertia was weighed against it, and its ties.

    Of fractions of the squares that models leave, by their effects.
    """

    def named(
        own: tuple[EffectTerm, ...], left: dict[tuple[EffectTerm, ...], float]
    ) -> tuple[str, tuple[str, ...]]:
        best, instead = SimpleNamespace(term=SIMPLE), model((SIMPLE, *own[1:]))
        monkeypatch.setattr(exchange, "scored", lambda fit, blocks: leaving(fit, left[fit.effects]))
        monkeypatch.setattr(exchange, "without", lambda state, term: model(own[1:]))
        monkeypatch.setattr(exchange, "compared", lambda prepared, terms, law: model(terms))
        monkeypatch.setattr(exchange, "reweighed", lambda prepared, fit: (prepared, fit))
        monkeypatch.setattr(exchange, "_no_richer", lambda state, term: [best] * (term is own[0]))
        monkeypatch.setattr(exchange, "_in_place_of", lambda *of: (best, instead))
        look = SimpleNamespace(find=lambda candidate: SimpleNamespace(name=candidate.term.name))
        findings = [Finding(term, look, None, 0.5, (), (), None) for term in own]
        state = SimpleNamespace(prepared=None, fit=model(own), blocks=None, findings=findings)
        exchange.weigh_others(state)
        assert [f.term.name for f in state.findings] == [t.name for t in state.fit.effects]
        return state.findings[0].term.name, state.findings[0].ties

    return named


@pytest.fixture
def after(weighed):
    """The same of a spring alone, with either effect and with none."""
    return lambda rich, simple, none: weighed((RICH,), {(): none, (RICH,): rich, (SIMPLE,): simple})


def test_a_simpler_effect_that_explains_as_much_takes_the_place(after):
    assert after(rich=0.5, simple=0.52, none=1.0) == ("inertia-error", ())


def test_one_that_explains_less_is_a_tie_unless_the_logs_tell_them_apart(after):
    assert after(rich=0.4, simple=0.6, none=1.0) == ("spring", ("inertia-error",))
    assert after(rich=0.1, simple=0.6, none=1.0) == ("spring", ())


def test_of_effects_that_explain_the_same_the_catalogues_first_is_named(after):
    """An inertia is less rare than a spring, and both are said."""
    assert after(rich=0.4, simple=0.4, none=0.41) == ("inertia-error", ("spring",))


def test_one_that_the_model_does_as_well_without_takes_no_place(after):
    """Or an effect that is needed would give way to one that is dropped next, and both be gone."""
    assert after(rich=0.65, simple=0.7, none=1.0) == ("spring", ("inertia-error",))


def test_of_two_waves_one_is_changed():
    wave = next(e for e in CATALOGUE if e.name == "position-periodic")
    waves = [EffectTerm(wave, (n,)) for n in (3.0, 7.0)]
    findings = [Finding(t, None, None, 0.5, (), (), None) for t in (RICH, *waves)]
    # the search has moved them since they came in
    now = (EffectTerm(wave, (3.1,)), RICH, EffectTerm(wave, (7.2,)))
    tied = partial(Finding.tied_with, term=SIMPLE)
    for k, ties in ((0, [(), (SIMPLE.name,), ()]), (2, [(), (), (SIMPLE.name,)])):
        changed = with_changed(findings, now, now[k], tied)
        assert [f.ties for f in changed] == ties
    same = partial(Finding.tied_with, term=waves[0])
    assert with_changed(findings, now, now[2], same) == findings


@pytest.mark.parametrize(("times", "taken"), [(0.8, True), (1.2, False)])
def test_a_protection_that_hardly_moves_more_of_the_drive_than_a_gain_is_one(
    monkeypatch, times, taken
):
    """One that always acts is another gain, and a third of what that leaves is no reason for it."""
    terms = (DriveTerm(next(e for e in DRIVE_EFFECTS if e.name == "duty-drop"), (0.1, 0.5)),)
    drive = 0.3**0.5 / DRIVE_DISCREPANCY / times
    own, other = model(terms, drive), model((GAIN,), drive)
    left = {terms: 0.7, (GAIN,): 1.0}
    monkeypatch.setattr(exchange, "scored", lambda fit, blocks: leaving(fit, left[fit.effects]))
    monkeypatch.setattr(exchange, "_other_drives", lambda state, i: [])
    monkeypatch.setattr(exchange, "_joints_instead", lambda state, i, rng: [(other, None)])
    seen = SimpleNamespace(term=GAIN)
    monkeypatch.setattr(exchange, "without_columns", lambda term: seen)
    monkeypatch.setattr(exchange, "reweighed", lambda prepared, fit: (prepared, fit))
    monkeypatch.setattr(exchange, "_change", lambda *of: None)
    state = SimpleNamespace(
        prepared=None,
        fit=own,
        blocks=None,
        blocks_of=lambda prepared, fit: None,
        under=lambda prepared: own,
    )
    assert exchange.exchange_drive(state, None) == taken
    assert state.fit is (other if taken else own)


@pytest.mark.parametrize(
    ("gain", "inertia", "named"),
    [
        (0.1, 0.9, ("torque-gain", ("inertia-error",))),
        (0.3, 0.9, ("torque-gain", ("inertia-error",))),
        (0.6, 0.9, ("inertia-error", ("torque-gain",))),
    ],
)
def test_of_two_that_explain_the_same_one_that_alone_explains_more_stays(
    weighed, gain, inertia, named
):
    """With an inertia in the place of a gain the spring would make up for the rest of that."""
    left = {(GAIN, RICH): 0.04, (SIMPLE, RICH): 0.04, (GAIN,): gain, (SIMPLE,): inertia}
    assert weighed((GAIN, RICH), left) == named
