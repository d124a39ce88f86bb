"""Joint friction for MuJoCo with presliding memory, identified from logs, and a search for effects
that the model lacks.
"""

import importlib
from typing import TYPE_CHECKING, Any

from frictionjoint.callable_package import make_callable

if TYPE_CHECKING:
    from frictionjoint.batch import FrictionBatch
    from frictionjoint.commands import close_loop, export, identify
    from frictionjoint.evaluation.run import evaluate
    from frictionjoint.law.motion import friction_torque
    from frictionjoint.measured.readers import read_log
    from frictionjoint.parameters import FrictionParameters
    from frictionjoint.plotting import plot
    from frictionjoint.simulate.attach import attach, disable, enable
    from frictionjoint.simulate.carrier import install, load_model
    from frictionjoint.simulate.check import check_model as check
    from frictionjoint.simulate.mass_matrix import mass_matrix
    from frictionjoint.simulate.memory_stacks import remembered
    from frictionjoint.simulate.set_parameters import forget, set_parameters
    from frictionjoint.simulate.thermal import set_temperature, set_warmth, temperature, warmth
    from frictionjoint.simulate.torque import torque
    from frictionjoint.simulate.uninstall import uninstall
    from frictionjoint.simulate.warp import attach_warp

# Kernels and MuJoCo load on first use, so that the import itself stays quick.
_HOMES = {
    "close_loop": "frictionjoint.commands",
    "identify": "frictionjoint.commands",
    "export": "frictionjoint.commands",
    "read_log": "frictionjoint.measured.readers",
    "plot": "frictionjoint.plotting",
    "check": "frictionjoint.simulate.check",
    "evaluate": "frictionjoint.evaluation.run",
    "attach": "frictionjoint.simulate.attach",
    "disable": "frictionjoint.simulate.attach",
    "enable": "frictionjoint.simulate.attach",
    "attach_warp": "frictionjoint.simulate.warp",
    "install": "frictionjoint.simulate.carrier",
    "load_model": "frictionjoint.simulate.carrier",
    "remembered": "frictionjoint.simulate.memory_stacks",
    "mass_matrix": "frictionjoint.simulate.mass_matrix",
    "forget": "frictionjoint.simulate.set_parameters",
    "set_parameters": "frictionjoint.simulate.set_parameters",
    "set_temperature": "frictionjoint.simulate.thermal",
    "set_warmth": "frictionjoint.simulate.thermal",
    "temperature": "frictionjoint.simulate.thermal",
    "warmth": "frictionjoint.simulate.thermal",
    "torque": "frictionjoint.simulate.torque",
    "uninstall": "frictionjoint.simulate.uninstall",
    "FrictionBatch": "frictionjoint.batch",
    "FrictionParameters": "frictionjoint.parameters",
    "friction_torque": "frictionjoint.law.motion",
}

__all__ = [
    "FrictionBatch",
    "FrictionParameters",
    "attach",
    "attach_warp",
    "check",
    "close_loop",
    "disable",
    "enable",
    "evaluate",
    "export",
    "forget",
    "friction_torque",
    "identify",
    "install",
    "load_model",
    "mass_matrix",
    "plot",
    "read_log",
    "remembered",
    "set_parameters",
    "set_temperature",
    "set_warmth",
    "temperature",
    "torque",
    "uninstall",
    "warmth",
]


# public name -> name in its module, where that differs
_OTHER_NAMES = {"check": "check_model"}


make_callable(__name__)


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        module = importlib.import_module(_HOMES[name])
        return getattr(module, _OTHER_NAMES.get(name, name))
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, so that completion lists them before the modules are loaded."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
