"""What to record next, computed: ties made on purpose, the record proposed made on the plant."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import toeplitz
from trial_logs import quiet

from frictionjoint.diagnose import motions
from frictionjoint.diagnose.motions import Carried, Limits, between, family, least_travel
from frictionjoint.diagnose.proposal import (
    LEVEL,
    UNLIKE,
    Planner,
    Sharpened,
    computed_proposals,
    to_distinguish,
    to_sharpen,
)
from frictionjoint.diagnose.report_parts import rivals
from frictionjoint.diagnose.separation import Noise, moments, separation, with_further
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.signals import LOAD, N_SIGNALS, A, Q, V
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.measured.log import JointLog
from tests.plants import motion as paths
from tests.plants.plant import (
    Controller,
    Effect,
    Friction,
    Instrument,
    Motion,
    assemble,
    control_period,
    follow,
)

PLANT = replace(
    quiet(),
    friction=Friction("gms", Fs=0.6, Fc=0.5, Vs=0.05, sigma2=0.1, presliding=2e-3),
    controller=Controller(kp=600.0, kd=10.0),
    instrument=Instrument(rate=200.0, counts=2**15, torque_noise=0.01),
)
PERIOD = control_period(assemble(PLANT))


def recorded(spec, target, name):
    """A log of the plant along a target, one value per control period."""
    log = follow(assemble(spec), target, 0)
    return JointLog(
        name=name, joint="joint", time=log["time_s"], position=log["position_rad"],
        torque=log["torque_nm"],
    )  # fmt: skip


def logs_of(spec, reach, speed):
    kinds = ("multisine", "ramps")
    motions = [Motion(kind, 3 + i, reach, speed, 8.0) for i, kind in enumerate(kinds)]
    return [recorded(spec, paths.target(m, PERIOD), m.kind) for m in motions]


def as_target(motion):
    """The motion of a proposal at the plant's control period."""
    t = np.arange(0.0, motion.duration, PERIOD)
    return np.interp(t, motion.dt * np.arange(len(motion.position)), motion.position)


def test_another_payload_is_proposed_where_no_motion_parts_two_effects_and_it_does():
    # an axis without gravity: torque-gain and inertia-error are one until the load changes
    spec = replace(PLANT, effects=(Effect("inertia-error", {"inertia": 0.04}),), length=0.0)
    body = RigidBody(assemble(spec).believed(), "joint")
    prepared = prepare(logs_of(spec, 0.8, 2.0), body)
    found = trace(prepared, law="integrated")
    step = found.findings[0]
    assert {step.term.name, *step.ties} == {"torque-gain", "inertia-error"}

    planner = Planner(found.prepared, found.final, body)
    (i, other), *_ = rivals(found)
    proposal = planner.distinguishing(i, other)
    assert proposal.distinguishes
    assert proposal.motion.payload > 0.0
    assert all(x.share < 1e-3 for x in proposal.now)
    assert all(x.deviations >= LEVEL and x.share >= UNLIKE for x in proposal.expected)
    text = to_distinguish(planner, i, other)
    assert re.search(r"joint 'joint', .* rad, up to .* rad/s, with a further payload", text)
    assert f"for {proposal.motion.duration:.0f} s" in text

    more = 1.0 + proposal.motion.payload
    loaded = replace(spec, mass=more * spec.mass, inertia=more * spec.inertia)
    new = prepare(
        [recorded(loaded, as_target(proposal.motion), "payload")],
        RigidBody(assemble(loaded).believed(), "joint"),
        prepared.band,
    )
    logs = replace(prepared, segments=prepared.segments + new.segments)
    again = trace(logs, law="integrated")
    assert again.findings[0].term.name == "inertia-error"
    assert again.findings[0].ties == ()


def correlated(rng, n):
    white = rng.standard_normal(n + 3)
    return white[3:] + 0.8 * white[2:-1] + 0.5 * white[1:-2] + 0.2 * white[:-3]


def test_separation_is_what_least_squares_leaves_over_its_noise():
    rng = np.random.default_rng(0)
    n = 400
    J, a, b = rng.standard_normal((n, 3)), rng.standard_normal(n), rng.standard_normal(n)
    noise = Noise(correlated(rng, 4000), np.zeros(4000, dtype=np.int64), 100)
    rho = np.zeros(n)
    rho[: len(noise.autocovariance)] = noise.autocovariance[:n]
    sigma = toeplitz(rho)
    # an effect's columns: one coefficient's, then its torque
    U = np.column_stack([J, a, 2.0 * a, b, -b])
    found = separation(moments(U, noise), 3, 2, 2)
    for own, other, result in ((2.0 * a, b, found[0]), (-b, a, found[1])):
        X = np.column_stack([J, other])
        left = own - X @ np.linalg.lstsq(X, own, rcond=None)[0]
        alone = own - J @ np.linalg.lstsq(J, own, rcond=None)[0]
        assert result.deviations == pytest.approx(0.5 * left @ left / np.sqrt(left @ sigma @ left))
        assert result.share == pytest.approx(left @ left / (alone @ alone))


