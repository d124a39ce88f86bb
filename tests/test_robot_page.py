"""The page of a whole robot: causes and effects by their names for people, no cell empty."""

import html
import re
from dataclasses import replace

import numpy as np
import pytest

from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.report.folder import made
from frictionjoint.report.joints import joint_content
from frictionjoint.report.page import render, render_robot
from frictionjoint.report.robot_report import RobotErrors, RobotReport, SharedCause
from frictionjoint.report.robot_summary import RobotSummary
from frictionjoint.robot.information import Information, Parameter, undetermined

PARTS = {
    "verdict": 'class="verdict partly-explained"',
    "shared cause": "<td>payload of gripper</td>",
    "could also be": "rotor inertia of elbow",
    "size": "mass 0.812\u00a0±\u00a00.020\u00a0kg",
    "not determined": "inertia 0.001\u00a0kg m²",
    "link to a joint": '<a href="joint_elbow.html">elbow</a>',
    "effect": ">cogging</td>",
    "friction": 'data-label="Coulomb">1.0',
    "picture": '"x_label":"velocity, rad/s"',
    "verdict of a joint": "partly explained, worse on held-out logs (torque)",
    "joint that failed": "the torque is zero",
    "undetermined": "<summary>1 group of parameters</summary>",
    "role": 'data-label="role">held out<',
    "command": "frictionjoint close-loop a.csv",
}


@pytest.fixture(scope="module")
def robot(demo_report) -> RobotReport:
    """Joints that the demo's report stands for, one of them visibly worse on held-out data."""
    r = demo_report
    before = r.before_torque
    worse = replace(
        r, verdict="partly-explained", after_torque=Rms(r.after_torque.fit, 2.0 * before.held_out)
    )
    hardly = replace(worse, after_torque=Rms(r.after_torque.fit, 1.002 * before.held_out))
    joints = {
        name: replace(report, increase=increase)
        for name, report, increase in (
            ("elbow", r, {}),
            ("wrist", worse, {"torque_rms": (0.8, 1.2)}),
            ("thumb", worse, {"torque_rms": (-0.1, 2.1)}),
            ("palm", hardly, {"torque_rms": (0.0001, 0.0003)}),
        )
    }
    payload = SharedCause(
        "payload",
        {"body": "gripper"},
        {"mass": Estimate(0.812, 0.02, "kg"), "inertia": Estimate(0.001, None, "kg m^2")},
        replace(r.added[0].evidence, ties=("rotor-inertia of elbow",)),
        {"elbow": (before, r.after_torque)},
    )
    return RobotReport(
        logs=r.logs,
        joints=joints,
        failed={"hand": "the torque is zero: check its column"},
        shared=(payload,),
        before=RobotErrors(Rms(12.0, 11.9), Rms(0.01, 0.011)),
        after=RobotErrors(Rms(2.0, 3.1), Rms(0.003, 0.0031)),
        undetermined=({"text": "Ixx of hand: no effect on these torques"},),
        excitation=None,
        mjcf="",
        seconds=63.2,
    )


@pytest.fixture(scope="module")
def page(robot) -> str:
    return render_robot(robot, content(robot))


def content(robot: RobotReport) -> dict:
    return robot.to_dict() | {"made": made("frictionjoint close-loop a.csv", robot.seconds)}


@pytest.mark.parametrize("part", PARTS)
def test_each_part_is_there(page, part):
    assert PARTS[part] in page


def test_the_page_of_a_joint_has_the_errors_of_the_robots_page(robot):
    s = RobotSummary(content(robot))
    for row in s.rows:
        own = render(robot.joints[row.joint], joint_content(content(robot), row.joint))
        for percent in row.torque.split(" → "):
            assert f"({percent})" in own
        shared = "Payload of gripper, see the robot's page; beyond this, " in html.unescape(own)
        assert shared == (row.joint == "elbow")


def test_a_robot_with_an_error_above_the_noise_is_not_explained(robot):
    elbow = robot.joints["elbow"]
    alone = replace(robot, failed={}, joints={"elbow": elbow})
    assert alone.verdict == "explained"
    noisy = replace(elbow, after_torque=Rms(1.6 * elbow.noise_floor, None))
    assert replace(alone, joints={"elbow": noisy}).verdict == "partly-explained"


def test_a_larger_error_within_its_interval_or_unseen_is_not_called_worse(page, robot):
    assert page.count("worse on held-out logs (torque)") == 1
    assert {n: r.worse for n, r in robot.joints.items() if r.worse} == {"wrist": ("torque_rms",)}


def test_no_cell_is_empty(page):
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page, re.DOTALL)
    assert len(cells) > 20
    assert all(re.sub(r"<[^>]+>", "", cell).strip() for cell in cells)


def test_the_summary_says_what_fell_and_what_did_not(robot):
    assert "torque 12% → 3.1% (mean of the joints)" in robot.summary().lower()
    assert "0.011 → 0.0031 rad, all joints together" in robot.summary()
    gripper = replace(robot.joints["thumb"], units=("N", "m"))
    mixed = replace(robot, joints=robot.joints | {"gripper": gripper})
    assert "0.011 → 0.0031 rad and m, all joints together" in mixed.summary()
    further = replace(robot, after=RobotErrors(Rms(2.0, 12.5), Rms(None, None)))
    assert "12% → 12% (mean of the joints), which is worse" in further.summary()
    (cause,) = robot.shared
    assert repr(robot).startswith("RobotReport(elbow: explained, wrist: partly-explained")
    assert len(robot.plot().axes) == 2 * len(robot.joints)
    doubted = replace(cause, evidence=replace(cause.evidence, p_value=0.3))
    text = replace(robot, shared=(doubted,)).summary()
    assert "not supported by these logs: payload of gripper (p = 0.3)" in text


def test_each_entry_of_what_is_undetermined_names_parameters_and_says_what_is_unknown():
    owned = (("arm", "mass"), ("hand", "mass"), ("hand", "Ixx"), ("hand", "Iyy"))
    columns = np.array([[1e3, 1e3, 0.0, 0.0], [2e3, 2e3, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    parameters = tuple(Parameter(owner, name, 1.0) for owner, name in owned)
    found = Information(parameters, columns.T @ columns)
    rows = undetermined(found, {"elbow": {"Fc": Estimate(1.0, 0.9, "N m")}})
    assert [row["text"] for row in rows] == [
        "mass of hand: only in sums with parameters of arm, assumed correct",
        "Ixx of hand: no effect on these torques",
        "Iyy of hand: known to no better than 50% of the model's own size",
        "friction of elbow: Coulomb friction",
    ]
