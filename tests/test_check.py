"""`check` says per joint how stiff and damped it is for the time step, and what does not act."""

import json

import mujoco
import pytest
from command_line import run

import frictionjoint as fj
from frictionjoint.effects.rigid_body import SPRING
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.check import check

STEP, INERTIA = 1e-3, 0.01
ONE = """<mujoco><option timestep="{step}" integrator="{integrator}">{flags}</option>
<worldbody><body>
<joint name="j" {attributes}/><inertial pos="0 0 0" mass="1" diaginertia="{J} {J} {J}"/>
</body></worldbody></mujoco>"""


def joint(
    ratio=0.5, damping_ratio=0.1, integrator="implicitfast", flags="", attributes="", effects=()
) -> mujoco.MjSpec:
    """One joint with these h sqrt(K/J) and h sigma/J."""
    xml = ONE.format(
        step=STEP, integrator=integrator, flags=flags, attributes=attributes, J=INERTIA
    )
    spec = mujoco.MjSpec.from_string(xml)
    K, sigma = INERTIA * (ratio / STEP) ** 2, damping_ratio * INERTIA / STEP
    law = fj.FrictionParameters.symmetric(
        Fs=1.0,
        Fc=0.7,
        Vs=0.05,
        sigma1=0.25 * sigma,
        sigma2=0.75 * sigma,
        knots=((1.0 / K, 1.0), (10.0 / K, 2.1)),
    )
    fj.install(spec, {"j": law}, {"j": list(effects)})
    return spec


def row(**given) -> dict:
    (found,) = check(joint(**given).compile())
    return found


@pytest.mark.parametrize("ratio", [0.3, 3.0, 800.0])
@pytest.mark.parametrize("damping_ratio", [0.0, 0.5, 500.0])
def test_ratios_are_those_of_the_joint_and_implicit_friction_takes_them(ratio, damping_ratio):
    found = row(ratio=ratio, damping_ratio=damping_ratio)
    assert found["step_ratio"] == pytest.approx(ratio)
    assert found["damping_ratio"] == pytest.approx(damping_ratio)
    assert (found["implicit"], found["outside"]) == (True, [])
    resolved = "the time step resolves" in found["remark"]
    assert resolved == (ratio <= 1.0)


def test_a_joint_beyond_what_is_tested_is_outside():
    found = row(ratio=1500.0, damping_ratio=2000.0)["outside"]
    assert found[0].startswith("h sqrt(K/J) is 1.5e+03, above 1000, to which joints are tested")
    assert found[1].startswith("h sigma/J is 2e+03, above 1000")


@pytest.mark.parametrize(("ratio", "damping_ratio"), [(3.0, 0.1), (0.5, 3.0)])
def test_rk4_is_explicit_and_has_narrow_limits(ratio, damping_ratio):
    found = row(ratio=ratio, damping_ratio=damping_ratio, integrator="RK4")
    assert not found["implicit"]
    (sentence,) = found["outside"]
    assert (
        "above 2, to which joints are tested with RK4: use the integrator implicitfast" in sentence
    )
    assert row(ratio=1.9, damping_ratio=1.9, integrator="RK4")["outside"] == []


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"attributes": 'damping="0.1"'}, "counts twice, with MuJoCo's own damping 0.1: clear it"),
        ({"attributes": 'springdamper="0.5 1"'}, "counts twice, with MuJoCo's own damping"),
        ({"flags": '<flag spring="disable" damper="disable"/>'}, "friction does not act: spring"),
        (
            {"effects": [SimulatedEffect(SPRING, (), (9e4, 0.0))]},
            "effect spring is an explicit spring with h sqrt(k/J) = 3",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore:friction counts twice")
def test_what_acts_twice_or_not_at_all_is_outside(given, words):
    (sentence,) = row(**given)["outside"]
    assert words in sentence


def test_strict_fails_where_a_joint_is_outside_its_limits(tmp_path):
    (tmp_path / "good.xml").write_text(joint().to_xml())
    (tmp_path / "bad.xml").write_text(joint(ratio=5.0, integrator="RK4").to_xml())
    good = run("check", "good.xml", "--strict", cwd=tmp_path)
    assert (good.returncode, good.stderr) == (0, "")
    assert "Integrator IMPLICITFAST: friction is implicit" in good.stdout
    assert run("check", "bad.xml", cwd=tmp_path).returncode == 0
    bad = run("check", "bad.xml", "--strict", cwd=tmp_path)
    assert bad.returncode == 1
    assert "j: problem: h sqrt(K/J) is 5" in bad.stdout
    as_json = run("check", "bad.xml", "--strict", "--json", cwd=tmp_path)
    assert as_json.returncode == 1
    (found,) = json.loads(as_json.stdout)
    assert len(found["outside"]) == 1
