"""An early choice is looked at again: a rival that explains more takes its place, no other does."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from frictionjoint.diagnose.choice import Choice
from frictionjoint.diagnose.ranking import rank_all
from frictionjoint.diagnose.revision import exchanged
from frictionjoint.diagnose.step import step_of
from frictionjoint.identify.fit import fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.readers import read_log

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))

from plants.plant import simulate, write
from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

PLANT = PlantSpec(
    mass=1.0,
    length=0.2,
    inertia=0.06,
    armature=0.02,
    friction=Friction("lugre", Fs=0.6, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3),
    controller=Controller(kp=60.0, kd=3.0),
    motions=(Motion("sines", 3, 0.5, 1.0, 12.0), Motion("multisine", 4, 0.4, 1.0, 12.0)),
    instrument=Instrument(rate=500.0, counts=65536, torque_noise=0.005),
    seed=1,
)
# shares of what is left that the next addition would take away
LITTLE, NEARLY_ALL = 0.1, 0.99


def looked_again(effect, folder, taken, rival, gain):
    """What is made of `taken`, chosen on a plant that has `effect`, beside a rival of it."""
    paths = write(simulate(replace(PLANT, effects=(effect,))), folder)
    body = RigidBody(folder / "joint.xml", "joint")
    logs = prepare([read_log(path, "joint") for path in paths], body)
    rng = np.random.default_rng(0)
    alone = fit(logs)
    ranking = rank_all(logs, alone, rng)
    rows = {r.name: r for r in ranking.ranked if not r.candidate.smooth}
    current = fit(logs, (rows[taken].candidate.term,), start=alone.shape)
    choice = Choice(rows[taken], rivals=(rows[rival],))
    steps = [step_of(choice, current, ranking, rng)]
    return current, exchanged(logs, current, steps, gain, rng)


@pytest.fixture
def hanging(tmp_path):
    """A mass that hangs to one side, which a bias explains in part."""
    effect = Effect("gravity-error", {"mass": 0.15, "angle": 1.2})
    return lambda gain: looked_again(effect, tmp_path, "torque-bias", "gravity-error", gain)


def test_a_rival_that_explains_as_much_as_an_addition_takes_the_place(hanging):
    current, found = hanging(LITTLE)
    fitted, (step,) = found
    assert [t.name for t in fitted.terms] == ["gravity-error"]
    assert fitted.rms < current.rms
    assert step.term.name == "gravity-error"
    assert [r.name for r in step.rivals] == ["torque-bias"]


def test_an_addition_that_explains_more_than_the_rival_is_not_held_up(hanging):
    _, found = hanging(NEARLY_ALL)
    assert found is None


def test_a_right_choice_stays(tmp_path):
    bias = Effect("torque-bias", {"bias": 0.2})
    _, found = looked_again(bias, tmp_path, "torque-bias", "gravity-error", LITTLE)
    assert found is None
