"""Friction in mjlab: actuator configurations whose joints have the friction of their MJCF.

mjlab initialises its actuators with the compiled model and mujoco_warp's model and data. The
actuators here are mjlab's own, delay and limits included, and turn friction on at that moment. One
of them is enough for a scene: it serves every joint with friction in it.

A CUDA graph that mjlab captured before does not contain the friction: call
``env.sim.create_graph()`` after the environment is made.
"""

# mjlab and torch are not installed where types are checked
# mypy: ignore-errors

from dataclasses import dataclass
from typing import Any

import mujoco
from mjlab.actuator import IdealPdActuator, IdealPdActuatorCfg, XmlActuator, XmlActuatorCfg

from frictionjoint.simulate.warp import WarpFriction, attach_warp


class _WithFriction:
    """Turns friction on when mjlab initialises the actuator."""

    def initialize(self, mj_model: mujoco.MjModel, model: Any, data: Any, device: str) -> None:
        super().initialize(mj_model, model, data, device)
        friction_of(mj_model, model, data)


def friction_of(mj_model: mujoco.MjModel, model: Any, data: Any) -> WarpFriction:
    """The friction of a scene, attached now if it was not.

    Args:
        model, data: mujoco_warp's, bare or as mjlab's bridge returns them.
    Raises:
        ModelError: see `attach_warp`.
    """
    bare, state = (getattr(x, "struct", x) for x in (model, data))
    owner = getattr(bare.callback.passive, "__self__", None)
    return owner if isinstance(owner, WarpFriction) else attach_warp(bare, state, mj_model)


class IdentifiedXmlActuator(_WithFriction, XmlActuator):
    """An actuator of the MJCF, on joints with friction."""


class IdentifiedPdActuator(_WithFriction, IdealPdActuator):
    """A PD controller, on joints with friction."""


@dataclass(kw_only=True)
class IdentifiedXmlActuatorCfg(XmlActuatorCfg):
    """mjlab's `XmlActuatorCfg` for joints that carry friction."""

    def build(self, entity: Any, target_ids: list[int], target_names: list[str]) -> Any:
        return IdentifiedXmlActuator(self, entity, target_ids, target_names)


@dataclass(kw_only=True)
class IdentifiedPdActuatorCfg(IdealPdActuatorCfg):
    """mjlab's `IdealPdActuatorCfg` for joints that carry friction."""

    def build(self, entity: Any, target_ids: list[int], target_names: list[str]) -> Any:
        return IdentifiedPdActuator(self, entity, target_ids, target_names)
