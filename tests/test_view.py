"""`frictionjoint view` opens MuJoCo's viewer with friction, or says in a line why it cannot."""

import sys
import types

import mujoco
import pytest
from command_line import run

import frictionjoint as fj

FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
JOINT = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"


@pytest.fixture
def carrying(tmp_path):
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"j": FRICTION})
    (tmp_path / "arm.xml").write_text(spec.to_xml())
    return tmp_path


@pytest.fixture
def display(monkeypatch):
    """A display that is there, and what the viewer was asked to show."""
    shown = []

    def launch(model, data):
        data.qfrc_applied[0] = 0.5
        mujoco.mj_step(model, data, nstep=100)
        dragged = mujoco.MjModel.from_xml_string(shown[0]) if shown else model
        other = mujoco.MjData(dragged)
        other.qfrc_applied[0] = 0.5
        mujoco.mj_step(dragged, other, nstep=100)
        shown.append((float(data.qpos[0]), float(other.qpos[0])))

    viewer = types.ModuleType("mujoco.viewer")
    viewer.launch = launch
    glfw = types.ModuleType("glfw")
    glfw.init = lambda: True
    monkeypatch.setitem(sys.modules, "mujoco.viewer", viewer)
    monkeypatch.setitem(sys.modules, "glfw", glfw)
    return shown


def test_the_viewer_shows_friction_also_of_models_dragged_into_it(carrying, display):
    display.append((carrying / "arm.xml").read_text())
    done = run("view", "arm.xml", cwd=carrying)
    assert (done.returncode, done.stderr) == (0, "")
    for position in display[1]:
        assert 0.0 < position < 1e-3
    assert mujoco.get_mjcb_passive() is None


def test_without_a_display_one_line_says_so(carrying, display, monkeypatch):
    monkeypatch.setattr(sys.modules["glfw"], "init", lambda: False)
    done = run("view", "arm.xml", cwd=carrying)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "the viewer finds no display" in done.stderr
    assert display == []


def test_a_model_without_friction_is_refused(tmp_path, display):
    (tmp_path / "bare.xml").write_text(JOINT)
    done = run("view", "bare.xml", cwd=tmp_path)
    assert done.returncode == 2
    assert "has no friction" in done.stderr
    assert display == []
