"""Logs of a whole robot: which joints are explained, and one that cannot be read stops no other."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from arms.arm import random_arm
from arms.fitted import joint_logs

from frictionjoint.errors import LogError
from frictionjoint.identify.matching import joints_to_explain
from frictionjoint.measured.readers import joints_with_drive
from frictionjoint.robot.close_loop import Options, close_loop_robot
from frictionjoint.robot.logs import RobotLogs

COLUMNS = {
    "j1": ("position_rad", "torque_nm"),
    "j2": ("position_rad", "torque_nm"),
    "j3": ("position_rad",),
}


def write(path, still: str = "", columns=COLUMNS) -> str:
    time = np.arange(0.0, 2.0, 0.01)
    table = {"time_s": time}
    for i, (joint, names) in enumerate(columns.items()):
        for name in names:
            x = np.sin((i + 1.0) * time)
            table[f"{joint}.{name}"] = 0.0 * x if joint == still and "position" in name else x
    rows = np.column_stack(list(table.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(table), comments="")
    return str(path)


@pytest.fixture
def model() -> str:
    return random_arm(1, 3).believed


def test_all_joints_with_a_drive_are_explained(tmp_path, model):
    log = write(tmp_path / "a.csv")
    assert joints_with_drive(log) == ["j1", "j2"]
    assert joints_to_explain([log], mujoco.MjModel.from_xml_string(model)) == ["j1", "j2"]
    logs = RobotLogs.read([log], [], 0.25, model)
    assert logs.joints == ["j1", "j2"]
    assert set(logs.moving) == {"j1", "j2", "j3"}
    assert [entry.role for entry in logs.entries] == ["fit", "held-out"]


def test_a_joint_that_stands_still_stops_no_other_unless_it_is_named(tmp_path, model):
    log = write(tmp_path / "a.csv", still="j2")
    logs = RobotLogs.read([log], [], 0.25, model)
    assert logs.joints == ["j1"]
    assert set(logs.failed) == {"j2"}
    assert "j2" not in logs.moving
    with pytest.raises(LogError, match="j2"):
        RobotLogs.read([log], [], 0.25, model, ["j1", "j2"])
    with pytest.raises(LogError, match="no joint 'j9', it has j1, j2, j3"):
        RobotLogs.read([log], [], 0.25, model, ["j1", "j9"])
    with pytest.raises(LogError, match="named twice"):
        RobotLogs.read([log], [], 0.25, model, ["j1", "j1"])
    with pytest.raises(LogError, match="not held out"):
        RobotLogs.read([], [log], None, model, ["j1"])


def test_a_log_of_other_joints_is_named(tmp_path, model):
    log = write(tmp_path / "a.csv")
    other = write(tmp_path / "b.csv", columns={"k1": COLUMNS["j1"]})
    with pytest.raises(LogError, match=r"^b\.csv: .* wanted is one of j1, j2, the columns name k1"):
        RobotLogs.read([log], [other], None, model)


def test_columns_that_name_no_joint_are_those_of_the_only_joint_of_a_model(tmp_path):
    log = tmp_path / "a.csv"
    log.write_text("time_s,position_rad,torque_nm\n")
    one = mujoco.MjModel.from_xml_string(random_arm(1, 1).believed)
    assert joints_to_explain([log], one) == ["j1"]


def test_joints_recorded_one_after_the_other_have_each_the_logs_in_which_they_move(tmp_path, model):
    logs = [write(tmp_path / f"{name}.csv", still=name) for name in ("j1", "j2")]
    found = RobotLogs.read(logs, [write(tmp_path / "held.csv", still="j2")], None, model)
    assert {j: [log.name for log in own] for j, own in found.fit.items()} == {
        "j1": ["j2"],
        "j2": ["j1"],
    }
    assert {j: len(own) for j, own in found.held_out.items()} == {"j1": 1, "j2": 0}
    assert found.at_rest == {"j1": ("j1",), "j2": ("j2", "held")}
    assert {e.name: e.role for e in found.entries} == {"j2": "fit", "j1": "fit", "held": "held-out"}
    assert not found.failed
    assert found.notes == (
        "j1: fitted without j1, at rest there.",
        "j2: fitted without j2, held, at rest there.",
    )


def test_a_joint_in_another_sign_or_unit_is_named():
    arm = random_arm(2, 2)
    j1, j2 = (logs[0] for logs in joint_logs(arm, (1,), 6.0).values())
    report = explained({"j1": j1, "j2": replace(j2, torque=-j2.torque)}, arm)
    assert (set(report.failed), set(report.joints), report.shared) == ({"j2"}, {"j1"}, ())
    turned = replace(j1, other_positions={"j2": -j2.position})
    with pytest.raises(LogError, match=r"^the positions of 'j2' have the wrong sign"):
        explained({"j1": turned, "j2": replace(j2, position=-j2.position)}, arm)
    far = np.degrees(j2.position)
    with pytest.raises(LogError, match=r"^'j2' turns by .* if that is in degrees"):
        explained({"j1": j1, "j2": replace(j2, position=far)}, arm)


def explained(logs, arm):
    each = RobotLogs({n: [x] for n, x in logs.items()}, {n: [] for n in logs}, {})
    return close_loop_robot(each, arm.believed, Options(jobs=1))


@pytest.mark.parametrize("what", ["", "the drives of ", "the positions of "])
def test_joints_that_are_exchanged_in_the_logs_are_named(what):
    arm = random_arm(31, 2)
    right = {joint: logs[0] for joint, logs in joint_logs(arm, (1,), 6.0).items()}
    position = {joint: log.position for joint, log in right.items()}
    wrong = {
        a: replace(right[b], joint=a, other_positions={b: position[a]})
        for a, b in (("j1", "j2"), ("j2", "j1"))
    }
    if what == "the drives of ":
        wrong = {a: replace(right[a], torque=log.torque) for a, log in wrong.items()}
    elif what:
        wrong = {a: replace(log, torque=right[a].torque) for a, log in wrong.items()}
    with pytest.raises(LogError, match=f"^{what}'j1' and 'j2' are exchanged in the logs"):
        explained(wrong, arm)
