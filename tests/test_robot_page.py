"""The page of a whole robot: causes and effects by their names for people, no cell empty."""

import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from frictionjoint.cli.robot import show_robot
from frictionjoint.diagnose.rms import Rms
from frictionjoint.identify.result import Estimate
from frictionjoint.report.robot_wording import whole
from frictionjoint.report.write_robot import page_names, render_robot
from frictionjoint.robot.report_data import (
    JointResult,
    RobotErrors,
    RobotReport,
    SharedCause,
    notes_of,
)

PARTS = {
    "verdict": 'class="verdict partly-explained"',
    "shared cause": "payload of gripper (or rotor inertia of elbow: these logs cannot",
    "size": "mass 0.812\u00a0±\u00a00.020\u00a0kg",
    "not determined": "inertia 0.001\u00a0kg m²",
    "link to a joint": '<a href="joint_elbow.html">elbow</a>',
    "effect": "cogging (position-periodic)",
    "verdict of a joint": "partly explained, worse on held-out data (torque)",
    "joint that failed": "the torque is zero",
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
        name: JointResult(report, r.base, "integrated", before, r.before_replay, increase)
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
        undetermined=(),
        excitation=None,
        mjcf="",
        seconds=63.2,
    )


@pytest.fixture(scope="module")
def page(robot) -> str:
    return render_robot(robot, page_names(list(robot.joints)), "frictionjoint close-loop a.csv")


@pytest.mark.parametrize("part", PARTS)
def test_each_part_is_there(page, part):
    assert PARTS[part] in page


def test_a_shared_cause_has_the_errors_of_each_joint(page, demo_report):
    r = demo_report
    ends = (100.0 * x.held_out / r.measured_rms for x in (r.before_torque, r.after_torque))
    assert "elbow {:.2g}% to {:.2g}%".format(*ends) in page


def test_a_larger_error_within_its_interval_or_unseen_is_not_called_worse(page, robot):
    assert page.count("worse on held-out data") == 1
    assert {n: r.worse for n, r in robot.joints.items() if r.worse} == {"wrist": ("torque_rms",)}


def test_no_cell_is_empty(page):
    cells = re.findall(r"<td[^>]*>(.*?)</td>", page, re.DOTALL)
    assert len(cells) > 20
    assert all(re.sub(r"<[^>]+>", "", cell).strip() for cell in cells)


def test_the_sentence_says_what_fell_and_what_did_not(robot):
    assert whole(robot) == (
        "The torque error falls from 11.9% to 3.1% of the rms torque (mean of the joints, held-out "
        "data). The position error falls from 0.011 rad to 0.0031 rad rms when all joints are "
        "simulated together, restarted from the log every 0.5 s."
    )
    further = replace(robot, after=RobotErrors(Rms(2.0, 12.0), Rms(None, None)))
    assert whole(further) == (
        "The torque error rises from 11.9% to 12% of the rms torque (mean of the joints, held-out "
        "data)."
    )


def test_joints_that_move_farther_together_on_fitted_data_are_told(robot):
    before = RobotErrors(Rms(10.0, 12.0), Rms(0.046, 0.05))
    after = RobotErrors(Rms(2.0, 3.0), Rms(1.15, 0.04))
    text = whole(replace(robot, before=before, after=after))
    assert "On the fitted data it rises from 0.046 to 1.15 rad" in text


def test_position_errors_have_their_unit_and_a_dash_its_reason(robot, page, capsys):
    dash = "–: no position error is stated, since the simulation leaves the logged motion"
    show_robot(robot)
    told = capsys.readouterr().out
    assert f"{robot.joints['elbow'].before_replay.held_out:.3g}\u00a0rad" in told
    assert dash not in told + page
    lost = replace(robot.joints["elbow"], before_replay=Rms(None, None))
    astray = replace(robot, joints=robot.joints | {"elbow": lost})
    show_robot(astray)
    assert dash in capsys.readouterr().out
    assert dash in render_robot(astray, page_names(list(robot.joints)), "")


def test_a_note_says_whose_it_is_unless_it_is_that_of_all():
    def noted(*notes):
        return SimpleNamespace(report=SimpleNamespace(notes=notes))

    notes = notes_of({"j1": noted("a gap", "held"), "j2": noted("held"), "j3": noted("held")})
    assert notes == ("j1: a gap", "held")
