"""The whole loop on the shipped log: an effect nobody declared is found, added and simulated."""

import json

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.report.folder import write_report


def test_the_undeclared_effect_is_found_first(demo_report):
    assert demo_report.added[0].effect == "position-periodic"
    assert demo_report.added[0].evidence.p_value <= 0.05
    assert demo_report.added[0].evidence.held_out_gain > 0.8


def test_its_parameters_are_those_of_the_plant(demo_report):
    # the plant's cogging is 0.3 N m sin(14 q + 0.7), see the shipped README
    found = demo_report.added[0].parameters
    amplitude = np.hypot(found["sin"].value, found["cos"].value)
    assert found["N"].value == pytest.approx(14.0, rel=0.01)
    assert amplitude == pytest.approx(0.3, rel=0.1)


def test_errors_fall_on_data_used_for_nothing(demo_report):
    assert demo_report.after_torque.held_out < 0.4 * demo_report.before_torque.held_out
    assert demo_report.after_replay.held_out < 0.4 * demo_report.before_replay.held_out
    (low, _), (_, high) = demo_report.torque_interval
    assert high < low, "the intervals before and after must not touch"


def test_the_simulated_model_carries_law_and_effect(demo_report, tmp_path):
    write_report(demo_report, tmp_path, "frictionjoint close-loop")
    from frictionjoint.simulate.carrier import read_friction

    model = fj.load_model(tmp_path / "model.xml")
    carried = read_friction(model)["joint"]
    assert "position-periodic" in [e.effect.name for e in carried.effects]
    data = mujoco.MjData(model)
    with fj.attach(model):
        torques = []
        for q in np.linspace(0, 2 * np.pi / 14, 40):
            mujoco.mj_resetData(model, data)
            data.qpos[0] = q
            mujoco.mj_forward(model, data)
            torques.append(-data.qfrc_passive[0])
    # at rest and never moved the law gives nothing: what is left is the ripple
    assert np.ptp(torques) == pytest.approx(0.6, rel=0.15)


def test_report_json_follows_the_schema(demo_report, tmp_path):
    write_report(demo_report, tmp_path, "frictionjoint close-loop")
    content = json.loads((tmp_path / "report.json").read_text())
    assert content["schema"] == "frictionjoint/report-1"
    assert [log["role"] for log in content["logs"]] == ["fit", "fit", "held-out"]
    assert content["base"]["law"] == "integrated"
    for name in ("Fs_pos", "Fc_neg", "Vs_pos", "sigma2_neg"):
        assert set(content["base"]["parameters"][name]) == {"value", "stderr", "unit"}
    for stage in ("before", "after"):
        for kind in ("torque_rms", "replay_rms"):
            assert set(content[stage][kind]) == {"fit", "held_out"}
    evidence = content["added"][0]["evidence"]
    assert {"held_out_gain", "p_value", "selection_frequency", "runner_up", "margin"} <= set(
        evidence
    )
    assert content["verdict"] in ("explained", "partly-explained")
    page = (tmp_path / "report.html").read_text()
    assert "position-periodic" in page
    assert 'src="http' not in page, "the page must be readable offline"
