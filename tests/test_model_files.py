"""Models that are written find their meshes wherever they lie; URDFs are read; nothing is lost."""

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest
from command_line import run

import frictionjoint as fj
from frictionjoint.errors import FrictionJointError, ModelError
from frictionjoint.files import toml_text
from frictionjoint.model_files import compile_model, read_spec
from frictionjoint.model_text import model_text, placed
from frictionjoint.simulate.carrier import read_friction

FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
OTHER = fj.FrictionParameters.symmetric(Fs=0.3, Fc=0.2, Vs=0.05, knots=((1e-3, 3.2),))


def stl(path: Path, size: float) -> None:
    """A tetrahedron as a binary STL file."""
    corners = size * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
    faces = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    body = b"".join(bytes(12) + corners[list(face)].tobytes() + bytes(2) for face in faces)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(bytes(80) + struct.pack("<I", len(faces)) + body)


def png(path: Path, colour: int) -> None:
    """A picture of four by four pixels, with a darker corner."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    rows = b"".join(bytes([0, *[colour, colour, colour] * 3, 9, 9, 9]) for _ in range(4))
    head = struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0)
    parts = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)


ARM = """
<mujoco>
  <compiler meshdir="assets" texturedir="pictures"/>
  <include file="parts/more.xml"/>
  <asset>
    <mesh file="link.stl"/>
    <texture name="wood" type="2d" file="wood.png"/>
    <texture name="box" type="cube" fileright="r.png" fileleft="wood.png" fileup="r.png"
      filedown="wood.png" filefront="wood.png" fileback="r.png"/>
    <material name="wood" texture="wood"/>
    <hfield name="ground" file="../pictures/wood.png" size="1 1 .1 .1"/>
    <model name="gripper" file="../gripper/gripper.xml"/>
  </asset>
  <worldbody>
    <geom type="hfield" hfield="ground" pos="0 0 -2"/>
    <body name="link"><joint name="a" axis="0 1 0" damping="0.4"/>
      <geom type="mesh" mesh="link" material="wood"/>
      <body pos="0 0 .2"><joint name="b" type="slide" frictionloss="0.2"/>
        <geom type="mesh" mesh="inner"/>
        <attach model="gripper" body="hand" prefix="g_"/></body></body>
  </worldbody>
</mujoco>
"""
MORE = "<mujoco><asset><mesh name='inner' file='deep/inner.stl'/></asset></mujoco>"
GRIPPER = """
<mujoco>
  <compiler meshdir="{meshes}"/>
  <asset><mesh file="finger.stl"/></asset>
  <worldbody><body name="hand"><joint name="c"/><geom type="mesh" mesh="finger"/></body></worldbody>
