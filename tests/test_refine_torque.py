"""Numbers of a torque log refined by runs that its measured torque drives."""

import mujoco
import numpy as np
import pytest
from led import led

import frictionjoint as fj
from frictionjoint.measured.log import JointLog
from frictionjoint.simulate.carrier import read_friction

ARM = """<mujoco><option timestep="0.001"/><worldbody><body>
  <joint name="j" axis="0 1 0" armature="0.05" {}/>
  <inertial pos="0 0 -0.2" mass="1.5" diaginertia="0.01 0.01 0.01"/>
</body></worldbody></mujoco>"""
EVERY = 4


def log_of(lines, seed):
    """Stock MuJoCo with Coulomb and viscous friction; the torque wanders slowly, as one of a
    strain gauge does."""
    model = mujoco.MjModel.from_xml_string(ARM.format('frictionloss="0.6" damping="0.3"'))
    rng = np.random.default_rng(seed)
    n = 12_000
    time = 1e-3 * np.arange(n)
    target = sum(a * np.sin(2.0 * np.pi * f * time + p) for a, f, p in lines)
    torque, position = led(model, target, kp=60.0, kd=4.0)
    slow = np.convolve(rng.standard_normal(n + 400), np.ones(400) / 20.0, "same")[:n]
    return JointLog(
        name=f"log{seed}",
        joint="j",
        time=time[::EVERY],
        position=position[::EVERY] + 1e-5 * rng.standard_normal(n)[::EVERY],
        torque=(torque + 0.01 * slow)[::EVERY],
    )


@pytest.fixture(scope="module")
def report():
    fit = [log_of([(0.6, 0.3, 0.0), (0.2, 1.1, 1.0)], 1), log_of([(0.4, 0.7, 2.0)], 2)]
    held = [log_of([(0.5, 0.5, 0.5), (0.15, 1.7, 0.0)], 3)]
    return fj.close_loop(fit, ARM.format(""), "j", held, refine=True)


def test_a_refinement_is_reported_with_what_decides_it(report):
    content = report.to_dict()["refined"]
    guard = content["left_out_mae"]
    if content["taken"]:
        assert guard["after"] < guard["before"]
    else:
        assert report.to_dict()["after"]["parameters"]["Fs_pos"]["value"] > 0.0
    assert 0.0 < guard["after"] < 0.02


def test_the_model_carries_the_numbers_of_the_report(report):
    (carried,) = read_friction(mujoco.MjSpec.from_string(report.mjcf).compile()).values()
    assert carried == report.carried
    estimates = report.refined.parameters if report.refined.taken else report.final
    assert carried.parameters.sigma2_pos == pytest.approx(estimates["sigma2_pos"].value, rel=1e-6)


def test_the_refined_numbers_are_those_of_the_joint(report):
    found = {n: x.value for n, x in report.refined.parameters.items()}
    assert found["Fc_pos"] == pytest.approx(0.6, rel=0.05)
    assert found["sigma2_pos"] == pytest.approx(0.3, rel=0.1)
