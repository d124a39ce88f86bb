"""Squares of all joints: what their fits leave, beside effects that keep their shapes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from law_shapes import law_at

from frictionjoint.identify.reach import unreached
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.robot.choose import within_bounds
from frictionjoint.robot.clock import clock
from frictionjoint.robot.common import common_terms
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.found import Found
from frictionjoint.robot.screen import screen
from tests.arms.arm import hide_load_dependence, random_arm
from tests.arms.fitted import fitted_joints


def test_what_is_missing_does_not_bend_the_shape_of_an_effect_that_stands_beside_it():
    arm = random_arm(22, 2)
    hide_load_dependence(arm, "j1", 0.15)
    joints = fitted_joints(arm, (1, 2), 8.0)
    found = Found(Corrections.none(joints[0].alongs[0].model))
    missing = found.state.with_body(2, 1.5 * found.state.phi[2])
    without = [j.corrected(missing) for j in joints]
    blocks, wanted = clock(joints), frozenset({"load-dependent of j1"}).__contains__

    def own(seen) -> np.ndarray:
        """Gram matrix of the effect's columns."""
        (at,) = (c.at for c in seen.candidates)
        return seen.stack.presumed_apart(at)

    here = own(screen(joints, blocks, found, (), wanted))
    bent = own(screen(without, blocks, found, (), wanted))
    assert own(screen(without, blocks, found, (), wanted, shaped=joints)) == pytest.approx(here)
    assert bent.shape != here.shape or np.abs(bent / here - 1.0).max() > 0.1


def test_no_cause_of_all_joints_turns_their_torques_round():
    joints = fitted_joints(random_arm(22, 2), (1, 2), 8.0)
    (term,) = (t for t in common_terms(joints) if t.name == "torque-gain")
    found = Found(Corrections.none(joints[0].alongs[0].model))
    nothing = screen(joints, clock(joints), found, (), lambda label: False, common=(term,))
    (candidate,) = nothing.candidates
    for gain, possible in ((-1.98, False), (-0.5, True), (3.0, True)):
        stack = SimpleNamespace(solution=lambda at, gain=gain: np.full(len(at), gain))
        inside = within_bounds(stack, candidate, np.zeros(0, dtype=int))
        assert (inside is not None) is possible, gain


def test_a_joint_whose_fit_stops_short_counts_by_what_it_leaves():
    (joint,) = fitted_joints(random_arm(22, 1), (1,), 8.0)
    law = law_at(INTEGRATED[0], 0.02 * joint.prepared.top_speed, 1e-2 * joint.prepared.span)
    found = Found(Corrections.none(joint.alongs[0].model))
    beyond = []
    for steps in (1, 20):
        fitted = refit(joint.prepared, (), law, ROUGH, steps)
        beyond.append(unreached(fitted))
        short = replace(joint, fit=fitted, unreached=beyond[-1])
        stack = screen([short], clock([short]), found, (), lambda label: False).stack
        left = float(np.sum((fitted.residual * fitted.weight / joint.left) ** 2))
        assert stack.squares.sum() == pytest.approx(left, rel=1e-6)
    assert beyond[0].sum() > 10.0 * beyond[1].sum()
