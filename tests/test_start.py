"""What a joint held when a log began: law and swinging link begin there, and the fit finds it."""

from dataclasses import replace

import numpy as np
import pytest
from plants.plant import simulate, write
from plants.spec import Effect, Motion
from trial_logs import PENDULUM

from frictionjoint.effects.gear import JOINT_ELASTICITY
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.start import predict, settled
from frictionjoint.identify.starts import fit, law_alone
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import split_in_time
from frictionjoint.measured.readers import read_log

FC = 0.5
# a pendulum that friction holds aside: moves from one rest to another
PLANT = replace(
    PENDULUM,
    friction=replace(PENDULUM.friction, law="gms"),
    motions=(Motion("pick-and-place", 3, 0.4, 0.8, 20.0), Motion("sines", 4, 0.3, 1.0, 10.0)),
    instrument=replace(PENDULUM.instrument, rate=1000.0),
)


@pytest.fixture(scope="module")
def cut(tmp_path_factory):
    """Logs of the plant, the first of them begun again in the middle of a stay at rest."""
    folder = tmp_path_factory.mktemp("cut")
    paths = write(simulate(PLANT), folder)
    whole, sines = (read_log(path, "joint") for path in paths)
    speed = np.abs(np.gradient(whole.position, whole.time))
    still = np.convolve(speed, np.ones(301) / 301, "same") < 0.01
    middle = len(still) // 3 + int(np.argmax(still[len(still) // 3 :]))
    _, rest_of_it = split_in_time(whole, 1.0 - whole.time[middle] / whole.time[-1])
    begun = replace(rest_of_it, before=None)
    return prepare([begun, sines], RigidBody(folder / "joint.xml", "joint"))


def test_a_log_that_begins_at_rest_under_load_is_no_longer_wrong_until_it_slides(cut):
    _, from_zero = reweighed(cut, fit(cut))
    begun, found = law_alone(cut)
    held = begun.segments[0].held
    assert abs(held) > 0.2
    assert found.rms < 0.9 * from_zero.rms
    assert found.coefficient("Fc") == pytest.approx(FC, rel=0.02)


RESONANCE, DAMPING = 6.0, 0.03


@pytest.fixture(scope="module")
def swinging(tmp_path_factory):
    """Logs of an elastic joint, the first begun again while the link swings after a step."""
    folder = tmp_path_factory.mktemp("swinging")
    w = 2.0 * np.pi * RESONANCE
    stiffness = PLANT.inertia * w * w
    spring = {"stiffness": stiffness, "damping": 2.0 * DAMPING * stiffness / w}
    motions = (Motion("steps", 3, 0.4, 2.0, 10.0), Motion("multisine", 4, 0.3, 1.0, 10.0))
    spec = replace(PLANT, motions=motions, effects=(Effect("joint-elasticity", spring),))
    steps, multisine = (read_log(path, "joint") for path in write(simulate(spec), folder))
    after = len(steps.time) // 2
    speed = np.abs(np.gradient(steps.position, steps.time))
    moment = after + int(np.argmax(speed[after:]))
    _, rest_of_it = split_in_time(steps, 1.0 - steps.time[moment] / steps.time[-1])
    return prepare([rest_of_it, multisine], RigidBody(folder / "joint.xml", "joint"))


def test_a_link_that_swings_when_a_log_begins_is_followed(swinging):
    """Without its swing the fit would take another damping for it."""
    term = EffectTerm(JOINT_ELASTICITY, (5.0, 0.1))
    weighted, from_rest = reweighed(swinging, fit(swinging, (term,)))
    begun, found = reweighed(*settled(weighted, from_rest))
    assert any(begun.segments[0].swing)
    assert found.drive_rms < 0.8 * from_rest.drive_rms
    resonance, damping = found.terms[0].shape
    assert resonance == pytest.approx(RESONANCE, rel=0.002)
    assert damping == pytest.approx(DAMPING, rel=0.1)
    # friction on the motor's side stops the swing too: the law's own error is in the stated one
    at = found.layout.numbers([t.name for t in found.terms].index("joint-elasticity"))
    error = float(np.sqrt(np.diag(stated_covariance(begun, found))[at][1]))
    assert abs(damping - DAMPING) < 2.0 * error
    assert predict(swinging, found).error.std() < 1.05 * found.rms
