"""Parameter sets drawn from a posterior."""

import json

import mujoco
import numpy as np
import pytest
from command_line import run
from reports import good, robot
from typer.testing import CliRunner

import frictionjoint
from frictionjoint.cli import app
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.files import joint_friction
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.parameters import FrictionParameters
from frictionjoint.refine.posterior import Posterior
from frictionjoint.simulate.carrier import install

MEAN = np.array([-3.0, -1.0, -4.0, 0.05])
COV = np.diag([0.01, 0.04, 0.02, 1e-4])
COV[0, 3] = COV[3, 0] = 0.8 * np.sqrt(COV[0, 0] * COV[3, 3])
SPRING = next(e for e in CATALOGUE if e.name == "spring")


def friction(x):
    Fc = float(np.exp(x[0]))
    Fs = Fc * (1.0 + float(np.exp(x[1])))
    law = FrictionParameters.symmetric(
        Fs=Fs,
        Fc=Fc,
        Vs=0.2,
        delta=1.0,
        sigma2=float(np.exp(x[2])),
        knots=((0.002, 1.1 * Fs), (0.01, 2.0 * Fs)),
    )
    return JointFriction(law, (SimulatedEffect(SPRING, (), (float(x[3]), -0.01)),))


@pytest.fixture(scope="module")
def posterior():
    return Posterior.of(MEAN, COV, friction)


def test_draws_have_the_spread_and_the_correlation_of_the_fit(posterior):
    drawn = posterior.sample(4000, seed=1)
    level = np.log([x.parameters.Fc_pos for x in drawn])
    stiffness = np.array([x.effects[0].coefficients[0] for x in drawn])
    # of 4000 draws an rms is known to 1.1%
    assert np.std(level) == pytest.approx(0.1, rel=0.05)
    assert np.corrcoef(level, stiffness)[0, 1] == pytest.approx(0.8, abs=0.05)
    assert np.mean(level) == pytest.approx(MEAN[0], abs=0.01)


def test_what_stems_from_the_gain_of_the_drive_is_apart(posterior):
    """The first number takes the place of the gain: 0.8 of the spring's error follows it."""
    apart = Posterior.of(MEAN, COV, friction, has_gain=True)
    np.testing.assert_allclose(
        apart.factor @ apart.factor.T, posterior.factor @ posterior.factor.T, atol=1e-9
    )
    # the last number of the file is the spring's second coefficient
    whole, known = (np.sqrt(np.diag(x.cov)[-2]) for x in (posterior, apart))
    assert known == pytest.approx(0.6 * whole, rel=1e-3)
    again = Posterior.from_dict(apart.to_dict())
    np.testing.assert_array_equal(again.cov, apart.cov)


def test_every_set_drawn_is_valid_and_can_be_installed(posterior):
    wide = Posterior(posterior.content, 5.0 * posterior.factor)
    for x in wide.sample(200, seed=2):
        assert x.parameters.Fs_pos >= x.parameters.Fc_pos > 0.0
        assert x.parameters.knots[-1][1] >= x.parameters.Fs_pos + x.parameters.Fs_neg - 1e-12
    spec = mujoco.MjSpec.from_string(
        "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"
    )
    install(spec, {"j": x.parameters}, {"j": x.effects})
    model = spec.compile()
    with frictionjoint.attach(model):
        mujoco.mj_step(model, mujoco.MjData(model))


def test_the_command_writes_tables_that_make_friction(tmp_path, posterior):
    report, out = tmp_path / "report.json", tmp_path / "samples.json"
    report.write_text(json.dumps(good(posterior=posterior.to_dict())))
    assert run("sample", str(tmp_path), "--n", "7", "--out", str(out), cwd=tmp_path).returncode == 0
    tables = json.loads(out.read_text())
    assert [joint_friction(t) for t in tables] == list(posterior.sample(7))


def test_a_robot_report_asks_for_the_joint_and_one_of_several_for_the_robot(tmp_path, posterior):
    out = tmp_path / "samples.json"
    whole = robot(hip=good(posterior=posterior.to_dict()), knee=good())

    def drawn_of(report, *joint):
        (tmp_path / "report.json").write_text(json.dumps(report))
        return CliRunner().invoke(
            app, ["sample", str(tmp_path), "--n", "3", "--out", str(out), *joint]
        )

    for joint, words in (
        ((), "choose one with --joint: hip, knee"),
        (("--joint", "toe"), "no joint 'toe' in it, it has hip, knee"),
        (("--joint", "knee"), "no parameter uncertainty"),
    ):
        assert words in str(drawn_of(whole, *joint).exception)
    assert "folder of one of them" in str(drawn_of({"schema": "frictionjoint/units-1"}).exception)
    assert not out.exists()
    assert drawn_of(whole, "--joint", "hip").exit_code == 0
    tables = json.loads(out.read_text())
    assert [joint_friction(t) for t in tables] == list(posterior.sample(3))
