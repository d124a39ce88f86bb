"""The comparison with BAM: its error, and the page it writes."""

import importlib.util
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from servo_loop import Servo, run_servo

from frictionjoint import FrictionParameters
from frictionjoint.measured.log import JointLog
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.motor import Motor, add_motor

_SPEC = importlib.util.spec_from_file_location(
    "compare_with_bam", Path(__file__).parents[2] / "lab" / "compare_with_bam.py"
)
compare = importlib.util.module_from_spec(_SPEC)
sys.modules["compare_with_bam"] = compare  # its dataclass looks itself up
_SPEC.loader.exec_module(compare)


@pytest.fixture(scope="module")
def model():
    spec = mujoco.MjSpec.from_file(str(compare.MODEL))
    add_motor(spec, compare.JOINT, Motor(0.1, 0.04))
    law = FrictionParameters.symmetric(Fs=0.03, Fc=0.02, Vs=0.1, knots=((1e-3, 0.06),))
    install(spec, {compare.JOINT: law})
    return spec.compile()


def log(position, target, time):
    metadata = {"kp": 400.0, "vin": 7.4}
    return JointLog(name="a", joint="pendulum", time=time, position=position, target=target,
                    voltage=np.zeros(len(time)), metadata=metadata)  # fmt: skip


def test_error_is_the_mean_distance_from_the_servo_s_motion(model):
    time = np.linspace(0.0, 2.0, 401)
    target = np.sin(2.0 * time)
    servo = Servo(400 * 4096 / (2 * np.pi) / (256 * 885), 7.4)
    moved = run_servo(model, "pendulum", log(0.0 * time, target, time), servo)
    assert np.ptp(moved) > 0.5
    assert compare.error(model, log(moved, target, time)) < 1e-12
    # apart by 0.1 rad from the first second on, where the start is the same
    apart = moved + 0.1 * (time > 1.0)
    assert compare.error(model, log(apart, target, time)) == pytest.approx(0.05, abs=1e-3)


def test_page_holds_every_row_and_says_what_ours_took():
    errors = dict(zip(compare.TRAJECTORIES, (0.01, 0.02, 0.03, 0.04), strict=True))
    found = [
        compare.Row(400, "ours", errors, 60.0, ("back-emf",), ("load",)),
        compare.Row(400, "BAM M3", errors, 300.0),
    ]
    text = compare.page(found, 77)
    assert "| 400 | ours | 0.0100 | 0.0200 | 0.0300 | 0.0400 | 0.0250 | 60 |" in text
    assert "| 400 | BAM M3 |" in text
    assert "77 trials" in text
    assert text.endswith(compare.PAGE.read_text().partition(compare.NOTES)[2])
    assert "Gain 400 held out: added back-emf; unexplained: load." in text


def test_missing_logs_are_said(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["compare_with_bam.py", "--data", str(tmp_path)])
    with pytest.raises(SystemExit, match="holds no logs"):
        compare.main()
