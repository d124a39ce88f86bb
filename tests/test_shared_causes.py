"""What joints of simulated arms show together: named, in the right place, with its size."""

import numpy as np
import pytest
from arms.arm import (
    Arm,
    heavier_link_and_rotor,
    hide_payload,
    hide_rotor,
    hide_supply,
    hide_tilt,
    hide_warming,
    random_arm,
    reread,
    written,
)
from arms.fitted import fitted_joints, joint_logs

from frictionjoint.robot.alternatives import disagreements
from frictionjoint.robot.joint import first_fit
from frictionjoint.robot.shared import Settled, shared_causes

SECONDS = 8.0


def found_in(arm: Arm, seeds: tuple[int, ...] = (1, 2), seconds: float = SECONDS) -> Settled:
    """Shared causes in two short logs of an arm."""
    return shared_causes(fitted_joints(arm, seeds, seconds), arm.joints, map)


def values(found: Settled) -> list[tuple[str, dict[str, str], dict[str, float]]]:
    """Name, place and values of each cause."""
    settled = found.found
    return [
        (c.name, c.place, {n: v for n, (v, _) in c.values(settled.original, x).items()})
        for c, x in zip(settled.causes, settled.numbers, strict=True)
    ]


def test_nothing_is_found_where_nothing_is_hidden():
    assert not found_in(random_arm(21, 2)).choices


def test_a_payload_and_a_missing_rotor_are_named_with_their_sizes():
    arm = random_arm(22, 2)
    hide_payload(arm, 0.8, [0.02, 0.0, 0.05])
    hide_rotor(arm, "j1")
    settled = found_in(arm)
    assert not disagreements(settled)
    found = {name: (place, v) for name, place, v in values(settled)}
    assert set(found) == {"payload", "rotor-inertia"}
    place, payload = found["payload"]
    _, mass, centre = arm.hidden["payload"]
    assert place == {"body": "link2"}
    assert payload["mass"] == pytest.approx(mass, rel=0.05)
    measured = [payload[f"centre_{axis}"] for axis in "xyz"]
    assert np.linalg.norm(measured - centre) < 0.01
    place, rotor = found["rotor-inertia"]
    assert place == {"joint": "j1"}
    assert rotor["added"] == pytest.approx(arm.hidden["rotor-inertia"]["j1"], rel=0.1)


def test_a_payload_that_one_log_lacks_is_said():
    arm, loaded = random_arm(22, 2), random_arm(22, 2)
    hide_payload(loaded, 0.8, [0.02, 0.0, 0.05])
    without, with_it = (joint_logs(a, (s,), SECONDS) for a, s in ((arm, 1), (loaded, 2)))
    own = [first_fit([*without[j], *with_it[j]], arm.believed, j, None) for j in arm.joints]
    notes = disagreements(shared_causes(own, arm.joints, map))
    assert notes
    assert all("of link2: of the stated change they show log0 " in note for note in notes)


def test_a_leaning_base_is_told_from_wrong_masses():
    arm = random_arm(24, 2)
    hide_tilt(arm, 0.06, 1.0)
    ((name, _, found),) = values(found_in(arm))
    assert name == "base-tilt"
    assert found["angle"] == pytest.approx(0.06, rel=0.1)


def test_a_payload_is_found_where_its_mass_shows_in_its_inertia_alone():
    """The second joint's origin is on the first one's axis: no torque is linear in the mass."""
    arm = random_arm(60, 2)
    hide_payload(arm, 2.0, [0.03, 0.02, 0.02])
    ((name, place, found),) = values(found_in(arm))
    assert (name, place) == ("payload", {"body": "link2"})
    assert found["mass"] == pytest.approx(2.0, rel=0.05)
    measured = [found[f"centre_{axis}"] for axis in "xyz"]
    assert np.linalg.norm(measured - arm.hidden["payload"][2]) < 0.01


