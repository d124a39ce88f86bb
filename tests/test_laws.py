"""Several friction laws beside one model: which is taken, and where one of them may be wrong."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.laws import Laws
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.starts import fit
from tests.plants.spec import Motion


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    motions = (Motion("sines", 1, 0.8, 0.8, 8.0),)
    return prepared_logs(replace(PENDULUM, motions=motions), tmp_path_factory.mktemp("logs"))


@pytest.mark.parametrize("asked", [False, True])
def test_a_law_may_be_wrong_by_what_the_others_differ_from_it(prepared, asked):
    base = fit(prepared, forms=forms_of(INTEGRATED_LAW))
    laws = Laws(prepared, base, asked=asked)
    _, chosen = laws.better(prepared, base)
    errors = laws.errors(chosen)
    assert errors.shape == (len(base.residual), len(laws.shapes) - 1)
    # each is a law's torque on the same motion: like the own one, and not it
    own = chosen.friction
    alike = [float(np.corrcoef(own, x)[0, 1]) for x in errors.T]
    assert min(alike) > 0.9
    assert all(np.linalg.norm(x - own) > 1e-6 * np.linalg.norm(own) for x in errors.T)


def test_a_law_that_is_asked_for_is_kept(prepared):
    base = fit(prepared, forms=forms_of("static"))
    _, chosen = Laws(prepared, base, asked=True).better(prepared, base)
    assert chosen.shape.variables == base.shape.variables
