"""Results that do not hang on the last bit: choices among equals, and a loop on disturbed logs."""

from dataclasses import replace

import numpy as np
import pytest
from test_wrong_mass import BELIEVED, PAYLOAD, driven, joint

from frictionjoint import close_loop
from frictionjoint.identify.law_start import LawStart
from frictionjoint.measured.log import JointLog


@pytest.fixture(scope="module")
def payload() -> list[JointLog]:
    """A joint that carries more than its MJCF says: a gain and an inertia say the same of it."""
    return [driven(joint(more=PAYLOAD), seed, seconds=6.0) for seed in (1, 2, 3)]


def told(logs: list[JointLog]) -> tuple[list[tuple[str, ...]], float]:
    """What is named with its ties, and the error of torque held out."""
    report = close_loop(logs[:2], BELIEVED, "j", logs[2:])
    named = [(step.effect, *step.evidence.ties) for step in report.added]
    held_out = report.after_torque.held_out
    assert held_out is not None
    return named, held_out


def test_a_loop_tells_the_same_of_logs_that_differ_in_the_last_bits(payload):
    named, error = told(payload)
    first, second, kept = (
        replace(log, torque=log.torque * (1.0 + 1e-13), position=log.position * (1.0 - 1e-10))
        for log in payload
    )
    assert told([second, first, kept]) == (named, pytest.approx(error, rel=0.01))


def test_rounding_chooses_no_stribeck_curve_where_the_level_shows_none():
    rng, reaches = np.random.default_rng(3), np.geomspace(1e-4, 1e-1, 8)
    levels = np.outer([0.3, 0.0, 0.0, 0.0, 0.0, 0.0], np.ones(8))
    disturbed = (levels * (1.0 + 1e-15 * rng.standard_normal(levels.shape)) for _ in range(20))
    starts = [LawStart.of(reaches, x, 2.0) for x in disturbed]
    assert len({(s.excess, s.Vs, s.delta) for s in starts}) == 1
