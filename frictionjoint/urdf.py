"""Reading of URDFs: meshes get absolute paths.

ROS names meshes by package, ``package://NAME/meshes/link.stl``, which MuJoCo does not resolve, and
before 4.0 MuJoCo looks for all meshes of a URDF by their bare names in one folder. A URDF often
comes without its packages. Dynamics needs only masses, so a shape with a missing mesh is removed if
its link states its mass or cannot move.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

_IN_A_PACKAGE = ("package://", "model://")


@dataclass(frozen=True)
class FoundMeshes:
    """A URDF's text with absolute paths of its meshes.

    Attributes:
        left_out: missing meshes whose shapes were removed from the text, without purely visual
            ones.
        needed: missing meshes of moving links without a mass of their own, which the text still
            names.
    """

    text: str
    left_out: tuple[str, ...]
    needed: tuple[str, ...]


def with_found_meshes(path: Path) -> FoundMeshes:
    """Read a URDF and look for its meshes.

    ``package://NAME/REST`` is searched from the URDF's folder upwards: first a folder NAME that
    contains REST, then a package with that name in its package.xml, then any folder that contains
    REST.
    """
    tree = ElementTree.parse(path)
    robot = tree.getroot()
    compiler = _compiler(robot)
    folder = path.resolve().parent
    folders = [folder / compiler.attrib.pop(key, "") for key in ("meshdir", "assetdir")]
    left_out, needed = [], []
    # as MuJoCo does by default
    discards_visual = compiler.get("discardvisual", "true") == "true"
    at_rest = _links_at_rest(robot)
    for link in robot.findall("link"):
        mass_known = link.find("inertial") is not None or link.get("name") in at_rest
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            mesh = shape.find("geometry/mesh")
            if mesh is None:
                continue
            name = mesh.get("filename", "")
            found = next((x for x in _candidates(name, folders) if x.is_file()), None)
            if found is not None:
                mesh.set("filename", str(found))
            elif shape.tag == "visual" and discards_visual:
                link.remove(shape)
            elif mass_known:
                link.remove(shape)
                left_out.append(name)
            else:
                needed.append(name)
    # by default only the bare name of a mesh is looked at, and two links may share one
    compiler.set("strippath", "false")
    text = ElementTree.tostring(robot, encoding="unicode")
    return FoundMeshes(text, tuple(dict.fromkeys(left_out)), tuple(dict.fromkeys(needed)))


def _links_at_rest(robot: ElementTree.Element) -> set[str | None]:
    """Names of the links that no joint moves: the root, and links fixed to it."""
    joints = robot.findall("joint")
    ends = [[_link(joint, end) for end in ("parent", "child")] for joint in joints]
    at_rest = {link.get("name") for link in robot.findall("link")} - {child for _, child in ends}
    fixed = [end for joint, end in zip(joints, ends, strict=True) if joint.get("type") == "fixed"]
    for _ in fixed:
        at_rest |= {child for parent, child in fixed if parent in at_rest}
    return at_rest


def _link(joint: ElementTree.Element, end: str) -> str | None:
    found = joint.find(end)
    return None if found is None else found.get("link")


def _compiler(robot: ElementTree.Element) -> ElementTree.Element:
    """The element with MuJoCo's own settings; it is added if missing."""
    element = robot
    for tag in ("mujoco", "compiler"):
        found = element.find(tag)
        element = ElementTree.SubElement(element, tag) if found is None else found
    return element


def _candidates(name: str, folders: list[Path]) -> Iterator[Path]:
    """Possible places of a mesh with this name, the likeliest first."""
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
