"""``frictionjoint compare``: a law's known figures come out, as table, JSON and picture."""

import json
from dataclasses import replace

import numpy as np
import pytest
from command_line import run
from reports import good, put, robot

from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ParameterError
from frictionjoint.export.motion import stated_motion
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.parameters import FrictionParameters
from frictionjoint.report.compare import compared, draw, report_figures
from frictionjoint.report.joints import read_joints
from frictionjoint.rivals import StaticParameters

KNOTS = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))
A = FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.3, n=2, knots=KNOTS)
B = FrictionParameters.symmetric(Fs=1.2, Fc=1.0, Vs=0.02, n=1, knots=KNOTS)


def test_figures_are_those_of_the_law():
    a, b = compared({"a": JointFriction(A), "b": JointFriction(B)})
    assert a.figures["breakaway torque, N m"] == pytest.approx(1.5, rel=1e-3)
    assert b.figures["breakaway torque, N m"] == pytest.approx(1.2, rel=1e-3)
    # not that of the steep beginning, which a fit assumes
    steep = replace(A, knots=((1e-9, 0.01), *KNOTS))
    for parameters, own in ((A, a), (steep, compared({"c": JointFriction(steep)})[0])):
        found = own.figures["presliding stiffness, N m/rad"]
        assert found == parameters.stiffness == pytest.approx(A.stiffness, rel=0.01)
    # both are driven to the larger of the two speeds: 10 Vs of a, where only sigma2 is left of it
    speed, torque = a.curves[0]
    assert speed[-1] == 0.5
    assert torque[-1] == pytest.approx(1.0 + 0.3 * 0.5, rel=1e-3)
    assert np.allclose(torque, -torque[::-1], equal_nan=True)
    # a presliding loop takes work
    assert a.figures["work of one presliding loop, J"] > 0.0


def test_without_a_fall_the_stribeck_velocity_sets_no_speed():
    flat = FrictionParameters.symmetric(Fs=1.0, Fc=1.0, Vs=1e-4, sigma2=0.2, n=2, knots=KNOTS)
    (a,) = compared({"a": JointFriction(flat)})
    assert a.figures["torque at 1 rad/s, N m"] == pytest.approx(1.2)
    motion = stated_motion(flat, 0.0, None, "rad")
    assert motion.speeds.max() == pytest.approx(1.0, rel=1e-3)


def test_reports_in_folders_of_one_name_have_a_column_each(tmp_path, demo_report):
    for day in ("monday", "friday"):
        (tmp_path / day / "out").mkdir(parents=True)
        content = json.dumps(demo_report.to_dict())
        (tmp_path / day / "out" / "report.json").write_text(content)
    done = run("compare", "monday/out", "friday/out/report.json", "--json", cwd=tmp_path)
    assert list(json.loads(done.stdout)) == ["monday/out", "friday/out/report.json"]


@pytest.mark.parametrize(
    ("place", "value", "says"),
    [
        ("schema", "frictionjoint/report-9", "this version reads, its schema is 'frictionj"),
        ("joint", 3, "report.joint is 3: it must be text; make the report again"),
        ("after.torque_rms", {"fit": 1.0}, "report.after.torque_rms.held_out is missing"),
        ("added", [{}], "report.added.0.effect is missing"),
        ("notes", None, "report.notes is None: it must be a list"),
        ("verdict", "perfect", "report.verdict is 'perfect': it must be one of 'explained'"),
        ("base.parameters.n.value", np.nan, "base.parameters.n.value is nan"),
        ("after.parameters.Fc_neg.value", -1.0, "Fc_neg is -1: it must be 0 or more"),
        ("model.Fc_pos", np.nan, "Fc_pos is nan: give a finite number"),
        ("posterior", {"parameters": {}, "factor": [[1e300]]}, "factor.0.0 is 1e+300"),
    ],
)
def test_a_damaged_report_is_refused_with_its_file_and_place(tmp_path, place, value, says):
    assert all(read_joints(write(tmp_path, x))[1] for x in (good(), robot(elbow=good())))
    put(content := good(), place, value)
    with pytest.raises(ParameterError) as caught:
        read_joints(write(tmp_path, content))
    assert str(caught.value).startswith(f"{tmp_path / 'report.json'}: ")
    assert says in str(caught.value)


def write(folder, content):
    (folder / "report.json").write_text(json.dumps(content))
    return folder


def test_effects_are_named():
    effect = SimulatedEffect(
        CATALOGUE[0], (1.0,) * len(CATALOGUE[0].shape), (0.1,) * len(CATALOGUE[0].coefficients)
    )
    (a,) = compared({"a": JointFriction(A, (effect,))})
    assert a.figures["effects, not drawn"] == CATALOGUE[0].title


def test_a_dependence_without_a_name_is_not_called_nothing():
    content = good(added=[], unexplained=[{"variable": "log", "share": 0.5}])
    assert report_figures(content)["missing"] == "dependence on the recording"


def test_a_law_that_creeps_leaves_the_loops_of_others_as_they_are():
    creeping = StaticParameters.from_dict(
        {"Fs": 1.2, "Fc": 1.0, "Vs": 0.05, "sigma2": 0.1, "V0": 1e-3}
    )
    alone, (a, b) = (
        compared({"a": JointFriction(A)})[0],
        compared({"a": JointFriction(A), "b": JointFriction(creeping)}),
    )
    work = "work of one presliding loop, J"
    assert a.figures[work] == alone.figures[work] > 0.0
    assert work not in b.figures
    assert b.figures["at rest"] == "creeps"


@pytest.mark.parametrize(
    ("kind", "has"),
    [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".html", b"breakaway displacement, rad")],
)
def test_pictures_and_pages(kind, has):
    drawn = draw(compared({"a": JointFriction(A)}), kind)
    drawn = drawn.encode() if isinstance(drawn, str) else drawn
    assert has in drawn
    assert b'src="http' not in drawn
