"""Other friction laws beside the one that is asked for: a comparison, and where it may be wrong."""

from dataclasses import replace

import pytest
from plants.spec import Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.other_laws import OtherLaws
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.starts import fit


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    motions = (Motion("sines", 1, 0.8, 0.8, 8.0),)
    return prepared_logs(replace(PENDULUM, motions=motions), tmp_path_factory.mktemp("logs"))


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
