"""What a joint held when a log began: law and swinging link begin there, and the fit finds it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_shapes import law_at

from frictionjoint.effects import joint_elasticity
from frictionjoint.effects.signals import DT, N_SIGNALS, TIME, A, H, Q
from frictionjoint.identify.design import full_signals
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.noise import Noise
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.segment import Band, Prepared, Segment
from frictionjoint.identify.start import predict, settled
from frictionjoint.identify.starts import fit, law_alone
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import split_in_time
from frictionjoint.measured.readers import read_log
from tests.plants.plant import simulate, write
from tests.plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

FC = 0.5
# a pendulum that friction holds aside: moves from one rest to another
PLANT = PlantSpec(
    mass=1.0,
    length=0.2,
    inertia=0.06,
    armature=0.02,
    friction=Friction("gms", Fs=0.6, Fc=FC, Vs=0.1, sigma2=0.1, presliding=2e-3),
    controller=Controller(kp=60.0, kd=3.0),
    motions=(Motion("pick-and-place", 3, 0.4, 0.8, 20.0), Motion("sines", 4, 0.3, 1.0, 10.0)),
    instrument=Instrument(rate=1000.0, counts=65536, torque_noise=0.005),
    seed=1,
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


def test_of_a_log_that_is_only_predicted_the_start_is_sought_too(cut):
    begun, found = settled(cut, fit(cut))
    (measured, *_), (predicted, *_), *_ = predict(cut, found)
    error = measured - predicted
    at_start = error[: len(error) // 20]
    assert np.sqrt(np.mean(at_start**2)) < 2.0 * np.sqrt(np.mean(error**2))
    # a start is sought as nearly as the squares of a log tell it
    apart = (predicted - predict(begun, found)[1][0])[: len(at_start)]
    assert np.sqrt(np.mean(apart**2)) < 0.02 * FC


def still(held: float) -> Segment:
    """A joint that stands for a second."""
    time = np.arange(200) * 0.005
    signals = np.zeros((len(time), N_SIGNALS))
    signals[:, TIME] = time
    signals[:, Q] = 0.3
    everything = np.ones(len(time), dtype=bool)
    return Segment(
        name="still",
        dt=0.005,
        bandwidth_hz=20.0,
        step=1,
        signals=signals,
        drive=0.0 * time,
        driven=everything,
        mask=everything,
        others={},
        noise=Noise(0.0, np.zeros(2), np.zeros(2), 1.0, 0.0),
        sample=0.005,
        corner_hz=40.0,
        held=held,
    )


def alone(segment):
    return Prepared((segment,), "joint", False, "torque", Band(20.0, 40.0))


@settings(deadline=None)
@given(
    held=st.floats(-1.0, 1.0),
    law=st.sampled_from(("integrated", "lugre", "elastoplastic", "maxwell_slip", "dahl")),
)
def test_every_law_begins_at_what_was_held_and_keeps_it_at_rest(held, law):
    form = law_at(forms_of(law)[0], 0.02, 0.001)
    (own,) = full_signals(alone(still(held)), form, 1.0, 0.0)
    np.testing.assert_allclose(own[:, H], held, atol=0.03)


def test_a_law_that_never_holds_as_much_begins_at_its_most():
    form = law_at(forms_of("dahl")[0], 0.02, 0.001)
    (own,) = full_signals(alone(still(1.4)), form, 1.0, 0.0)
    assert own[0, H] == pytest.approx(1.0, abs=1e-6)


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
    term = EffectTerm(joint_elasticity.EFFECT, (5.0, 0.1))
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


@given(
    resonance=st.floats(1.0, 20.0), damping=st.floats(0.005, 0.2), angle=st.floats(-np.pi, np.pi)
)
def test_a_swing_let_go_decays_as_its_damping_says(resonance, damping, angle):
    """Torque of a free oscillator, from its equation: d'' = -(2 zeta w d' + w^2 d)."""
    w, t = 2.0 * np.pi * resonance, np.arange(2000) * 1e-3 / resonance
    roots = w * (-damping + 1j * np.sqrt(1.0 - damping**2))
    d = np.exp(roots * t + 1j * angle)
    signals = np.zeros((len(t), N_SIGNALS))
    signals[1:, DT] = np.diff(t)
    start = (d[0].real, (roots * d[0]).real)
    torque = joint_elasticity.free_swing((resonance, damping), start, signals)
    np.testing.assert_allclose(torque, (roots**2 * d).real, atol=1e-3 * w * w)


@pytest.mark.parametrize("resonance", [5.0, 20.0])
def test_a_driven_link_resonates_where_its_spring_says_at_few_samples(resonance):
    """Torque under a motion of one frequency, from the transfer function of link and spring."""
    step, damping = 4e-3, 0.03
    t = step * np.arange(4000)
    w = 2.0 * np.pi * resonance
    numbers = np.array([resonance, damping, 1.0])
    peak = 0.5 / damping
    for part in (0.5, 0.97, 1.0, 1.03):
        s = 1j * part * w
        motion = np.exp(s * t)
        wanted = -(s * s) / (s * s + 2.0 * damping * w * s + w * w)
        X, found, sig = np.zeros(3), np.empty(len(t)), np.zeros(N_SIGNALS)
        for k in range(len(t)):
            sig[DT], sig[A] = step * (k > 0), motion[k].real
            found[k] = joint_elasticity.torque(numbers, 0, sig, X, 0)
        late = slice(3000, None)
        error = found[late] - (wanted * motion).real[late]
        assert np.abs(error).max() < 2e-3 * peak
