"""What the viewer shows of a joint's friction: samples, figures, a frame off screen, a window."""

import os
import subprocess
import sys
import types
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scope import SLIP_COLOUR, STICK_COLOUR, Scope

import frictionjoint as fj
from frictionjoint.errors import ModelError
from frictionjoint.rivals import DahlParameters
from frictionjoint.simulate.stick_slip import JOINT, SPEED, kuka_model

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
VIEWPORT = mujoco.MjrRect(0, 0, 1000, 600)


@pytest.fixture(scope="module")
def run():
    """The KUKA joint pulled into stick-slip: model, data, scope and every sample."""
    model = fj.load_model(kuka_model())
    data, scope, samples = mujoco.MjData(model), Scope(model, JOINT), []
    with fj.attach(model):
        while data.time < 3.0:
            data.ctrl[0] = SPEED * data.time
            mujoco.mj_step(model, data)
            samples.append(scope.record(data))
    return model, data, scope, samples


def test_the_torque_shown_is_the_torque_that_acts(run):
    model, data, scope, _ = run
    with fj.attach(model):
        mujoco.mj_step(model, data)
        assert scope.record(data).torque == pytest.approx(fj.torque(model, data)[JOINT].total)


def test_stick_and_slip_alternate_and_agree_with_the_motion(run):
    *_, samples = run
    sticks = np.array([s.sticks for s in samples])
    speed = np.abs([s.velocity for s in samples])
    assert sticks[:200].all(), "before the first breakaway the joint sticks"
    assert 4 <= np.count_nonzero(np.diff(sticks)) <= 20
    assert speed[sticks].max() < 0.1 * speed.max()
    assert not sticks[speed > 0.1 * speed.max()].any()


def lines(figure: mujoco.MjvFigure):
    """Drawn lines as (x, y, colour)."""
    for i in range(len(figure.linepnt)):
        n = int(figure.linepnt[i])
        if n:
            xy = np.array(figure.linedata[i, : 2 * n]).reshape(n, 2)
            yield xy[:, 0], xy[:, 1], tuple(figure.linergb[i])


def test_figures_hold_the_last_seconds_in_two_colours(run):
    _, data, scope, samples = run
    (left, over_time), (right, loop) = scope.figures(VIEWPORT)
    assert left.left + left.width <= right.left
    drawn = list(lines(over_time))
    x = np.concatenate([line[0] for line in drawn])
    y = np.concatenate([line[1] for line in drawn])
    assert x.min() == pytest.approx(-data.time, abs=0.02)
    assert x.max() == 0.0
    assert y.max() == pytest.approx(max(s.torque for s in samples), rel=0.01)
    for colour in (STICK_COLOUR, SLIP_COLOUR):
        for figure in (over_time, loop):
            assert any(np.allclose(c, colour) for *_, c in lines(figure))
    # within presliding, in mrad about where it stuck: the knots end at 0.9 mrad
    assert max(np.abs(line[0]).max() for line in lines(loop)) < 1.0


def test_a_joint_without_friction_is_refused():
    with pytest.raises(ModelError, match="'wrist' has no friction: choose from joint1"):
        Scope(fj.load_model(kuka_model()), "wrist")


@pytest.fixture
def viewer():
    sys.path.insert(0, str(EXAMPLES))
    try:
        import viewer
    finally:
        sys.path.remove(str(EXAMPLES))
    assert isinstance(viewer, types.ModuleType)
    return viewer


def near(image, colour) -> int:
    """Pixels close to a colour."""
    wanted = 255 * np.array(colour)
    return int((np.abs(image.astype(float) - wanted).max(axis=2) < 12).sum())


def test_a_frame_off_screen_shows_both_colours(tmp_path):
    pytest.importorskip("imageio")
    script = [sys.executable, str(EXAMPLES / "viewer.py"), "--seconds", "1.6"]
    for gl in ("egl", "osmesa"):
        done = subprocess.run(
            [*script, "--frame", str(tmp_path / "frame.png")],
            env=os.environ | {"MUJOCO_GL": gl, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            timeout=120,
        )
        if done.returncode == 0:
            break
    else:
        pytest.skip(f"no OpenGL off screen here: {done.stderr.strip().splitlines()[-1]}")
    import imageio.v3 as imageio

    image = imageio.imread(tmp_path / "frame.png")
    assert image.shape == (720, 1280, 3)
    for colour in (STICK_COLOUR, SLIP_COLOUR):
        assert near(image[432:, :512], colour) > 100, "torque over time"
        assert near(image[432:, 768:], colour) > 20, "hysteresis loop"


def test_another_law_is_refused_in_one_line():
    spec = mujoco.MjSpec.from_string(
        '<mujoco><worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    fj.install(spec, {"j": DahlParameters.symmetric(Fc=1.0, sigma0=1e3)})
    with pytest.raises(ModelError, match="has the law dahl: only integrated"):
        Scope(spec.compile(), "j")
