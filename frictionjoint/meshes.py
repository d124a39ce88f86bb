"""Mesh files of a user's model: where they lie, and what is left out where they are missing.

Repositories often ship a model without its meshes. Dynamics needs only masses, so a shape whose
mesh is missing is removed where the mass of its body does not depend on it, or where nothing moves
it.

ROS names meshes by package, ``package://NAME/meshes/link.stl``, which MuJoCo does not resolve, and
before 4.0 MuJoCo looks for all meshes of a URDF by their bare names in one folder.
"""

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import mujoco

_IN_A_PACKAGE = ("package://", "model://")


def urdf_spec(path: Path) -> mujoco.MjSpec:
    """A URDF as MuJoCo reads it, with absolute paths of the meshes that are found.

    ``package://NAME/REST`` is searched from the URDF's folder upwards: first a folder NAME that
    contains REST, then a package with that name in its package.xml, then any folder that contains
    REST.
    """
    robot = ElementTree.parse(path).getroot()
    compiler = robot
    for tag in ("mujoco", "compiler"):
        found = compiler.find(tag)
        compiler = ElementTree.SubElement(compiler, tag) if found is None else found
    folder = path.resolve().parent
    folders = [folder / compiler.attrib.pop(key, "") for key in ("meshdir", "assetdir")]
    # by default only the bare name of a mesh is looked at, and two links may share one
    compiler.set("strippath", "false")
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(robot, encoding="unicode"))
    for mesh in spec.meshes:
        places = _candidates(mesh.file, folders)
        mesh.file = next((str(x) for x in places if x.is_file()), mesh.file)
    return spec


def without_missing_meshes(
    spec: mujoco.MjSpec, folder: Path
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Remove shapes whose mesh files are missing from a spec that was read from a folder.

    Returns:
        names of the files whose shapes were removed, and of those whose shapes give a body its mass
            and were kept.
    """
    missing = {}
    for mesh in spec.meshes:
        own = Path(mesh.compiler.meshdir or "")
        names = (own / mesh.file, Path(mesh.file), own / Path(mesh.file).name)
        if mesh.file and not any((folder / name).is_file() for name in names):
            missing[mesh.name or Path(mesh.file).stem] = mesh
    needed = {
        geom.meshname
        for geom in spec.geoms
        if geom.meshname in missing
        # the inertia of the body depends on the geom
        and not (geom.parent.explicitinertial or geom.mass == 0.0 or geom.density == 0.0)
        and _moves(geom.parent)
    }
    for geom in list(spec.geoms):
        if geom.meshname in missing and geom.meshname not in needed:
            spec.delete(geom)
    left_out = []
    for name, mesh in missing.items():
        if name not in needed:
            left_out.append(str(mesh.file))
            spec.delete(mesh)
    return tuple(left_out), tuple(str(missing[name].file) for name in needed)


def _moves(body: mujoco.MjsBody) -> bool:
    """Whether a joint moves the body, or one above it."""
    while body is not None and body.name != "world":
        if body.joints:
            return True
        body = body.parent
    return False


def _candidates(name: str, folders: list[Path]) -> Iterator[Path]:
    """Possible places of a URDF's mesh with this name, the likeliest first."""
    scheme = next((s for s in _IN_A_PACKAGE if name.startswith(s)), None)
    if scheme:
        package, _, rest = name.removeprefix(scheme).partition("/")
        yield from _in_package(package, rest, folders[0])
    else:
        name = name.removeprefix("file://")
        yield from (folder / name for folder in folders)
    # as MuJoCo itself looks
    yield from (folder / Path(name).name for folder in folders)


def _in_package(package: str, rest: str, folder: Path) -> Iterator[Path]:
    upwards = (folder, *folder.parents)
    for above in upwards:
        if above.name == package:
            yield above / rest
        yield above / package / rest
    for above in upwards:
        if _package_name(above / "package.xml") == package:
            yield above / rest
    yield from (above / rest for above in upwards)


def _package_name(manifest: Path) -> str | None:
    try:
        return (ElementTree.parse(manifest).getroot().findtext("name") or "").strip()
    except (OSError, ElementTree.ParseError):
        return None
