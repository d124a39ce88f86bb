"""A drive of known size explains a motion only as far as it acts: without one little is left."""

import pytest

from frictionjoint.diagnose.score import scored
from frictionjoint.effects.catalogue import DRIVE_EFFECTS
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import DriveTerm
from tests.leg import BELIEVED, CONTROLLER, MODEL, leg

LIMIT = next(effect for effect in DRIVE_EFFECTS if effect.name == "drive-limit")


@pytest.fixture(scope="module")
def heavier() -> Prepared:
    """Its MJCF holds a tenth of the inertia: the link, and not what the rotor adds."""
    return prepare([leg(10.0 * BELIEVED)], RigidBody(MODEL, "j"), controller=CONTROLLER)


def test_a_drive_that_hardly_acts_explains_nothing(heavier):
    base = fit(heavier)
    blocks = make_blocks(heavier, base)
    none = refit(heavier, (DriveTerm(LIMIT, (1e-4,)),), base.shape, ROUGH)
    # what is left without a drive, in N m, is less than what the missing inertia leaves
    assert none.acting < 1e-3
    assert none.rms < base.rms
    assert scored(none, blocks).gain(scored(base, blocks)) < 0.0
