"""Effects of single joints beside causes that are taken out keep their shapes."""

import numpy as np
import pytest

from frictionjoint.robot.clock import clock
from frictionjoint.robot.corrections import Corrections
from frictionjoint.robot.screen import Found, screen
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
