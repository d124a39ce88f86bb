"""Every effect of the catalogue acts in a simulation, with numbers that come from itself.

What `tests/acting.py` makes of an effect serves the tests of the C header and of mujoco_warp too;
that it is enough shows here, in the tests that run everywhere.
"""

import mujoco
import numpy as np
import pytest
from acting import acting, arm, ctrl, name, natively, torques

import frictionjoint as fj
from frictionjoint.effects.catalogue import CATALOGUE, SIMULATED, title
from frictionjoint.effects.kernel import scales_level

ALL, LEVEL = torques(), "scales the friction level"


@pytest.mark.parametrize("effect", ALL, ids=name)
def test_with_it_an_arm_moves_otherwise(effect):
    """Among those that add no torque, which heat the joint; one of those among all that do."""
    others = [acting(e) for e in ALL if bool(e.coefficients) != bool(effect.coefficients)]
    apart = natively(arm(*others, acting(effect))) - natively(arm(*others))
    assert np.abs(apart)[:, :2].max() > 1e-3


def test_the_torque_of_each_is_read_by_its_name():
    data, seen = mujoco.MjData(model := arm(*map(acting, ALL))), []
    with fj.attach(model):
        for k in range(300):
            data.ctrl[:] = ctrl(k)
            mujoco.mj_step(model, data)
            friction = fj.torque(model, data)["a"]
            seen.append([*friction.effects.values()])
    assert [key.partition("_")[0] for key in friction.effects] == [e.name for e in ALL]
    assert all(scales_level(e.effect_id) == (e.entry == LEVEL) for e in SIMULATED)
    assert np.abs(seen).max() > 0.1
    law = friction.hysteresis + friction.damping + friction.viscous + friction.implicit
    assert friction.total == pytest.approx(law + sum(seen[-1]), abs=1e-12)


@pytest.mark.parametrize("effect", [e for e in SIMULATED if e.acts != "torque"], ids=name)
def test_what_is_no_torque_is_a_part_of_the_model(effect):
    tracks = []
    for model in (arm(acting(effect)), arm()):
        data, track = mujoco.MjData(model), []
        with fj.attach(model):
            for k in range(500):
                data.ctrl[:] = ctrl(k)
                mujoco.mj_step(model, data)
                track.append([data.joint("b").qpos[0], data.sensor("a_position").data[0]])
        tracks.append(track)
    assert np.abs(np.subtract(*tracks)).max() > 1e-3


def test_each_form_of_a_wave_in_position_has_its_own_title() -> None:
    torque, level = (e for e in CATALOGUE if e.name == "position-periodic")
    assert title(torque.name) == title(torque.name, torque.cause) == "cogging"
    assert title(level.name, level.cause) == title(level.name, level.effect_id)
    assert "friction" in title(level.name, level.cause)
