"""What `install` does with friction that is there: MuJoCo's own, and ours of an earlier time."""

import mujoco
import pytest
from command_line import run

import frictionjoint as fj
from frictionjoint.effects.gear import JOINT_ELASTICITY
from frictionjoint.errors import ModelError
from frictionjoint.files import toml_text
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.simulate.carrier import read_friction

HAND = """<mujoco>
  <worldbody>
    <body name="palm"><freejoint/><geom size=".1"/>
      <body name="thumb"><joint name="wrist"/><geom size=".1"/>
        <body name="tip"><joint axis="0 1 0"/><geom size=".1"/>
          <body><joint name="slide" type="slide" {attributes}/><geom size=".1"/></body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""


def law(Fs: float = 1.5) -> fj.FrictionParameters:
    return fj.FrictionParameters.symmetric(Fs=Fs, Fc=0.7 * Fs, Vs=0.05, knots=((1e-3, 3.2),))


def hand(attributes: str = "") -> mujoco.MjSpec:
    return mujoco.MjSpec.from_string(HAND.format(attributes=attributes))


SPRINGDAMPER = 'springdamper="0.5 1" stiffness="2"'


def test_clear_native_takes_the_damping_of_springdamper_and_leaves_its_spring():
    spec = hand(SPRINGDAMPER)
    before = spec.copy().compile()
    fj.install(spec, {"slide": law()}, clear_native=True)
    model = spec.compile()
    joint, dof = model.joint("slide").id, model.joint("slide").dofadr[0]
    assert before.dof_damping[dof] > 0.1
    assert model.dof_damping[dof] == 0.0
    assert model.jnt_stiffness[joint] == before.jnt_stiffness[joint] != 2.0
    read_again = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert read_again.dof_damping[dof] == 0.0


def test_friction_is_replaced_when_asked_and_takes_no_more_room():
    spec = hand()
    fj.install(spec, {"wrist": law(1.5), "slide": law(1.2)})
    room = spec.nuserdata
    with pytest.raises(ModelError, match=r"has friction already: install.*replace=True"):
        fj.install(spec, {"wrist": law(1.0)})
    fj.install(spec, {"wrist": law(1.0)}, replace=True)
    found = read_friction(spec.compile())
    assert spec.nuserdata == room
    assert {name: x.parameters for name, x in found.items()} == {
        "wrist": law(1.0),
        "slide": law(1.2),
    }


def test_friction_of_an_elastic_joint_is_replaced_with_its_spring():
    def elastic(frequency: float) -> dict[str, list[SimulatedEffect]]:
        return {"slide": [SimulatedEffect(JOINT_ELASTICITY, (frequency, 0.05), (1.0,))]}

    replaced, fresh = hand(), hand()
    fj.install(replaced, {"slide": law(1.5)}, elastic(10.0))
    fj.install(replaced, {"slide": law(1.0)}, elastic(12.0), replace=True)
    fj.install(fresh, {"slide": law(1.0)}, elastic(12.0))
    one, other = replaced.compile(), fresh.compile()
    assert one.nv == other.nv
    assert one.joint("slide_deflection").stiffness == pytest.approx(
        other.joint("slide_deflection").stiffness, rel=1e-9
    )


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "hand.xml").write_text(HAND.format(attributes=""))
    (tmp_path / "gear.toml").write_text(toml_text(law()))
    return tmp_path


def install(folder, *arguments):
    return run("install", *arguments, "--out", "out.xml", "--force", cwd=folder)


def test_all_skips_joints_without_a_name_and_says_so_in_one_line(folder):
    done = install(folder, "hand.xml", "--all", "gear.toml")
    assert done.returncode == 0, done.stderr
    assert "--all: 1 joint has no name and no friction, of body tip" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(read_friction(fj.load_model(folder / "out.xml"))) == ["wrist", "slide"]


def test_all_leaves_out_what_is_excluded(folder):
    done = install(folder, "hand.xml", "--all", "gear.toml", "--exclude", "wrist")
    assert done.returncode == 0, done.stderr
    assert list(read_friction(fj.load_model(folder / "out.xml"))) == ["slide"]
    done = install(folder, "hand.xml", "--all", "gear.toml", "--exclude", "writs")
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert (
        "--exclude writs: no hinge or slide joint has this name, there are wrist, slide"
        in done.stderr
    )
    done = install(folder, "hand.xml", "--joint", "wrist=gear.toml", "--exclude", "slide")
    assert (done.returncode, "requires --all TOML" in done.stderr) == (2, True)
