"""The effects that are known, as other processes know them."""

import copy
import pickle

import pytest

from frictionjoint.effects.catalogue import DRIVE_EFFECTS, SIMULATED
from frictionjoint.identify.terms import EffectTerm


@pytest.mark.parametrize("effect", [*SIMULATED, *DRIVE_EFFECTS], ids=lambda e: e.name)
def test_an_effect_stays_the_same_one_in_another_process(effect):
    """What is simulated asks which effect it is, of terms that a process has found."""
    assert pickle.loads(pickle.dumps(effect)) is effect
    assert copy.deepcopy(effect) is effect
    assert pickle.loads(pickle.dumps(EffectTerm(effect))).effect is effect
