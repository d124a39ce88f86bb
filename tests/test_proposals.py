"""What to record next, computed: ties made on purpose, the record proposed made on the plant."""

import re
from dataclasses import replace

import numpy as np
import pytest
from plants import motion as paths
from plants.plant import (
    Controller,
    Effect,
    Friction,
    Instrument,
    Motion,
    assemble,
    control_period,
    follow,
)
from trial_logs import quiet

from frictionjoint.diagnose.motions import Limits, family, least_travel
from frictionjoint.diagnose.proposal import Planner, to_distinguish
from frictionjoint.diagnose.report_parts import rivals
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog

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


def test_another_payload_is_proposed_where_no_motion_parts_two_effects_and_it_does():
    # an axis without gravity: torque-gain and inertia-error are one until the load changes
    spec = replace(PLANT, effects=(Effect("inertia-error", {"inertia": 0.04}),), length=0.0)
    body = RigidBody(assemble(spec).believed(), "joint")
    motions = Motion("multisine", 3, 0.8, 2.0, 8.0), Motion("ramps", 4, 0.8, 2.0, 8.0)
    logs = [recorded(spec, paths.target(m, PERIOD), m.kind) for m in motions]
    prepared = prepare(logs, body)
    found = trace(prepared, law="integrated")
    step = found.findings[0]
    assert {step.term.name, *step.ties} == {"torque-gain", "inertia-error"}

    planner = Planner(found.prepared, found.final, body)
    (i, other), *_ = rivals(found)
    proposal = planner.distinguishing(i, other)
    assert proposal.distinguishes
    assert proposal.motion.payload > 0.0
    assert all(x.share < 1e-3 for x in proposal.now)
    assert all(x.deviations >= 3.0 and x.share >= 0.04 for x in proposal.expected)
    text = to_distinguish(planner, i, other)
    assert re.search(r"joint 'joint', .* rad, up to .* rad/s, with a further payload", text)
    assert f"for {proposal.motion.duration:.0f} s" in text
    assert "At least 4% and 3 standard deviations are needed" in text

    more = 1.0 + proposal.motion.payload
    loaded = replace(spec, mass=more * spec.mass, inertia=more * spec.inertia)
    motion, t = proposal.motion, np.arange(0.0, proposal.motion.duration, PERIOD)
    target = np.interp(t, motion.dt * np.arange(len(motion.position)), motion.position)
    new = prepare(
        [recorded(loaded, target, "payload")],
        RigidBody(assemble(loaded).believed(), "joint"),
        prepared.band,
    )
    logs = replace(prepared, segments=prepared.segments + new.segments)
    again = trace(logs, law="integrated")
    assert again.findings[0].term.name == "inertia-error"
    assert again.findings[0].ties == ()
    # logs that distinguish two effects need no further recording
    (gain,) = (x for x in (step.term, other) if x.name == "torque-gain")
    assert to_distinguish(Planner(again.prepared, again.final, body), 0, gain) is None


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
        # a speed that passes the range in a third of a second
        (Limits(-1.1, 1.1, 6.8, 300.0), 0.01),
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
                # held for half a second in each direction
                assert m.speed < 1.1 * limits.reach / 0.5
    assert not any("reversals" in m.name for m in family(limits, counted, 1e-5))
    assert not list(family(Limits(0.0, COUNT, 0.1, 1.0), counted, 0.01))
