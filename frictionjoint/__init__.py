"""Joint friction for MuJoCo with presliding memory, identified from logs, and a search for effects
that the model lacks.
"""

import importlib
from typing import TYPE_CHECKING, Any

from frictionjoint.callable_package import make_callable

if TYPE_CHECKING:
    from frictionjoint.batch import FrictionBatch as FrictionBatch
    from frictionjoint.commands import close_loop as close_loop
    from frictionjoint.commands import export as export
    from frictionjoint.commands import identify as identify
    from frictionjoint.evaluation.run import evaluate as evaluate
    from frictionjoint.law.motion import friction_torque as friction_torque
    from frictionjoint.measured.log import JointLog as JointLog
    from frictionjoint.measured.readers import read_log as read_log
    from frictionjoint.parameters import FrictionParameters as FrictionParameters
    from frictionjoint.plotting import plot as plot
    from frictionjoint.simulate.attach import attach as attach
    from frictionjoint.simulate.attach import disable as disable
    from frictionjoint.simulate.attach import enable as enable
    from frictionjoint.simulate.carrier import install as install
    from frictionjoint.simulate.carrier import load_model as load_model
    from frictionjoint.simulate.check import check as check
    from frictionjoint.simulate.set_parameters import forget as forget
    from frictionjoint.simulate.set_parameters import set_parameters as set_parameters
    from frictionjoint.simulate.thermal import set_temperature as set_temperature
    from frictionjoint.simulate.thermal import set_warmth as set_warmth
    from frictionjoint.simulate.thermal import temperature as temperature
    from frictionjoint.simulate.thermal import warmth as warmth
    from frictionjoint.simulate.torque import mass_matrix as mass_matrix
    from frictionjoint.simulate.torque import remembered as remembered
    from frictionjoint.simulate.torque import torque as torque
    from frictionjoint.simulate.uninstall import uninstall as uninstall
    from frictionjoint.simulate.warp import attach_warp as attach_warp

# Kernels and MuJoCo load on first use, so that the import itself stays quick.
_NAMES = {
    "batch": "FrictionBatch",
    "commands": "close_loop export identify",
    "evaluation.run": "evaluate",
    "law.motion": "friction_torque",
    "measured.log": "JointLog",
    "measured.readers": "read_log",
    "parameters": "FrictionParameters",
    "plotting": "plot",
    "simulate.attach": "attach disable enable",
    "simulate.carrier": "install load_model",
    "simulate.check": "check",
    "simulate.set_parameters": "forget set_parameters",
    "simulate.thermal": "set_temperature set_warmth temperature warmth",
    "simulate.torque": "mass_matrix remembered torque",
    "simulate.uninstall": "uninstall",
    "simulate.warp": "attach_warp",
}
_HOMES = {name: f"frictionjoint.{module}" for module, x in _NAMES.items() for name in x.split()}
__all__ = sorted(_HOMES)

make_callable(__name__)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, so that completion lists them before the modules are loaded."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
