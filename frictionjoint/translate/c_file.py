"""One C file with all kernels of the package, and the signature of each for calls from Python.

Kernels are static functions of one translation unit, so that the compiler can inline them. The
library exports one wrapper function per kernel.
"""

from collections.abc import Mapping
from typing import Any

from frictionjoint.compiled import is_tuple
from frictionjoint.library import Entry, Parameter
from frictionjoint.translate.c_expressions import Expressions
from frictionjoint.translate.c_functions import Translation
from frictionjoint.translate.kinds import LIBRARY, NOTHING, fields_of, is_structure

_HEAD = """/* The kernels of frictionjoint, written by frictionjoint.translate. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(_MSC_VER) || defined(_WIN32)
#define FJ_SHARED __declspec(dllexport)
#else
#define FJ_SHARED __attribute__((visibility("default")))
#endif
#define FJ_IN_LINE static inline __attribute__((always_inline))
"""


def unit(kernels: Mapping[str, Any]) -> tuple[str, dict[str, Entry]]:
    """C text, and the symbol, result and parameters of each kernel.

    Args:
        kernels: by module and name, see `frictionjoint.compiled.registry`.
    Raises:
        ModelError: a construct that cannot be translated.
    """
    translation = Translation(kernels.values(), dialect=LIBRARY)
    shown: list[str] = []
    listed: dict[str, Entry] = {}
    for name, kernel in kernels.items():
        made = translation.made[kernel.py_func]
        shown.append(_shown(made))
        result = "bool" if made.python.__annotations__["return"] is bool else made.result
        listed[name] = Entry(f"fj_{made.name}_", result, _parameters(made))
    return "\n".join([_HEAD, translation.text(), *shown]) + "\n", listed


def _parameters(made: Expressions) -> tuple[Parameter, ...]:
    found = []
    for name in made.parameters:
        kind = made.kinds[name]
        fields = fields_of(made.structures[kind]) if is_structure(kind) else {}
        axes = sorted(made.axes.get(name, ()))
        found.append(Parameter(name, kind, name in made.written, axes, fields))
    return tuple(found)


def _shown(made: Expressions) -> str:
    """The function that the library exports for a kernel; tuples are passed by address."""
    declared: list[str] = []
    given: list[str] = []
    for name in made.parameters:
        kind = made.kinds[name]
        if is_tuple(kind):
            declared.append(f"const {kind} *{name}_")
            given.append(f"*{name}_")
            continue
        declared.append(f"{LIBRARY.declared(kind)}{name}_")
        given.append(f"{name}_")
        for axis in sorted(made.axes.get(name, ())):
            declared.append(f"int64_t {name}_n{axis}")
            given.append(f"{name}_n{axis}")
    call, result = f"fj_{made.name}({', '.join(given)})", LIBRARY.type_of(made.result)
    if is_tuple(made.result):
        declared.append(f"{made.result} *out_")
        call, result = f"*out_ = {call}", NOTHING
    elif made.result != NOTHING:
        call = f"return {call}"
    head = f"FJ_SHARED {result} fj_{made.name}_({', '.join(declared) or NOTHING})"
    return f"{head};\n{head}\n{{\n    {call};\n}}\n"