def planar_arm() -> Arm:
    """Two links that turn about vertical axes; gravity says nothing of them."""
    text = """<mujoco><worldbody><body name="link1" pos="0 0 0.3">
        <joint name="j1" axis="0 0 1" armature="0.12"/>
        <inertial pos="0.18 0 0" mass="4" diaginertia="0.01 0.05 0.05"/>
        <body name="link2" pos="0.35 0 0">
        <joint name="j2" axis="0 0 1" armature="0.05"/>
        <inertial pos="0.14 0 0" mass="2.2" diaginertia="0.004 0.022 0.022"/>
        <site name="flange" pos="0.3 0 0"/></body></body></worldbody></mujoco>"""
    level, none = np.array([1.5, 0.7]), np.zeros(2)
    return Arm(text, text, ["j1", "j2"], level, none + 0.4, 2e3 * level, 0.5 * level, none, none)


def test_a_payload_of_a_planar_arm_could_also_be_a_wrong_link():
    """No torque tells it from a link of another mass, centre and radius of gyration."""
    arm = planar_arm()
    hide_payload(arm, 1.2, [0.0, 0.0, 0.0], size=0.01)
    settled = found_in(arm)
    ((name, place, found),) = values(settled)
    assert (name, place) == ("payload", {"body": "link2"})
    assert found["mass"] == pytest.approx(1.2, rel=0.02)
    assert found["centre_x"] == pytest.approx(0.3, abs=0.01)
    (choice,) = settled.choices
    assert choice.evidence.ties == ("body-inertia of link2",)


def test_a_wrong_inertia_of_a_link_is_not_taken_for_another_mass():
    """With the model's radius of gyration it was, and a false rotor fitted to what that left."""
    arm = planar_arm()
    spec = reread(arm.true)
    spec.body("link2").mass, spec.body("link2").inertia = 1.8, np.array([0.004, 0.028, 0.028])
    arm.true = written(spec)
    ((name, place, found),) = values(found_in(arm))
    assert (name, place) == ("body-inertia", {"body": "link2"})
    assert found["mass"] == pytest.approx(1.8, rel=0.02)
    radius = np.sqrt(28 / 22 * 2.2 / 1.8)
    assert found["gyration_radius_over_model"] == pytest.approx(radius, rel=0.02)


def test_two_causes_of_which_one_alone_is_beyond_its_bounds_are_found():
    """Without the rotor no possible mass of the link would do; a payload of five numbers did."""
    arm = heavier_link_and_rotor(79)
    found = {name: v for name, _, v in values(found_in(arm))}
    assert set(found) == {"body-inertia", "rotor-inertia"}
    rotor = arm.hidden["rotor-inertia"]["j1"]
    assert found["rotor-inertia"]["added"] == pytest.approx(rotor, rel=0.05)
    assert found["body-inertia"]["mass"] == pytest.approx(arm.hidden["body-inertia"][1], rel=0.05)


def test_friction_of_all_joints_that_falls_with_the_temperature_is_one_cause():
    arm = random_arm(27, 2)
    hide_warming(arm, arm.joints, 0.015, 20.0, 6.0)
    found = found_in(arm)
    assert not found.choices
    ((common, _),) = found.common
    assert (common.term.name, common.joints) == ("temperature-dependent", ("j1", "j2"))
    # level and viscosity fall alike over the span of the logs, relative to those at T0
    T0, scale = common.term.shape
    warmest = 25.0 + 20.0 * (1.0 - np.exp(-SECONDS / 6.0))
    span = np.exp(-(warmest - T0) / scale) - np.exp(-(25.0 - T0) / scale)
    fall = -0.015 * (warmest - 25.0) / (1.0 - 0.015 * (T0 - 25.0))
    for name in ("level", "viscous"):
        assert common.parameters[name].value * span == pytest.approx(fall, rel=0.2)


def test_friction_of_one_joint_that_falls_is_none_of_all():
    arm = random_arm(27, 2)
    hide_warming(arm, ["j2"], 0.015, 20.0, 6.0)
    found = found_in(arm)
    assert not found.common
    assert not found.choices


def test_a_supply_below_its_scale_is_one_gain_of_all_drives():
    arm = random_arm(3, 2)
    hide_supply(arm, -0.12)
    found = found_in(arm)
    assert not found.choices
    ((common, _),) = found.common
    assert (common.term.name, common.joints) == ("torque-gain", ("j1", "j2"))
    assert common.parameters["gain"].value == pytest.approx(-0.12, rel=0.05)
    # rows are in units of what is left beside it, or the joint with least gravity decides
    for joint in found.joints:
        assert joint.common_effects[0].name == "torque-gain"
        assert joint.left <= joint.rms < 0.1 * joint.fit.rms
