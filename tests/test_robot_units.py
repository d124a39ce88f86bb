"""Several robots of one kind: which logs are whose, and how much the units differ."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from frictionjoint.cli.fits import robots_of
from frictionjoint.errors import FrictionJointError
from frictionjoint.identify.result import Estimate
from frictionjoint.parameter_meanings import SIDES
from frictionjoint.report.robot_report import Spread, UnitsReport
from tests.command_line import run

ROW = Spread(
    "elbow", "Fc_pos", "N m", {"a": Estimate(1.0, 0.3, "N m"), "b": Estimate(2.0, 0.4, "N m")}
)


def test_logs_belong_to_the_unit_they_are_given_with():
    found = robots_of(["a=x.csv", "b=y.csv", "a=z=1.csv"])
    assert found == {"a": [Path("x.csv"), Path("z=1.csv")], "b": [Path("y.csv")]}


@pytest.mark.parametrize("text", ["x.csv", "=x.csv", "a=", "a/b=x.csv", "..=x.csv"])
def test_a_unit_without_a_name_or_a_log_is_refused(text):
    with pytest.raises(FrictionJointError, match="--robot"):
        robots_of([text])


def test_spread_over_units_beside_the_error_of_one():
    assert ROW.mean == pytest.approx(1.5)
    assert ROW.deviation == pytest.approx(0.5**0.5)
    assert ROW.error == pytest.approx(((0.09 + 0.16) / 2) ** 0.5)
    assert Spread("elbow", "n", "1", {"a": Estimate(1.0, None, "1")}).error is None
    assert ROW.to_dict()["units"]["b"] == {"value": 2.0, "stderr": 0.4, "unit": "N m"}


def test_parameters_are_shown_in_words_and_once_for_both_directions():
    law = {f"{name}_{side}": Estimate(1.0, 0.1, "N m") for name in ("Fc", "Fs") for side in SIDES}
    law["Fs_neg"] = Estimate(2.0, 0.1, "N m")
    unit = SimpleNamespace(joints={"elbow": SimpleNamespace(final=law)}, shared=())
    report = UnitsReport({"a": unit, "b": unit}, {})
    labels = ["Coulomb friction", "breakaway friction, forward", "breakaway friction, backward"]
    assert [label for label, _ in report.rows] == [f"{x}, N m" for x in labels]
    assert len(report.spreads) == 4


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "no log"),
        (("a.csv", "--robot", "x=b.csv", "--robot", "y=c.csv"), "every log as NAME=LOG"),
        (("--robot", "b.csv"), "write NAME=LOG"),
        (("--robot", "x=a.csv", "--robot", "x=b.csv"), "comparing needs two robots"),
        (("--robot", "x=a.csv", "--robot", "y=a.csv"), "this log is given twice"),
        (("a.csv", "--joint", "elbow", "--scheduler", "tcp://x:1"), "omit it for one joint"),
        (("logs", "--held-out", "logs"), "at least one that is not held out"),
        (("a.csv", "--model", "other.xml"), "write PATTERN=MJCF"),
    ],
)
def test_what_does_not_go_together_is_one_line(tmp_path, arguments, said):
    (tmp_path / "arm.xml").write_text("<mujoco/>")
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "a.csv").touch()
    done = run("close-loop", *arguments, "--model", "arm.xml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()
