"""Commands to look with: plot, inspect, compare; what they write and refuse to overwrite."""

import json
import re

import numpy as np
import pytest
from command_line import run
from reports import empty, good, robot
from test_cli import LOG

from frictionjoint.files import toml_text
from frictionjoint.parameters import FrictionParameters

LAW = FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.3, stiffness=5000.0)
ARM = """<mujoco><worldbody><body><joint name="hinge" axis="0 1 0" frictionloss="0.4"/>
<geom size=".1"/><body><joint name="rail" type="slide" damping="2"/><geom size=".1"/><body>
<joint name="free_one"/><geom size=".1"/></body></body></body></worldbody></mujoco>"""


def test_a_log_is_drawn_and_described(tmp_path):
    done = run("plot", LOG, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.search(r"ramps, joint: 2998 samples, 12 s, 250 Hz, position .* rad", done.stdout)
    page = (tmp_path / "ramps.html").read_text()
    assert '"y_label":"torque, N m"' in page
    assert "<script src" not in page
    again = run("plot", LOG, cwd=tmp_path)
    assert again.returncode == 2
    assert "ramps.html exists already: give another --out, or --force" in again.stderr
    assert run("plot", LOG, "--force", cwd=tmp_path).returncode == 0
    picture = run("plot", LOG, "--out", "log.png", cwd=tmp_path)
    assert picture.returncode == 0, picture.stderr
    assert (tmp_path / "log.png").read_bytes().startswith(b"\x89PNG")
    assert "must end in .html" in run("plot", LOG, "--out", "log.pdf", cwd=tmp_path).stderr


def test_rows_without_a_number_are_left_out_when_asked(tmp_path):
    head, *rows = LOG.read_text().splitlines()
    for k in (10, 500):
        rows[k] = ",".join([*rows[k].split(",")[:-1], "nan"])
    (tmp_path / "gaps.csv").write_text("\n".join([head, *rows]))
    refused = run("plot", "gaps.csv", cwd=tmp_path)
    assert refused.returncode == 2
    assert "row 12" in refused.stderr
    assert "--drop-nan" in refused.stderr
    done = run("plot", "gaps.csv", "--drop-nan", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2 of 2998 rows with an empty cell or NaN were left out" in done.stdout
    # a torque may leap: it is not repaired, but mentioned
    cells = rows[300].split(",")
    rows[300] = ",".join([*cells[:2], "99", *cells[3:]])
    (tmp_path / "gaps.csv").write_text("\n".join([head, *rows]))
    done = run("plot", "gaps.csv", "--drop-nan", "--force", cwd=tmp_path)
    assert "torque_nm: 1 outlier (first in sample 300: 99): if they are wrong" in done.stdout
    # a fault further down keeps its own line number
    rows[600] = ",".join([rows[599].split(",")[0], *rows[600].split(",")[1:]])
    (tmp_path / "gaps.csv").write_text("\n".join([head, *rows]))
    assert "row 602" in run("plot", "gaps.csv", "--drop-nan", "--force", cwd=tmp_path).stderr


def test_inspect_prints_friction_in_the_units_of_each_joint(tmp_path):
    (tmp_path / "p.toml").write_text(toml_text(LAW))
    (tmp_path / "arm.xml").write_text(ARM)
    done = run("install", "arm.xml", "--joint", "rail=p.toml", "--out", "with.xml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = run("inspect", "with.xml", cwd=tmp_path).stdout
    assert re.search(
        r"hinge: MuJoCo's own friction\n  Coulomb friction +frictionloss +0.4 N m", told
    )
    assert re.search(r"rail: law integrated\n(?:.*\n)*?  viscous friction +sigma2 +0.3 N s/m", told)
    assert "free_one: no friction" in told
    rows = json.loads(run("inspect", "with.xml", "--json", cwd=tmp_path).stdout)
    numbers = {x["symbol"]: x["value"] for x in rows[1]["numbers"]}
    assert numbers["stiffness"] == pytest.approx(5000.0)
    of_file = run("inspect", "p.toml", cwd=tmp_path).stdout
    assert "units of a hinge" in of_file
    assert "presliding stiffness" in of_file


def test_reports_are_compared(tmp_path):
    for name, content in (("a", good()), ("b", empty()), ("r", robot(elbow=good()))):
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.json").write_text(json.dumps(content))
    (tmp_path / "p.toml").write_text(toml_text(LAW))
    given = ("a/report.json", "b/report.json", "r", "p.toml")
    found = json.loads(run("compare", *given, "--json", cwd=tmp_path).stdout)
    assert list(found) == ["a", "b", "r elbow", "p"]
    assert found["a"]["missing"] == "cogging"
    assert found["b"]["missing"] == "nothing found"
    assert found["a"]["torque error after, held-out logs"] == "0.025\u00a0N m (1%)"
    assert found["a"]["Coulomb friction"].startswith("1.000")
    assert found["p"]["breakaway torque, N m"] == pytest.approx(1.5, rel=1e-3)
    told = run("compare", *given, "--out", "c.html", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert "nothing found" in told.stdout
    (tmp_path / "x.json").write_text("[]")
    refused = run("compare", "x.json", cwd=tmp_path)
    assert refused.returncode == 2
    assert "x.json: not a report" in refused.stderr


def test_a_demo_goes_where_it_is_asked_to(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "report.json").write_text("{}")
    refused = run("demo", "--out", "mine", cwd=tmp_path)
    assert refused.returncode == 2
    assert "mine/report.json exists already" in refused.stderr
    assert np.array_equal([x.name for x in (tmp_path / "mine").iterdir()], ["report.json"])
