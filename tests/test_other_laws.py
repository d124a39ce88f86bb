"""Other friction laws beside the one that is asked for: a comparison, and where it may be wrong."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.identify.basis import without
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.starts import fit
from tests.plants.spec import Motion


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    motions = (Motion("sines", 1, 0.8, 0.8, 8.0),)
    return prepared_logs(replace(PENDULUM, motions=motions), tmp_path_factory.mktemp("logs"))


def test_a_law_is_wrong_towards_the_laws_between_which_the_true_one_lies(prepared):
    base = fit(prepared, forms=forms_of(INTEGRATED_LAW))
    laws = OtherLaws(prepared, base)
    _, own = laws.follow(prepared, base)
    others = [
        refit(prepared, (), shape, ROUGH)
        for names, shape in laws.shapes.items()
        if names != own.shape.variables
    ]
    between = sum(x.friction - own.friction for x in others[:2]) * 0.3
    (error,) = laws.errors(replace(own, residual=between)).T
    known = own.free_jacobian / np.linalg.norm(own.free_jacobian, axis=0)
    left = without(between, np.column_stack([known, error / np.linalg.norm(error)]))
    assert np.linalg.norm(left) < 0.05 * np.linalg.norm(without(between, known))
    # a law that leaves nothing is not wrong
    assert not laws.errors(replace(own, residual=np.zeros_like(between))).any()


def test_a_law_starts_as_no_effect_had_bent_it_too(prepared):
    base = fit(prepared, forms=forms_of(INTEGRATED_LAW))
    laws = OtherLaws(prepared, base)
    bent = base.shape.moved(base.shape.vector() + 0.1)
    laws.follow(prepared, replace(base, shape=bent))
    assert laws.starts(bent) == (bent, base.shape)
    # a curve per direction comes last: no law was fitted with one from the start
    by_direction = base.shape.by_direction()
    assert laws.starts(by_direction) == (by_direction,)


@pytest.mark.parametrize("law", [INTEGRATED_LAW, "static"])
def test_a_law_that_is_asked_for_is_kept_and_the_others_are_compared(prepared, law):
    base = fit(prepared, forms=forms_of(law))
    laws = OtherLaws(prepared, base)
    # however much it leaves, no other law takes its place
    worse = replace(base, residual=5.0 * base.residual)
    _, chosen = laws.follow(prepared, worse)
    assert law_parameters(chosen).law == law
    compared = dict(laws.compared(prepared, base))
    assert law not in compared
    assert {"lugre", "maxwell_slip"} <= set(compared)
    lugre = refit(prepared, (), laws.shapes[forms_of("lugre")[0].variables], ROUGH)
    assert compared["lugre"] == pytest.approx(lugre.rms_in_motion)
