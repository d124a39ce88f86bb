"""Friction in dm_control: parameters into an MJCF tree, the callback around an environment.

    root = mjcf.from_path("arm.xml")
    install(root, {"elbow": parameters})                     # mjcf; what is compiled carries it
    environment = composer.Environment(Task(root))           # or control.Environment
    with attach(environment):
        environment.step(action)

A bare ``Physics`` needs nothing from here: ``with frictionjoint.attach(physics.model.ptr)``.
"""

import contextlib
from collections.abc import Iterator, Mapping
from typing import Any

import mujoco
from dm_control import composer, mjcf
from numpy.random import RandomState

from frictionjoint.errors import ModelError
from frictionjoint.laws import kind_of
from frictionjoint.parameters import Friction
from frictionjoint.simulate.attach import attach as attach_model
from frictionjoint.simulate.carrier import TAG, resolve, rows_of_block
from frictionjoint.simulate.carrier import install as install_in_spec


def install(root: mjcf.RootElement, friction: Mapping[str, Friction]) -> None:
    """Write friction into the MJCF tree that will be compiled, with room for its state.

    Call it after everything is attached to `root`. Friction a joint has already is replaced, so
    that a composer task may draw it anew in ``initialize_episode_mjcf``.

    Args:
        root: changed in place, only if every joint is fit for it; not attached to anything.
        friction: parameters by joint name, with scope ("robot/elbow").
    Raises:
        ModelError: unknown joint, not a hinge or slide, or `root` is attached to another model.
        TypeError: `root` is no MJCF tree.
    """
    if not isinstance(root, mjcf.RootElement):
        raise TypeError(
            f"install takes a dm_control.mjcf.RootElement, not {kind_of(root)}: give "
            "mjcf.from_path(path), or a Physics' spec to frictionjoint.install"
        )
    if root.parent_model is not None:
        raise ModelError(
            f"MJCF model {root.model!r} is attached to {root.parent_model.model!r}: install on "
            "the outermost model, root_model, after attaching"
        )
    spec = mujoco.MjSpec.from_string(root.to_xml_string())
    for numeric in list(spec.numerics):
        spec.delete(numeric)
    install_in_spec(spec, friction)
    blocks = {numeric.name: list(numeric.data) for numeric in spec.numerics}
    more = 0
    for name in friction:
        block = blocks[TAG + name]
        joint = root.find("joint", name)
        # names with a scope are not allowed: the numeric belongs to the scope of its joint
        numeric = joint.root.find("numeric", TAG + joint.name)
        if numeric is None:
            numeric = joint.root.custom.add("numeric", name=TAG + joint.name)
        else:
            more -= rows_of_block(numeric.data)
        numeric.size, numeric.data = len(block), block
        more += rows_of_block(block)
    root.size.nuserdata = max(root.size.nuserdata or 0, 0) + more


@contextlib.contextmanager
def attach(environment: Any) -> Iterator[Any]:
    """Friction acts in a ``control.Environment`` or ``composer.Environment`` inside the block.

    A composer environment compiles at every reset; each model is made ready as it is compiled.

    Raises:
        ModelError: as `frictionjoint.attach`.
    """
    # kept here: composer frees a physics, and its model, at the next reset
    model = environment.physics.model.ptr
    with attach_model(model):
        if not isinstance(environment, composer.Environment):
            yield environment
            return
        inside = True

        def make_ready(physics: mjcf.Physics, random_state: RandomState) -> None:
            if inside:
                resolve(physics.model.ptr)

        environment.add_extra_hook("after_compile", make_ready)
        try:
            yield environment
        finally:
            inside = False
