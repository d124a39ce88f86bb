"""Logs of a current whose torque nothing shows: friction is stated in A, and the report says so."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ParameterError
from frictionjoint.files import read_parameters
from frictionjoint.measured.log import JointLog
from frictionjoint.report.joint_report import Report
from frictionjoint.report.numbers import friction_card
from frictionjoint.report.page import render
from tests.command_line import run
from tests.three_sines import sines

N, DT = 6000, 2e-3
KT = 2.5
FC, SIGMA2 = 0.6, 0.2
FREE = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="j" axis="0 1 0"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 0.002 1"/></body></worldbody></mujoco>"""


def log() -> JointLog:
    """A light rotor on a level axis, slow, its current measured; friction in closed form."""
    rng = np.random.default_rng(5)
    t = DT * np.arange(N)
    q, v, a = sines(t, [(0.8, 0.1), (0.3, 0.23), (0.1, 0.4)])
    torque = 0.002 * a + FC * np.tanh(v / 0.01) + SIGMA2 * v
    current = torque / KT + 0.01 * rng.standard_normal(N)
    return JointLog(name="log", joint="j", time=t, position=q, current=current)


@pytest.fixture(scope="module")
def report() -> Report:
    return fj.close_loop([log()], FREE, "j")


def csv(folder: Path) -> Path:
    rows = np.column_stack([log().time, log().position, log().current])
    path = folder / "log.csv"
    np.savetxt(
        path, rows, "%.9g", delimiter=",", header="time_s,position_rad,current_a", comments=""
    )
    (folder / "free.xml").write_text(FREE)
    return path


def test_identify_states_friction_in_ampere(tmp_path: Path) -> None:
    arguments = ("identify", csv(tmp_path), "--model", "free.xml", "--joint", "j")
    done = run(*arguments, "--out", "j.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "The scale is not determined" in done.stdout
    assert "N m" not in done.stdout.replace("N m/A", "")
    held = tomllib.loads((tmp_path / "j.toml").read_text())
    assert held["unit"] == "A"
    assert held["Fc_pos"] == pytest.approx(FC / KT, rel=0.05)
    with pytest.raises(ParameterError, match=r"its friction is in A.*--gain"):
        read_parameters(tmp_path / "j.toml")


def test_a_known_motor_constant_gives_newton_metres(tmp_path: Path) -> None:
    arguments = ("identify", csv(tmp_path), "--model", "free.xml", "--joint", "j", "--json")
    done = run(*arguments, "--gain", KT, "--out", "j.toml", cwd=tmp_path)
    found = json.loads(done.stdout)
    assert found["unit"] == "N m"
    assert found["parameters"]["Fc_pos"]["unit"] == "N m"
    assert found["parameters"]["Fc_pos"]["value"] == pytest.approx(FC, rel=0.05)
    assert read_parameters(tmp_path / "j.toml").parameters.Fc_pos == pytest.approx(FC, rel=0.05)


def test_a_report_states_all_torques_in_ampere(report: Report) -> None:
    assert report.units == ("A", "rad")
    assert any("The scale is not determined" in note for note in report.notes)
    assert report.final["Fc_pos"].unit == "A"
    assert report.final["Fc_pos"].value == pytest.approx(FC / KT, rel=0.05)
    assert report.final["sigma2_pos"].unit == "A s/rad"
    assert "gain" not in report.final
    assert 0.001 < report.after_torque.held_out < 0.01
    assert "held-out logs; per cent of the measured current" in report.summary()
    page = render(report, report.to_dict())
    assert "The scale is not determined" in page
    assert '"y_label":"current, A"' in page


def test_nothing_is_simulated_with_a_friction_in_ampere(report: Report) -> None:
    assert (report.after_replay.fit, report.after_replay.held_out) == (None, None)
    assert report.to_dict()["units"] == {"torque": "A", "position": "rad"}
    assert "frictionjoint" not in report.mjcf


def test_a_gain_from_the_load_widens_the_errors() -> None:
    """Friction in N m is no better known than the torque of the motor."""
    heavy = FREE.replace(
        'pos="0 0 0" diaginertia="1 0.002 1"', 'pos="0 0 -.3" diaginertia="1 .01 1"'
    )
    own = log()
    loaded = replace(own, current=own.current + 0.3 * 9.81 * np.sin(own.position) / KT)
    found = fj.identify([loaded], heavy, "j")
    assert found.unit == "N m"
    gain, level = found.estimates["gain"], found.estimates["Fc_pos"]
    assert gain.value == pytest.approx(KT, rel=0.05)
    stated = friction_card(found.estimates)[-1]
    assert (stated.meaning, stated.text[-5:]) == ("motor constant", "N m/A")
    assert level.value == pytest.approx(FC, rel=0.05)
    assert level.stderr > 0.3 * level.value * gain.stderr / gain.value