def test_noise_is_that_of_the_residual_also_at_a_lower_rate():
    rng = np.random.default_rng(1)
    residual, index = correlated(rng, 40_000), np.zeros(40_000, dtype=np.int64)
    slow = np.sin(2.0 * np.pi * np.arange(8000) / 2000.0)[:, None]
    fine = moments(slow, Noise(residual, index, 240))
    coarse = moments(slow[2::5], Noise(residual, index, 240, 5))
    # the variance of a sum of moving averages is their gain at frequency 0, squared
    assert fine.noise == pytest.approx(2.5**2 * fine.gram, rel=0.1)
    assert coarse.noise == pytest.approx(fine.noise, rel=0.05)
    assert coarse.gram == pytest.approx(fine.gram, rel=0.01)


def test_the_same_record_once_more_halves_the_variance():
    rng = np.random.default_rng(2)
    n = 3000
    J = rng.standard_normal((n, 2)) * [1.0, 1e3]
    noise = Noise(correlated(rng, n), np.zeros(n, dtype=np.int64), 75)
    sums = moments(J, noise)
    bread = np.linalg.inv(sums.gram)
    cov = bread @ sums.noise @ bread
    assert with_further(cov, J, sums) == pytest.approx(0.5 * cov)


def test_load_of_a_motion_is_inverse_dynamics():
    body = RigidBody(assemble(PLANT).believed(), "joint")
    prepared = prepare(logs_of(replace(PLANT, friction=quiet().friction), 0.4, 1.0), body)
    rng = np.random.default_rng(3)
    signals = np.zeros((50, N_SIGNALS))
    signals[:, Q] = rng.uniform(-1.0, 1.0, 50)
    signals[:, V], signals[:, A] = rng.standard_normal((2, 50))
    Carried(body, prepared, Limits(-1.0, 1.0, 1.0, 1.0)).fill(signals, 0.0)
    expected = body.torque(signals[:, Q], signals[:, V], signals[:, A]).load
    assert signals[:, LOAD] == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


COUNT = 1e-3


@pytest.fixture(scope="module")
def counted():
    """A log of an encoder of 1 mrad, prepared."""
    t = 5e-3 * np.arange(1600)
    q = COUNT * np.round(0.5 * np.sin(4.0 * t) / COUNT)
    torque = np.sign(np.cos(4.0 * t)) + 0.01 * np.random.default_rng(4).standard_normal(len(t))
    log = JointLog(name="counted", joint="joint", time=t, position=q, torque=torque)
    return prepare([log], RigidBody(assemble(PLANT).believed(), "joint"))


def test_every_motion_tried_shows_ends_in_time_and_has_the_speed_in_its_name(counted):
    least = least_travel(counted)
    assert least > 5.0 * COUNT
    # too little acceleration for this speed, over this range
    for limits, presliding in (
        (Limits(-0.4, 0.4, 4.0, 8.0), 0.01),
        (Limits(-400.0, 400.0, 40.0, 20.0), 0.01),
        (Limits(-400.0, 400.0, 40.0, 20.0), 10.0),
    ):
        tried = list(family(limits, counted, presliding))
        assert any("slow reversals" in m.name for m in tried)
        for m in tried:
            assert m.once <= m.duration
            assert np.ptp(m.position) > least
            assert m.speed <= 1.1 * limits.speed
            named = re.search(r"constant ([\d.e-]+)", m.name)
            if named:
                assert m.speed == pytest.approx(float(named[1]), rel=0.06)
    assert not any("reversals" in m.name for m in family(limits, counted, 1e-5))
    assert not list(family(Limits(0.0, COUNT, 0.1, 1.0), counted, 0.01))


def test_a_range_is_told_as_finely_as_it_is_wide():
    assert between(259.853, 260.147, "rad") == "259.853 to 260.147 rad"
    assert between(-2.75e-5, 1.6302, "rad") == "0.00 to 1.63 rad"
    assert between(-164.2, 684.1, "rad") == "-164 to 684 rad"


def test_a_joint_at_rest_gets_one_sentence(counted):
    planner = SimpleNamespace(at_rest=True)
    assert len(computed_proposals(planner, [(0, None), (1, None)], None, {})) == 1


def test_an_effect_of_several_shapes_is_one_rival():
    effect = next(e for e in CATALOGUE if e.name == "load-dependent")
    terms = [EffectTerm(effect, shape) for shape in ((0.1,), (0.2,))]
    planner = SimpleNamespace(
        at_rest=False,
        fitted=SimpleNamespace(terms=[SimpleNamespace(name="torque-gain")]),
        distinguishing=lambda i, other: None,
    )
    (text,) = computed_proposals(planner, [(0, other) for other in terms], None, {})
    assert "wrong motor constant from friction that grows with load" in text


def test_standard_errors_that_mean_nothing_are_not_stated():
    motion = motions.Motion("a sine of 1 Hz", 0.1, np.array([0.0, 0.1]), 1.0)
    found = Sharpened(motion, {"delta_pos": Estimate(2.0, 0.5, "1")})
    planner = SimpleNamespace(
        body=SimpleNamespace(slide=False, joint="j"), sharpening=lambda *_: found
    )
    law = {"delta_pos": Estimate(2.0, 5.2e10, "1")}
    text = to_sharpen(planner, None, ["delta_pos"], law)
    assert text.endswith("the standard error of Stribeck exponent from more than its value to 0.5.")
    planner.sharpening = lambda *_: None
    assert to_sharpen(planner, None, ["delta_pos"], law).startswith("No motion within the range")
