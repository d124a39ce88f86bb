"""Friction in a model from an earlier run, which is removed and identified again."""

from collections.abc import Collection, Sequence
from pathlib import Path

from frictionjoint.errors import few
from frictionjoint.model_files import read_spec
from frictionjoint.model_text import model_text
from frictionjoint.simulate.uninstall import carrying, take_out


def before_friction(
    model: str | Path, joints: Collection[str]
) -> tuple[str | Path, tuple[str, ...]]:
    """A model, the path or text of an MJCF or URDF, without friction of this package at some
    joints, to identify it again: itself if there is none, else the text of an MJCF; and the joints
    that had friction. ModelError: the model does not compile, or a block is damaged."""
    spec = read_spec(model)
    there = [name for name in carrying(spec) if name in joints]
    if not there:
        return model, ()
    take_out(spec, there)
    return model_text(spec, model), tuple(there)


def ignored_note(joints: Sequence[str]) -> str:
    """Sentence of the report on removed friction."""
    which = "joint" if len(joints) == 1 else "joints"
    return (
        f"The model contains friction at {which} {few(joints)} from an earlier run: it is ignored "
        "here and identified again."
    )
