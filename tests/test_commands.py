"""The public functions are listed, do what the commands do, and have plain signatures."""

import inspect
import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from test_cli import DEMO

import frictionjoint as fj
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ParameterError
from frictionjoint.files import read_parameters
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.law.motion import friction_torque
from frictionjoint.model_text import model_text, placed
from frictionjoint.parameters import FrictionParameters, knots_of
from frictionjoint.rivals import LuGreParameters

LAW = FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.3, stiffness=5000.0)


@pytest.mark.parametrize("name", fj.__all__)
def test_signatures_are_plain(name):
    text = str(inspect.signature(getattr(fj, name)))
    assert "lambda" not in text
    assert "0x" not in text
    assert "_NestedSequence" not in text
    assert inspect.getdoc(getattr(fj, name))


def test_identify_finds_the_friction_of_the_shipped_log():
    found = fj.identify([DEMO / "ramps.csv"], DEMO / "joint.xml", "joint")
    # the Coulomb torque of the simulated test joint is 1 N m
    assert 0.6 < found.parameters.Fc_pos < 1.5
    assert re.search(r"^Residual [\d.]+ of [\d.]+ N m rms \([\d.]+%\)\.$", found.residual)
    assert "close-loop" in replace(found, torque_rms=0.5 * found.drive_rms).residual
    assert re.search(r"Coulomb friction, forward Fc_pos: [\d.]+ ± [\d.]+ N m", found.summary())
    assert repr(found).startswith("Identified(joint='joint', parameters=FrictionParameters(Fs=")


def test_export_writes_what_the_command_writes(tmp_path):
    spec = mujoco.MjSpec.from_file(str(DEMO / "joint.xml"))
    fj.install(spec, {"joint": LAW})
    model = tmp_path / "arm.xml"
    model.write_text(spec.to_xml())
    done = fj.export(model, "c", tmp_path / "friction.h")
    assert (tmp_path / "friction.h").read_text() == done.text
    with pytest.raises(ParameterError, match="exists already"):
        fj.export(model, "c", tmp_path / "friction.h")
    with pytest.raises(ParameterError, match="give one of native"):
        fj.export(model, "rust", tmp_path / "friction.rs")


def test_a_log_is_drawn_as_it_was_measured():
    figure = fj.plot(DEMO / "ramps.csv")
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels[0] == "position, rad"
    assert labels.count("torque, N m") >= 2


def test_a_stiffness_stands_in_for_knots():
    assert LAW.stiffness == pytest.approx(5000.0)
    q = np.linspace(0.0, 1e-5, 20)
    # never moved, the first curve has this slope
    slope = friction_torque(LAW, np.arange(20.0), q)[-1] / q[-1]
    assert slope == pytest.approx(5000.0, rel=0.02)
    for given in ({}, {"stiffness": 1e3, "knots": ((1e-3, 3.2),)}):
        with pytest.raises(ParameterError, match="stiffness"):
            FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, **given)
    with pytest.raises(ParameterError, match="> 0"):
        knots_of(1.0, 0.0)


def test_a_short_file_gives_both_directions(tmp_path):
    file = tmp_path / "short.toml"
    file.write_text("Fs = 1.5\nFc = 1.0\nVs = 0.05\nsigma2 = 0.3\nstiffness = 5000\n")
    assert read_parameters(file).parameters == LAW
    file.write_text('law = "lugre"\nFs = 1.5\nFc = 1.0\nVs = 0.05\nsigma0 = 5000.0\n')
    assert read_parameters(file).parameters == LuGreParameters(
        Fs_pos=1.5, Fs_neg=1.5, Fc_pos=1.0, Fc_neg=1.0, Vs_pos=0.05, Vs_neg=0.05, sigma0=5000.0
    )
    for text, said in (
        ("Fs = 1.5\nFs_pos = 1.4\n", "Fs and Fs_pos are given"),
        ("Fs = 1.5\nFc = 1\nVs = 1\nstiffness = 1e3\nknots = [[1e-3, 4.0]]", "give one of them"),
        ("Fs = 1.5\nFc = 1.0\nVs = 0.05\nstiffness = -1\n", "stiffness is -1: it must be > 0"),
    ):
        file.write_text(text)
        with pytest.raises(ParameterError, match=said):
            read_parameters(file)


def test_a_model_says_what_it_carries(tmp_path):
    wave = next(e for e in CATALOGUE if e.name == "position-periodic")
    spec = mujoco.MjSpec.from_file(str(DEMO / "joint.xml"))
    effect = SimulatedEffect(wave, (14.0,), (0.3, -0.2))
    fj.install(spec, {"joint": LAW}, {"joint": [effect]})
    text = placed(model_text(spec, DEMO / "joint.xml"), tmp_path)
    (comment,) = re.findall(r"<!-- (.*?) -->", text)
    assert comment == (
        "Friction of joint joint, law integrated: Fs 1.5 N m (breakaway friction), Fc 1 N m "
        "(Coulomb friction), Vs 0.05 rad/s (Stribeck velocity), sigma2 0.3 N m s/rad (viscous "
        "friction), stiffness 5000 N m/rad (presliding stiffness); cogging: sine part "
        "0.3 N m, cosine part -0.2 N m, angular frequency 14 1/rad"
    )
    (tmp_path / "arm.xml").write_text(text)
    model = fj.load_model(tmp_path / "arm.xml")
    handle = fj.attach(model)
    assert repr(handle) == "Attached(acting, friction of joint)"
    handle.detach()
    assert repr(handle) == "Attached(detached, friction of joint)"
