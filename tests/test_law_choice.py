"""The law itself is asked about: another one takes its place where it is clearly better."""

import numpy as np
import pytest
from plants.draw import draw_trial
from plants.plant import simulate, write

from frictionjoint.diagnose.close_loop import close_loop
from frictionjoint.diagnose.law_choice import OTHERS, clearly_better, with_better_law
from frictionjoint.identify.fit import fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.measured.readers import read_log
from frictionjoint.report.wording import sentence

# a Maxwell-slip joint without any effect
SEED = 6


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    folder = tmp_path_factory.mktemp("maxwell")
    trial = simulate(draw_trial(np.random.default_rng(SEED), "none"))
    assert trial.truth["friction"]["law"] == "gms"
    logs = [read_log(path, "joint") for path in write(trial, folder)]
    return logs, folder / "joint.xml"


@pytest.fixture(scope="module")
def chosen(plant):
    logs, model = plant
    return close_loop(logs[:2], model, "joint", logs[2:3])


@pytest.fixture(scope="module")
def kept(plant):
    logs, model = plant
    return close_loop(logs[:2], model, "joint", logs[2:3], law="integrated")


def test_a_clearly_better_law_takes_the_place_of_the_integrated_one(chosen):
    found = chosen.to_dict()
    assert found["base"]["law"] == "integrated"
    assert found["after"]["law"] == "maxwell_slip"
    assert found["added"] == []
    assert (
        found["after"]["torque_rms"]["held_out"] < 0.9 * found["before"]["torque_rms"]["held_out"]
    )


def test_the_page_says_so(chosen):
    assert chosen.changed
    assert "the friction law maxwell_slip, in place of integrated" in sentence(chosen)
    assert any("--law integrated keeps integrated" in note for note in chosen.notes)


def test_a_law_asked_for_stays(kept, chosen):
    found = kept.to_dict()
    assert found["after"]["law"] == "integrated"
    assert not kept.changed
    assert found["after"]["torque_rms"] == pytest.approx(chosen.to_dict()["before"]["torque_rms"])
    assert any("--law maxwell_slip" in note for note in kept.notes)


def test_a_law_that_took_the_place_of_the_integrated_one_may_lose_it_to_another(plant):
    logs, model = plant
    prepared = prepare(logs[:2], RigidBody(model, "joint"))
    lugre = fit(prepared, forms=forms_of("lugre"))
    found, forms = with_better_law(prepared, lugre, OTHERS, lambda text: None)
    assert clearly_better(found, lugre)
    assert law_parameters(found).law == "maxwell_slip"
    assert with_better_law(prepared, found, forms, lambda text: None) == (found, OTHERS)
