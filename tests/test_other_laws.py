"""Other friction laws beside the one that is asked for: a comparison, and where it may be wrong."""

from dataclasses import replace

import pytest
from plants.spec import Effect, Friction, Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.effects.friction_level import DWELL_TIME
from frictionjoint.effects.rigid_body import SPRING
from frictionjoint.identify.base_fit import base_fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm

PLANT = replace(PENDULUM, motions=(Motion("sines", 1, 0.8, 0.8, 8.0),))


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    return prepared_logs(PLANT, tmp_path_factory.mktemp("logs"))


@pytest.mark.parametrize("law", [INTEGRATED_LAW, "static"])
def test_a_law_that_is_asked_for_is_kept_and_the_others_are_compared(prepared, law):
    base = fit(prepared, forms=forms_of(law))
    laws = OtherLaws(prepared, base)
    # however much it leaves, no other law takes its place
    worse = replace(base, residual=5.0 * base.residual)
    _, chosen = laws.follow(prepared, worse)
    assert law_parameters(chosen).law == law
    compared = dict(laws.compared(prepared, base).errors)
    assert law not in compared
    assert {"lugre", "elastoplastic", "maxwell_slip"} <= set(compared)
    lugre = refit(prepared, (), laws.shapes[forms_of("lugre")[0].variables], ROUGH)
    assert compared["lugre"] == pytest.approx(lugre.rms_in_motion)


def test_a_breakaway_friction_that_hangs_on_the_law_is_not_certain(tmp_path):
    """Fast reversals hardly show the breakaway: each law has one of its own, with small errors."""
    friction = Friction("elasto-plastic", Fs=0.9, Fc=0.6, Vs=0.02, delta=2.0, presliding=1e-3)
    motions = tuple(Motion("sines", seed, 0.6, 2.0, 12.0) for seed in (3, 4))
    logs = prepared_logs(replace(PENDULUM, friction=friction, motions=motions), tmp_path)
    logs, found = base_fit(logs, INTEGRATED_LAW)
    alone = stated_covariance(logs, found)
    laws = OtherLaws(logs, found).compared(logs, found)
    assert laws.differences
    narrow, wide = (
        law_estimates(found, cov, False) for cov in (alone, alone + laws.covariance(found))
    )
    off = abs(wide["Fs_pos"].value - friction.Fs)
    assert wide["Fs_pos"].stderr > 3.0 * narrow["Fs_pos"].stderr
    assert off < 2.0 * wide["Fs_pos"].stderr
    assert wide["Fc_pos"].stderr < 0.05 * friction.Fc
    # no law shares the stiffness, and so none changes its error
    assert wide["stiffness"].stderr == pytest.approx(narrow["stiffness"].stderr, rel=1e-3)


def static(logs):
    base = fit(logs, forms=forms_of("static"))
    laws = OtherLaws(logs, base)
    laws.follow(logs, base)
    return base, laws


def test_an_effect_that_another_law_does_without_is_told(prepared):
    base, laws = static(prepared)
    with_dwell = refit(prepared, (EffectTerm(DWELL_TIME, (0.2, 1e-3, 1e-4)),), base.shape)
    assert with_dwell.drive_rms < base.drive_rms
    assert laws.suffice(prepared, base, with_dwell)


def test_an_effect_that_every_law_needs_stays(tmp_path):
    spring = Effect("spring", {"stiffness": 2.0, "rest": 0.0})
    logs = prepared_logs(replace(PLANT, effects=(spring,)), tmp_path)
    base, laws = static(logs)
    assert not laws.suffice(logs, base, refit(logs, (EffectTerm(SPRING),), base.shape))
