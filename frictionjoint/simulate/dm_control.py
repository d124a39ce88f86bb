"""Friction in dm_control: parameters in an MJCF tree, the callback around an environment.

    root = mjcf.from_path("arm.xml")
    install(root, {"elbow": parameters})                     # mjcf; the compiled model has friction
    environment = composer.Environment(Task(root))           # or control.Environment
    with attach(environment):
        environment.step(action)
    with attach(environment, samples={"elbow": report.samples(1024)}):   # a draw per episode
        environment.reset()

For a bare ``Physics``: ``with frictionjoint.attach(physics.model.ptr)``.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import mujoco
import numpy as np
from dm_control import composer, mjcf
from numpy.random import RandomState

from frictionjoint.errors import ModelError
from frictionjoint.laws import kind_of
from frictionjoint.parameters import Friction
from frictionjoint.simulate.attach import attach as attach_model
from frictionjoint.simulate.block import ROW, TAG, rows_of_block
from frictionjoint.simulate.carrier import install as install_in_spec
from frictionjoint.simulate.carrier import resolve
from frictionjoint.simulate.set_parameters import FrictionSamples, Samples


def install(root: mjcf.RootElement, friction: Mapping[str, Friction]) -> None:
    """Write friction into the MJCF tree to be compiled, with room for its state.

    Call it after everything is attached to `root`. Existing friction of a joint is replaced, so a
    composer task may draw it anew in ``initialize_episode_mjcf``.

    Args:
        root: changed in place, only if every joint is suitable; not attached to anything.
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
        block[ROW] = 0.0  # the tree's user data are counted here
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
def attach(
    environment: Any, samples: Samples | None = None, seed: int | None = None
) -> Iterator[Any]:
    """Turn on friction in a ``control.Environment`` or ``composer.Environment`` inside the block.

    A composer environment compiles at every reset; each model is prepared when it is compiled.

    Args:
        samples: parameter sets by name of the joint, with scope ("robot/elbow"); each episode draws
            one per joint. seed: of the draws.
    Raises:
        ModelError: as `frictionjoint.attach`, or as `frictionjoint.set_parameters`.
        TypeError: no environment.
    """
    if not hasattr(environment, "physics"):
        raise TypeError(
            f"attach takes an environment, not {kind_of(environment)}: for a Physics use "
            "frictionjoint.attach(physics.model.ptr)"
        )
    drawn = FrictionSamples(samples) if samples else None
    random = np.random.default_rng(seed)
    # kept here: composer frees a physics, and its model, at the next reset
    model = environment.physics.model.ptr
    with attach_model(model), contextlib.ExitStack() as inside:
        composed = isinstance(environment, composer.Environment)
        if composed:
            _hook(environment, inside, "after_compile", resolve)
        if drawn is not None:
            draw = partial(drawn.draw, random=random)
            if composed:
                _hook(environment, inside, "initialize_episode", draw)
            else:
                _before_episodes(environment.task, inside, draw)
        yield environment


def _hook(
    environment: composer.Environment,
    inside: contextlib.ExitStack,
    place: str,
    change: Callable[[mujoco.MjModel], Any],
) -> None:
    """Change a composer environment's model at a hook; composer cannot remove a hook."""
    active = [True]
    inside.callback(active.clear)

    def hook(physics: mjcf.Physics, random_state: RandomState) -> None:
        if active:
            change(physics.model.ptr)

    environment.add_extra_hook(place, hook)


def _before_episodes(
    task: Any, inside: contextlib.ExitStack, change: Callable[[mujoco.MjModel], Any]
) -> None:
    """Change the model of a control task before each of its episodes."""
    begin = task.initialize_episode

    def initialize_episode(physics: Any) -> None:
        change(physics.model.ptr)
        begin(physics)

    task.initialize_episode = initialize_episode
    inside.callback(setattr, task, "initialize_episode", begin)
