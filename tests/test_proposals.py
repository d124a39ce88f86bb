"""What to record next, computed: ties made on purpose, the record proposed made on the plant."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import toeplitz
from test_plants import quiet

from frictionjoint.diagnose.motions import Carried, Limits
from frictionjoint.diagnose.proposal import LEVEL, UNLIKE, Planner, to_distinguish
from frictionjoint.diagnose.report_parts import rivals
from frictionjoint.diagnose.separation import (
    Noise,
    moments,
    separation,
    with_further,
)
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.signals import LOAD, N_SIGNALS, A, Q, V
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
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
