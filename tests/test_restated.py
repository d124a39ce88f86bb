"""What an effect's evidence is in the end: that of the final model."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose import restated as restating
from frictionjoint.diagnose.decisions import MOSTLY, SIGNIFICANCE
from frictionjoint.diagnose.finding import Finding
from frictionjoint.diagnose.moves import Look, look
from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.restated import restated
from frictionjoint.diagnose.state import State
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from tests.three_sines import INERTIA, A, Q, T, V, logged

SPRING, BIAS = (
    EffectTerm(next(e for e in CATALOGUE if e.name == name)) for name in ("spring", "torque-bias")
)
STIFFNESS = 3.0


@pytest.fixture(scope="module")
def state(tmp_path_factory):
    """A spring that is there and a bias that is not, both said to have been seen at first."""
    rng = np.random.default_rng(11)
    friction = np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0)
    torque = INERTIA * A + friction + STIFFNESS * Q + rng.normal(0.0, 0.05, len(T))
    prepared = logged(tmp_path_factory.mktemp("model"), torque)
    base = fit(prepared)
    laws = OtherLaws(prepared, base)
    prepared, base = laws.follow(prepared, base)
    state = State(prepared, base, [], Look((), np.zeros(0), 0.0), laws)
    seen, _ = look(base, state.blocks, state.candidates, rng)
    rows = {r.name: r for r in seen.rows}
    state.fit = found = refit(prepared, (SPRING, BIAS), base.shape)
    state.findings = [Finding(t, seen, rows[t.name], 0.5, (), (), found) for t in (SPRING, BIAS)]
    return state


def test_what_the_final_model_does_not_bear_out_is_dropped(state):
    (left,) = restated(state, np.random.default_rng(0))
    assert left.term.name == SPRING.name
    assert [t.name for t in state.fit.effects] == [SPRING.name]
    assert left.row.p_value <= SIGNIFICANCE
    assert left.row.frequency >= MOSTLY
    assert 0.1 < left.gain <= left.look.gain(left.row)


def test_what_cannot_be_seen_alone_keeps_its_evidence_and_stays(state, monkeypatch):
    """As an effect of the drive: how often it was chosen there is among effects of the drive."""
    monkeypatch.setattr(restating, "_seen_alone", lambda state, finding, rng: finding)
    kept = [replace(f, row=f.row._replace(frequency=0.1)) for f in state.findings]
    monkeypatch.setattr(restating, "_of_terms", lambda state: kept)
    assert restated(state, np.random.default_rng(0)) == tuple(kept)


def test_effects_that_leave_each_others_sizes_open_stay_as_ties_where_they_are_needed(monkeypatch):
    def open_sizes(prepared, fitted):
        return [t for t in fitted if t in ("spring", "gravity", "bias")]

    def squares(fitted, blocks):
        # the spring or the gravity is needed, the bias is not
        return "spring" in fitted, "gravity" in fitted

    state = SimpleNamespace(prepared=None, fit=("spring", "gravity", "bias"), blocks=None)
    state.forget_dropped = lambda: None
    monkeypatch.setattr(restating, "undetermined", open_sizes)
    monkeypatch.setattr(restating, "scored", squares)
    monkeypatch.setattr(restating, "needed", lambda now, other: now != other)
    monkeypatch.setattr(restating, "without", lambda s, t: Left(x for x in s.fit if x != t))
    monkeypatch.setattr(restating, "reweighed", lambda prepared, fitted: (prepared, fitted))
    monkeypatch.setattr(restating, "drop_idle", lambda s: None)
    assert restating._leave_out_undetermined(state) == ["spring", "gravity"]
    state.fit = Left(("bias",))
    assert restating._leave_out_undetermined(state) == []
    assert state.fit == ()


class Left(tuple):
    """Effects of a model that leaves the same whichever they are."""

    drive_rms = 1.0
