"""Several friction laws beside one model: which is taken, and where one of them may be wrong."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.laws import Laws
from frictionjoint.diagnose.trace import INTEGRATED_LAW
from frictionjoint.identify.basis import without
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.starts import fit
from tests.plants.spec import Motion


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    motions = (Motion("sines", 1, 0.8, 0.8, 8.0),)
    return prepared_logs(replace(PENDULUM, motions=motions), tmp_path_factory.mktemp("logs"))


@pytest.mark.parametrize("asked", [False, True])
def test_a_law_is_wrong_towards_the_laws_between_which_the_true_one_lies(prepared, asked):
    base = fit(prepared, forms=forms_of(INTEGRATED_LAW))
    laws = Laws(prepared, base, asked=asked)
    _, own = laws.better(prepared, base)
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
    laws = Laws(prepared, base, asked=False)
    bent = base.shape.moved(base.shape.vector() + 0.1)
    laws.better(prepared, replace(base, shape=bent))
    assert laws.starts(bent) == (bent, base.shape)


def test_a_law_that_is_asked_for_is_kept(prepared):
    base = fit(prepared, forms=forms_of("static"))
    _, chosen = Laws(prepared, base, asked=True).better(prepared, base)
    assert chosen.shape.variables == base.shape.variables


def test_a_law_that_is_no_longer_clearly_better_gives_way_to_the_first(prepared):
    base = fit(prepared, forms=forms_of(INTEGRATED_LAW))
    laws = Laws(prepared, base, asked=False)
    rival = refit(prepared, (), laws.shapes[forms_of("lugre")[0].variables], ROUGH)
    nearer = replace(rival, residual=0.5 * rival.residual)
    assert laws.first(prepared, nearer) == (prepared, nearer)
    # of logs too short to tell of an effect, none is clearly better
    _, kept = laws.first(prepared, nearer, too_short=True)
    assert kept.shape.variables == base.shape.variables
    further = replace(rival, residual=1.5 * rival.residual)
    _, found = laws.first(prepared, further)
    assert found.shape.variables == base.shape.variables
    assert found.drive_rms < further.drive_rms
    assert laws.first(prepared, base) == (prepared, base)