</mujoco>
"""


@pytest.fixture
def home(tmp_path) -> Path:
    """A folder with an arm of meshes in several folders, and parameters."""
    arm = tmp_path / "robot" / "arm"
    stl(arm / "assets" / "link.stl", 0.1)
    stl(arm / "assets" / "deep" / "inner.stl", 0.2)
    png(arm / "pictures" / "wood.png", 120)
    png(arm / "pictures" / "r.png", 40)
    (arm / "parts").mkdir()
    (arm / "parts" / "more.xml").write_text(MORE)
    (arm / "arm.xml").write_text(ARM)
    gripper = tmp_path / "robot" / "gripper"
    stl(gripper / "shapes" / "finger.stl", 0.05)
    (gripper / "gripper.xml").write_text(GRIPPER.format(meshes="shapes"))
    (tmp_path / "f.toml").write_text(toml_text(FRICTION))
    (tmp_path / "other.toml").write_text(toml_text(OTHER))
    return tmp_path


def files_in(folder: Path) -> set[str]:
    return {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}


def install(home, *arguments):
    return run("install", "robot/arm/arm.xml", *arguments, cwd=home)


@pytest.mark.parametrize(
    "out", ["robot/arm/with.xml", "with.xml", "new/deep/with.xml", "link/w.xml"]
)
def test_an_installed_model_finds_its_files_from_wherever_it_lies(out, home):
    (home / "elsewhere" / "here").mkdir(parents=True)
    (home / "link").symlink_to(home / "elsewhere" / "here")
    done = install(home, "--joint", "a=f.toml", "--joint", "g_c=other.toml", "--out", out)
    assert done.returncode == 0, done.stderr
    model = fj.load_model(home / out)
    before = mujoco.MjModel.from_xml_path(str(home / "robot" / "arm" / "arm.xml"))
    for key in ("mesh_vert", "mesh_face", "tex_data", "hfield_data"):
        np.testing.assert_array_equal(getattr(model, key), getattr(before, key))
    carried = read_friction(model)
    assert {n: x.parameters for n, x in carried.items()} == {"a": FRICTION, "g_c": OTHER}
    moves = str(home) not in (home / out).read_text()
    assert moves is ("link" not in out), "relative, or the folder could not be moved as a whole"
    with fj.attach(model):
        mujoco.mj_step(model, mujoco.MjData(model), nstep=100)


def test_what_would_not_load_where_it_is_to_lie_leaves_nothing(home):
    spec = read_spec(home / "robot" / "arm" / "arm.xml")
    text = model_text(spec, home / "robot" / "arm" / "arm.xml")
    from frictionjoint.model_text import require_compiles
    from frictionjoint.report.write import write_files

    before = files_in(home)
    for folder in (home / "new" / "deeper", home):
        broken = placed(text, folder).replace("link.stl", "lonk.stl")
        with pytest.raises(ModelError, match=r"would not load.*lonk\.stl"):
            write_files(folder, {"w.xml": broken}, {"w.xml": require_compiles})
        assert files_in(home) == before
        assert not (home / "new").exists()


def test_native_friction_is_named_by_install_attach_and_check(home):
    done = install(home, "--all", "f.toml", "--out", "with.xml")
    assert done.returncode == 0
    assert len(done.stderr.strip().splitlines()) == 1
    for words in ("'a' has damping 0.4", "'b' has frictionloss 0.2", "--clear-native"):
        assert words in done.stderr
    assert "'g_c'" not in done.stderr
    model = fj.load_model(home / "with.xml")
    assert set(read_friction(model)) == {"a", "b", "g_c"}
    with pytest.warns(RuntimeWarning, match=r"counts twice.*'a' has damping 0\.4"):
        fj.attach(model).detach()
    told = run("check", "with.xml", "--json", cwd=home).stdout
    assert '"native": "damping 0.4"' in told
    assert "friction counts twice" in told


def test_uninstall_gives_back_the_model_without_friction(home):
    assert install(home, "--all", "f.toml", "--out", "with.xml").returncode == 0
    done = run("uninstall", "with.xml", "--out", "robot/without.xml", cwd=home)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "Wrote robot/without.xml without the friction of a, b, g_c.\n"
    model = compile_model(home / "robot" / "without.xml")
    assert (model.nnumeric, model.nuserdata) == (0, 0)
    done = run("uninstall", "robot/without.xml", "--out", "x.xml", cwd=home)
    assert done.returncode == 2
    assert "has no friction" in done.stderr
    assert not (home / "x.xml").exists()


URDF = """<?xml version="1.0"?>
<robot name="arm">{more}
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="link"><inertial><mass value="1"/>
    <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="{visual}"/></geometry></visual>
    <collision><geometry><mesh filename="{collision}"/></geometry></collision></link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/>
    <dynamics damping="0.3" friction="0.2"/></joint>
