"""Reading a user's model: an MJCF, or a URDF with meshes under ``package://``."""

import contextlib
import ctypes
import multiprocessing
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco

from frictionjoint.errors import ModelError, few
from frictionjoint.meshes import urdf_spec, without_missing_meshes
from frictionjoint.mujoco_warnings import as_python_warnings

# kinds of joint with one degree of freedom
ONE_DOF = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
# what all functions of ctypes have as base, whatever their prototype
_C_FUNCTION: Any = ctypes.CFUNCTYPE(None).__mro__[1]


def read_spec(model: str | Path, whole: bool = False) -> mujoco.MjSpec:
    """Spec of an MJCF or URDF that compiles.

    Args:
        model: path of the file, or an MJCF's text. A URDF's meshes are looked for in its folder and
            in those above, see `urdf_spec`; a warning names removed shapes.
        whole: whether an MJCF must have all its meshes. For dynamics alone, shapes without their
            mesh are removed, see `without_missing_meshes`, with a warning.
    Raises:
        ModelError: there is no such file, or MuJoCo cannot compile it.
    """
    return _read(model, whole)[0]


def compile_model(model: str | Path) -> mujoco.MjModel:
    """Read a model and compile it."""
    return _read(model, False)[1]


def compiled_copy(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a spec as it is, without changing it; ModelError if MuJoCo cannot."""
    try:
        with as_python_warnings(), compiling():
            return spec.copy().compile()
    except ValueError as error:
        raise ModelError(f"MuJoCo cannot compile it: {error}") from None


def _read(model: str | Path, whole: bool) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    if not isinstance(model, str | Path):
        raise TypeError(
            f"a model is read from a path or an MJCF's text, not from {type(model).__name__}: "
            "give a str or a Path"
        )
    text = _is_text(model)
    if not text and not Path(model).is_file():
        what = "a folder" if Path(model).is_dir() else "no such file"
        raise ModelError(f"{model}: {what}, give the path of an MJCF or a URDF")
    needed: tuple[str, ...] = ()
    urdf_given = not text and is_urdf(Path(model))
    try:
        with as_python_warnings(), compiling():
            if text:
                spec = mujoco.MjSpec.from_string(str(model))
            else:
                spec = urdf_spec(Path(model)) if urdf_given else mujoco.MjSpec.from_file(str(model))
                if urdf_given or not whole:
                    folder = Path(model).absolute().parent
                    left_out, needed = without_missing_meshes(spec, folder)
                    _warn_of_shapes(model, left_out)
            return spec, spec.compile()
    except ValueError as error:
        looked = (
            f"; not found: {few(needed)} of links that move and have no <inertial>: put the meshes "
            "in their folder, or give these links their masses"
            if needed
            else ""
        )
        how = ""
        if "balanceinertia" in str(error):  # names a setting; where in the file it belongs:
            setting, place = '<compiler balanceinertia="true"/>', "<mujoco>"
            if urdf_given:
                setting, place = f"<mujoco>{setting}</mujoco>", "<robot>"
            how = f", write {setting} inside {place}"
        wrong = (not text and not_xml(model)) or f"MuJoCo cannot compile it: {error}{how}{looked}"
        raise ModelError(f"{source_name(model)}: {wrong}") from None


def not_xml(path: str | Path) -> str:
    """What is wrong with a file that MuJoCo cannot read, if it contains no XML; else empty."""
    with Path(path).open("rb") as file:
        is_xml = file.read(99).lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    return "" if is_xml else "not a model: give the path of an MJCF or a URDF"


def _warn_of_shapes(model: str | Path, left_out: tuple[str, ...]) -> None:
    # a process that another one started reads what that one has warned of
    if left_out and multiprocessing.parent_process() is None:
        warnings.warn(
            f"{model}: meshes not found: {few(left_out)}; these shapes are ignored, masses are "
            "those of the file: put the meshes in their folder if collisions matter",
            RuntimeWarning,
            stacklevel=4,
        )


def source_name(model: str | Path) -> str:
    """Name of a model in messages: its path, or "text"."""
    return "the MJCF" if _is_text(model) else str(model)


def _is_text(model: str | Path) -> bool:
    return isinstance(model, str) and model.lstrip().startswith("<")


def is_urdf(path: Path) -> bool:
    """Whether the file's outermost element is a URDF's."""
    try:
        _, outermost = next(ElementTree.iterparse(path, events=("start",)))
    except (ElementTree.ParseError, StopIteration, OSError):
        return False  # MuJoCo says what is wrong
    return bool(outermost.tag == "robot")


def is_c(callback: Any) -> bool:
    """Whether a callback is a C function from ctypes."""
    return isinstance(callback, _C_FUNCTION)


@contextlib.contextmanager
def compiling() -> Iterator[None]:
    """Let MuJoCo compile models inside the block, whatever passive callback is installed.

    MuJoCo calls the callback once while it compiles, and fails if it is a Python function; then it
    is removed for that time.
    """
    current = mujoco.get_mjcb_passive()
    if current is None or is_c(current):
        yield
        return
    mujoco.set_mjcb_passive(None)
    try:
        yield
    finally:
        mujoco.set_mjcb_passive(current)
