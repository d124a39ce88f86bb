"""Types of the values in kernels, and their names in C.

A kind is ``double``, ``int``, ``void``, a pointer to numbers, or a tuple. The name of a tuple
encodes its elements: ``fj_tuple_TdTddEE`` is a double and a tuple of two doubles.
"""

import ast
import functools
import inspect
import sys
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from frictionjoint.compiled import TUPLE, elements

DOUBLE, WHOLE, NOTHING = "double", "int", "void"
REALS, WHOLES, FLAGS = "double *", "int64_t *", "uint8_t *"
SHORTS, ADDRESS = "int32_t *", "char *"
POINTERS = {REALS: DOUBLE, WHOLES: WHOLE, FLAGS: WHOLE, SHORTS: WHOLE, ADDRESS: WHOLE}
"""Kinds of arrays, and the kind of their elements."""
_STRUCTURE = "fj_struct_"
_LETTERS = {DOUBLE: "d", WHOLE: "i"}
_NAMES = {
    "float": DOUBLE,
    "int": WHOLE,
    "bool": WHOLE,
    "Size": WHOLE,
    "None": NOTHING,
    "Vector": REALS,
    "Array": REALS,
    "Index": WHOLES,
    "NDArray[np.bool_]": FLAGS,
    "Flags": FLAGS,
    "Shorts": SHORTS,
    "Address": ADDRESS,
}


@dataclass(frozen=True)
class Dialect:
    """Dialect of C for one purpose.

    Attributes:
        whole: type of integers.
        header: whether it is for a header: its functions are inline, pointers that are only read
            from are const, and of the C library only exp, log and pow are called.
    """

    whole: str
    header: bool

    def type_of(self, kind: str) -> str:
        """C type of a kind."""
        return self.whole if kind == WHOLE else kind

    def declared(self, kind: str) -> str:
        """C type of a kind as it is written before a name; a structure is never written to."""
        if is_structure(kind):
            return f"const {kind}"
        return kind if kind in POINTERS else f"{self.type_of(kind)} "


LIBRARY = Dialect("int64_t", header=False)
HEADER = Dialect("int", header=True)


def kind_of(annotation: ast.expr | None, aliases: dict[str, Any]) -> str | None:
    """Kind for an annotation, with the objects of its module; None if it is not one of a kernel."""
    if annotation is None:
        return None
    text = ast.unparse(annotation)
    if text in _NAMES:
        return _NAMES[text]
    if isinstance(annotation, ast.Subscript) and ast.unparse(annotation.value) == "tuple":
        inner = annotation.slice
        parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
        kinds = [kind_of(part, aliases) for part in parts]
        return tuple_of(k for k in kinds if k) if all(kinds) else None
    if isinstance(annotation, ast.Name):
        if hasattr(aliases.get(text), "_fields"):
            return structure_of(aliases[text])
        alias = getattr(aliases.get(text), "__args__", None)
        if alias and all(part is float for part in alias):
            return tuple_of([DOUBLE] * len(alias))
    return None


def structure_of(named: Any) -> str:
    """Kind of a NamedTuple, which is passed by address: ``const fj_struct_module_name *``."""
    return f"{_STRUCTURE}{named.__module__.rpartition('.')[2]}_{named.__name__.strip('_')} *"


def is_structure(kind: str | None) -> bool:
    """Whether a kind is the address of a NamedTuple."""
    return kind is not None and kind.startswith(_STRUCTURE)


@functools.cache
def fields_of(named: Any) -> dict[str, str]:
    """Kinds of the fields of a NamedTuple; ValueError if one is not supported."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(named))).body[0]
    assert isinstance(tree, ast.ClassDef)
    aliases = vars(sys.modules[named.__module__])
    found = {}
    for node in tree.body:
        if isinstance(node, ast.AnnAssign):
            kind = kind_of(node.annotation, aliases)
            if kind is None:
                raise ValueError(f"{named.__name__}: no kind for {ast.unparse(node)}")
            found[ast.unparse(node.target)] = kind
    return found


def tuple_of(kinds: Iterable[str]) -> str:
    """Kind of a tuple of values of the given kinds."""
    return f"{TUPLE}T{''.join(_LETTERS.get(k) or k.removeprefix(TUPLE) for k in kinds)}E"


AXES = 3
"""Lengths that go along with an array in a structure."""


def structure_definitions(named: Iterable[Any], dialect: Dialect) -> list[str]:
    """C structures for NamedTuples; each array field is followed by its lengths."""
    made = []
    for one in named:
        lines = []
        for name, kind in fields_of(one).items():
            lines.append(f"    {dialect.declared(kind)}{name};")
            if kind in POINTERS:
                lines.append(f"    {dialect.whole} {name}_n[{AXES}];")
        name = structure_of(one).removesuffix(" *")
        made.append("\n".join([f"typedef struct {name} {{", *lines, f"}} {name};"]))
    return made


def definitions(kinds: Iterable[str], dialect: Dialect) -> list[str]:
    """C structures for tuples and those within them, whose names are shorter and come first."""
    made = []
    for kind in sorted(kinds, key=lambda kind: (len(kind), kind)):
        pairs = enumerate(map(dialect.declared, elements(kind)))
        made.append(f"typedef struct {{ {' '.join(f'{x}_{i};' for i, x in pairs)} }} {kind};")
    return made