</robot>
"""


def urdf(package: Path, visual: str, collision: str, more: str = "") -> Path:
    path = package / "urdf" / "arm.urdf"
    path.write_text(URDF.format(more=more, visual=visual, collision=collision))
    return path


KEEP_VISUAL = '<mujoco><compiler discardvisual="false"/></mujoco>'


@pytest.fixture
def package(tmp_path) -> Path:
    """A ROS package "arm_description" with meshes of equal names, and its urdf folder."""
    package = tmp_path / "ws" / "arm_description"
    stl(package / "meshes" / "visual" / "link.stl", 0.2)
    stl(package / "meshes" / "collision" / "link.stl", 0.1)
    (package / "urdf").mkdir()
    (tmp_path / "f.toml").write_text(toml_text(FRICTION))
    return package


def size(model: mujoco.MjModel) -> float:
    """Of the tetrahedron that is the model's mesh; MuJoCo turns it into its principal axes."""
    corners = model.mesh_vert.astype(float)
    return float(np.linalg.norm(corners[:, None] - corners, axis=2).max() / np.sqrt(2))


@pytest.mark.parametrize(
    "where",
    [
        "package://arm_description/meshes/collision/link.stl",
        "package://renamed/meshes/collision/link.stl",
        "file://{package}/meshes/collision/link.stl",
        "{package}/meshes/collision/link.stl",
        "../meshes/collision/link.stl",
    ],
)
def test_a_urdf_gets_friction_and_keeps_its_meshes(where, package, tmp_path):
    collision = where.format(package=package)
    path = urdf(package, collision.replace("collision", "visual"), collision)
    given = ("install", path, "--all", "f.toml", "--clear-native")
    done = run(*given, "--out", "out/arm.xml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    model = fj.load_model(tmp_path / "out" / "arm.xml")
    assert size(model) == pytest.approx(0.1, rel=1e-5)
    assert model.dof_damping[0] == model.dof_frictionloss[0] == 0.0
    assert list(read_friction(model)) == ["elbow"]


def test_shapes_whose_meshes_are_nowhere_are_left_out_and_said(package, recwarn):
    """Masses are the URDF's own, and a robot's dynamics needs no shape."""
    visual, collision = "package://x/gone.dae", "package://x/meshes/collision/gone.stl"
    with pytest.warns(RuntimeWarning, match=r"meshes not found: .*gone\.stl; the"):
        model = compile_model(urdf(package, visual, collision))
    assert (model.nmesh, float(model.body("link").mass[0])) == (0, 1.0)
    seen = urdf(package, visual, "../meshes/collision/link.stl", KEEP_VISUAL)
    with pytest.warns(RuntimeWarning, match=r"meshes not found: .*gone\.dae; the"):
        assert compile_model(seen).nmesh == 1
    # what is only looked at is not needed
    path = urdf(package, visual, collision.replace("gone", "link").replace("x", "y", 1))
    recwarn.clear()
    assert compile_model(path).nmesh == 1
    assert not recwarn.list


def test_a_mesh_that_a_link_has_its_mass_of_is_needed(package):
    path = urdf(package, "x.dae", "package://x/gone.stl")
    head, _, rest = path.read_text().partition('<link name="link"><inertial>')
    path.write_text(head + '<link name="link">' + rest.partition("</inertial>")[2])
    with pytest.raises(FrictionJointError, match=r"gone\.stl of links that move and have no "):
        read_spec(path)


HALVES = """<inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial>"""
UNBALANCED = {
    "arm.urdf": f"""<robot name="arm">{{}}<link name="base"/><link name="tip">{HALVES}</link>
      <joint name="j" type="continuous"><parent link="base"/><child link="tip"/></joint></robot>""",
    "arm.xml": """<mujoco>{}<worldbody><body><joint name="j"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 3"/></body></worldbody></mujoco>""",
}


@pytest.mark.parametrize(
    ("name", "mend"),
    [
        ("arm.urdf", '<mujoco><compiler balanceinertia="true"/></mujoco>'),
        ("arm.xml", '<compiler balanceinertia="true"/>'),
    ],
)
def test_an_inertia_that_no_body_has_is_refused_with_its_mend(name, mend, tmp_path):
    path = tmp_path / name
    path.write_text(UNBALANCED[name].format(""))
    with pytest.raises(ModelError) as refused:
        compile_model(path)
    assert f"write {mend} inside <" in str(refused.value)
    path.write_text(UNBALANCED[name].format(mend))
    assert compile_model(path).nv == 1
