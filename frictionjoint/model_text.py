"""A model as MJCF text that finds its meshes, textures, height fields and skins from any folder.

MuJoCo writes the names of asset files as it read them, relative to the folder of the original file.
A text in another folder would not find the files. So the text is made with absolute paths. When the
text is written into a folder, the paths become relative to that folder.
"""

import os
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np

from frictionjoint.errors import ModelError
from frictionjoint.model_files import compiling, source_name
from frictionjoint.model_joints import is_slide
from frictionjoint.mujoco_warnings import as_python_warnings

_SIZES = ("nq", "nv", "nu", "na", "nbody", "ngeom", "ntendon", "neq", "nsensor", "nuserdata")
# MuJoCo's reader ends the process when one <numeric> of a file has more
_MOST_NUMBERS = 500
# what of a compiled model comes from asset files
_FROM_FILES = ("mesh_vert", "mesh_face", "hfield_data", "tex_data", "skin_vert")


def model_text(spec: mujoco.MjSpec, source: str | Path) -> str:
    """The spec as MJCF text that compiles wherever it lies: asset files by their absolute paths.

    Args:
        spec: compiles; the names of its asset files are changed.
        source: what it was read from, a file or an MJCF's text.
    Raises:
        ModelError: an asset file is not found, a joint has too many effects for a file, or the text
            that MuJoCo writes is another model.
    """
    name = source_name(source)
    with as_python_warnings(), compiling():
        before = spec.compile()
        own = Path(spec.modelfiledir or ".").absolute()
        folders = [own, *(part.absolute().parent for part in sources(Path(source)))]
        _name_files_absolutely(spec, folders)
        spec.meshdir = spec.texturedir = ""
        for numeric in spec.numerics:
            if len(numeric.data) > _MOST_NUMBERS:
                raise ModelError(
                    f"{name}: {numeric.name} has {len(numeric.data)} numbers, and MuJoCo reads no "
                    f"more than {_MOST_NUMBERS} from a file: leave out effects of this joint"
                )
        try:
            text = str(spec.to_xml())
            after = mujoco.MjModel.from_xml_string(text)
        except ValueError as error:
            raise ModelError(f"{name}: MuJoCo cannot read its own output: {error}") from None
    _require_same(before, after, name)
    return _explained(text, before)


def _explained(text: str, model: mujoco.MjModel) -> str:
    """MJCF text with a comment for each joint that carries friction: its numbers in units."""
    from frictionjoint.describe import one_line
    from frictionjoint.simulate.block import TAG, blocks
    from frictionjoint.simulate.carrier import read_friction

    if not blocks(model):
        return text
    for joint, carried in read_friction(model).items():
        # two dashes would end a comment
        said = one_line(joint, carried, is_slide(model, joint)).replace("--", "- -")
        tag = f"<numeric name={quoteattr(TAG + joint)}"
        text = text.replace(tag, f"<!-- {said} -->\n    {tag}", 1)
    return text


def placed(text: str, folder: Path) -> str:
    """The text with paths of asset files relative to the folder that it will be written to.

    Paths stay absolute if a symbolic link leads to the folder, because MuJoCo and the operating
    system resolve ".." differently there.
    """
    home = Path(os.path.abspath(folder))
    if home != home.resolve():
        return text
    builder = ElementTree.TreeBuilder(insert_comments=True)
    root = ElementTree.fromstring(text, ElementTree.XMLParser(target=builder))
    for element in root.iter():
        for key, value in element.attrib.items():
            if key.startswith("file") and os.path.isabs(value):
                element.set(key, _relative(Path(value), home))
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def require_compiles(path: Path) -> None:
    """Raise ModelError unless MuJoCo can compile a written model with all its files."""
    with as_python_warnings(), compiling():
        try:
            mujoco.MjModel.from_xml_path(str(path))
        except ValueError as error:
            raise ModelError(f"the model would not load from its folder: {error}") from None


def _relative(path: Path, home: Path) -> str:
    path = path.parent.resolve() / path.name
    try:
        return Path(os.path.relpath(path, home)).as_posix()
    except ValueError:
        return path.as_posix()  # on another drive


def sources(model: Path, main: Path | None = None) -> Iterator[Path]:
    """The file of a model, and those that it includes or attaches; `main` is what includes it."""
    yield model
    try:
        root = ElementTree.parse(model).getroot()
    except (OSError, ElementTree.ParseError, ValueError):
        return  # an MJCF's text, or an error that MuJoCo explains better
    for element in root.iter():
        name = element.get("file")
        if name and element.tag in ("model", "include"):
            # MuJoCo takes an include's name relative to the main file
            for home in dict.fromkeys((model.parent, (main or model).parent)):
                if (home / name).is_file():
                    yield from sources(home / name, main or model)


def _name_files_absolutely(spec: mujoco.MjSpec, folders: list[Path]) -> None:
    """Give every asset the absolute path of its file."""
    for asset in (*spec.meshes, *spec.hfields, *spec.skins):
        if asset.file:
            asset.file = _found(asset.file, asset.compiler.meshdir, folders)
    for texture in spec.textures:
        place = texture.compiler.texturedir
        if texture.file:
            texture.file = _found(texture.file, place, folders)
        if any(texture.cubefiles):
            texture.cubefiles = [x and _found(x, place, folders) for x in texture.cubefiles]


def _found(name: str, place: str, folders: list[Path]) -> str:
    """Absolute path of an asset file, by MuJoCo's rules in each of the folders, or ModelError."""
    for folder in folders:
        # the bare name: an MJCF may ask for paths to be stripped
        for candidate in (folder / place / name, folder / place / Path(name).name):
            if candidate.is_file():
                return candidate.as_posix()
    looked = ", ".join(str(folder / place) for folder in dict.fromkeys(folders))
    raise ModelError(f"the file {name!r} of the model is not in {looked}: give its absolute path")


def _require_same(before: mujoco.MjModel, after: mujoco.MjModel, name: str) -> None:
    for key in _SIZES:
        old, new = getattr(before, key), getattr(after, key)
        if old != new:
            raise ModelError(
                f"{name}: MuJoCo writes it as a different model, with {key} {new} instead of {old}"
            )
    for key in _FROM_FILES:
        old, new = np.asarray(getattr(before, key)), np.asarray(getattr(after, key))
        # MJCF has six digits
        if old.shape != new.shape or not np.allclose(old, new, rtol=1e-5, atol=1e-5):
            raise ModelError(
                f"{name}: files of attached models have the same name, and MuJoCo's output does "
                f"not distinguish them ({key} differs): give them different names"
            )
