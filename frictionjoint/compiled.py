"""Kernels: Python functions that run as C.

`compiled` marks a function as a kernel. All kernels of the package are translated into one C file
(`frictionjoint.translate`), which becomes a shared library when the package is built; here a call
from Python is handed to it. A call releases Python's lock, so other threads go on meanwhile.

With ``FRICTIONJOINT_PYTHON=1`` in the environment all kernels run as the Python they are written
in: slow, and every line can be stepped through. So does a kernel outside this package, always.

A kernel is a function of annotated arguments: ``float``, ``int``, ``bool``, ``Vector`` (float64 by
one index), ``Array`` (float64 by as many indices as the kernel uses), ``Index`` (int64),
``NDArray[np.bool_]`` and ``Tangent``. It returns one number, a tuple of numbers, or
nothing. Arrays lie in memory without gaps, row by row. Within it there may be

* assignments of numbers and tuples, also ``+=``; ``if``, ``while``, ``for ... in range(...)``,
  ``break``, ``continue``, ``return``;
* arithmetic, comparisons, ``and``, ``or``, ``not``, ``a if b else c``, ``&`` and ``>>`` of whole
  numbers, ``abs``, ``min`` and ``max`` of two, ``int``, ``float``, ``bool``, ``len``,
  ``x.shape[k]``;
* ``math``, ``np.inf``, ``np.nan``, constants of modules, calls of other kernels;
* arrays by subscript (no slices, no negative subscripts), ``room(n)`` for a few zeros, and
  ``pointer(x, k)`` for what begins at number k of an array.

Division by zero gives infinity or NaN, as in C; Python raises an error there.
"""

import ctypes
import functools
import inspect
import linecache
import os
import types
from collections.abc import Callable
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numpy as np

from frictionjoint.arrays import Vector
from frictionjoint.library import Entry, load

PLAIN = os.environ.get("FRICTIONJOINT_PYTHON", "0") not in ("", "0")
"""Whether kernels run as Python."""

_Function = TypeVar("_Function", bound=Callable[..., Any])
_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")

registry: dict[str, Any] = {}
"""Every kernel that has been imported, by module and name."""


def compiled(function: _Function) -> _Function:
    """Mark a function as a kernel; the module describes what a kernel may contain."""
    return _kernel(function, in_line=False)


def in_line(function: _Function) -> _Function:
    """`compiled`, for a kernel so small or so often called that it is inlined into its callers."""
    return _kernel(function, in_line=True)


def room(n: int) -> Vector:
    """Zeros for the duration of a kernel call, a few hundred at most."""
    return np.zeros(n)


def pointer(array: Any, at: int) -> Vector:
    """Pointer to element `at` of a contiguous array of any shape."""
    return cast("Vector", array.reshape(-1)[at:])


def c_text(text: str) -> Callable[[_Function], _Function]:
    """Mark an annotated function as C text for kernels, with ``{0}`` for an argument."""

    def marked(function: _Function) -> _Function:
        cast("Any", function).c_text = text
        return function

    return marked


def define(text: str, name: str, space: dict[str, Any]) -> None:
    """Run generated Python text in a namespace; `name`: what tracebacks call the text."""
    file = f"<{name}>"
    # debuggers and the translation read the source from this cache
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), space)


class Table:
    """Integers that kernels read and Python sets, one table a process, by its name there."""

    def __init__(self, name: str, size: int) -> None:
        self.name, self.size = name, size

    @functools.cached_property
    def numbers(self) -> Any:
        """The table itself, int64, shape (size,)."""
        held: Any = (ctypes.c_int64 * self.size).in_dll(load().shared, f"fj_{self.name}")
        return np.frombuffer(held, dtype=np.int64)

    def __getitem__(self, at: int) -> int:
        return int(self.numbers[at])


class External(Generic[_Arguments, _Result]):
    """A C function from another library, which kernels call by its address; `stub` has its name and
    signature."""

    def __init__(self, stub: Callable[_Arguments, _Result]) -> None:
        self.stub, self.name = stub, stub.__name__
        functools.update_wrapper(self, stub)

    def bind(self, function: Any) -> None:
        """Set the C function; required before a kernel that calls it runs."""
        ctypes.c_void_p.in_dll(load().shared, f"fj_{self.name}").value = c_address(function)

    def __call__(self, *arguments: _Arguments.args, **keywords: _Arguments.kwargs) -> _Result:
        return self.stub(*arguments, **keywords)


external = External


def entry_point(kernel: Any) -> int:
    """Address of a kernel of pointers and numbers as a C function."""
    entry = load(_name(kernel.py_func)).entries[_name(kernel.py_func)]
    return c_address(getattr(load().shared, entry.symbol))


def c_address(function: Any) -> int:
    """Address of a C function."""
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _name(function: Any) -> str:
    return f"{function.__module__}.{function.__qualname__}"


def _kernel(function: _Function, in_line: bool) -> _Function:
    name = _name(function)
    ours = name.startswith("frictionjoint.")
    made: Any = native(function) if ours and not PLAIN else function
    made.py_func, made.in_line = function, in_line
    if ours:
        registry[name] = made
    return cast("_Function", made)


def native(function: _Function) -> _Function:
    """The C function of a kernel of this package, also where kernels run as Python."""
    # a namespace of its own, where the C function takes the place of `_first_call`
    space: dict[str, Any] = {"_first_call": _first_call}
    made: Any = types.FunctionType(_waiting.__code__, space, function.__name__)
    functools.update_wrapper(made, function)
    space["_self"], made.py_func = made, function
    return cast("_Function", made)


def _waiting(*arguments: Any, **keywords: Any) -> Any:
    """Placeholder until a kernel is first called; `_self` is the kernel."""
    return _first_call(_self)(*arguments, **keywords)  # type: ignore[name-defined] # noqa: F821


def _first_call(kernel: Any) -> Any:
    """Replace a kernel by a call of its C function, with arguments checked once."""
    name = _name(kernel.py_func)
    library = load(name)
    entry = library.entries[name]
    space = kernel.__globals__
    space["_native"] = getattr(library.shared, entry.symbol)
    space.update(_CONVERSIONS)
    namespace: dict[str, Any] = {}
    exec(_call_text(kernel, entry, space), namespace)
    kernel.__code__ = namespace["call"].__code__
    return kernel


def _call_text(kernel: Any, entry: Entry, space: dict[str, Any]) -> str:
    """Python text of a kernel's call; the C function gets its types."""
    native = space["_native"]
    given: list[str] = []
    kinds: list[Any] = []
    for p in entry.parameters:
        kinds.append(_NUMBERS.get(p.kind, ctypes.c_void_p))
        if p.kind in _ARRAYS:
            given.append(f"{_ARRAYS[p.kind]}({p.name}{', True' if p.written else ''})")
            given += [f"{p.name}.shape[{axis}]" for axis in p.axes]
            kinds += [ctypes.c_int64] * len(p.axes)
        elif p.kind == "int":
            given.append(f"_int({p.name})")
        elif p.kind in ("double", "char *"):
            given.append(p.name)
        else:
            make = functools.partial(_made, _structure(p.kind)) if is_tuple(p.kind) else None
            space[f"_make_{p.name}"] = make or _structure_with(p.fields)
            given.append(f"_address_of(_make_{p.name}({p.name}))")
    if is_tuple(entry.result):
        kinds.append(ctypes.c_void_p)
        space["_structure"] = _structure(entry.result)
        inner = ", ".join([*given, "_address_of(out)"])
        lines = f"    out = _structure()\n    _native({inner})\n    return _taken(out)"
    else:
        flag = " != 0" if entry.result == "bool" else ""
        lines = f"    return _native({', '.join(given)}){flag}"
    native.argtypes, native.restype = kinds, _NUMBERS.get(entry.result)
    names = ", ".join(inspect.signature(kernel.py_func).parameters)
    return f"def call({names}):\n{lines}\n"


_NUMBERS = {"double": ctypes.c_double, "int": ctypes.c_int64, "bool": ctypes.c_int64}
_ARRAYS = {
    "double *": "_reals",
    "int64_t *": "_wholes",
    "uint8_t *": "_flags",
    "int32_t *": "_shorts",
}
TUPLE = "fj_tuple_"
"""How the names of tuples begin in C: see `frictionjoint.translate.kinds`."""


def is_tuple(kind: str | None) -> bool:
    """Whether a kind, the C type of a value, is a tuple."""
    return kind is not None and kind.startswith(TUPLE)


def elements(kind: str) -> list[str]:
    """Kinds of the elements of a tuple."""
    found: list[str] = []
    depth = 0
    for letter in kind.removeprefix(TUPLE)[1:-1]:
        if depth == 0:
            found.append("")
        found[-1] += letter
        depth += (letter == "T") - (letter == "E")
    return [{"d": "double", "i": "int"}.get(text) or TUPLE + text for text in found]


@functools.cache
def _structure(kind: str) -> Any:
    """ctypes structure of a tuple."""
    types = (_NUMBERS.get(part) or _structure(part) for part in elements(kind))
    names = [(f"_{i}", part) for i, part in enumerate(types)]
    return type("Tuple", (ctypes.Structure,), {"_fields_": names})


def _structure_with(fields: dict[str, str]) -> Callable[[Any], Any]:
    """Convert a NamedTuple to the structure of a kernel, arrays followed by three lengths."""
    members: list[Any] = []
    for name, kind in fields.items():
        if kind in _ARRAYS:
            members += [(name, ctypes.c_void_p), (f"{name}_n", ctypes.c_int64 * 3)]
        else:
            members.append((name, _NUMBERS[kind]))
    structure = type("Named", (ctypes.Structure,), {"_fields_": members})

    def make(values: Any) -> Any:
        made: Any = structure()
        for name, kind in fields.items():
            value = getattr(values, name)
            if kind in _ARRAYS:
                setattr(made, name, _CONVERSIONS[_ARRAYS[kind]](value))
                getattr(made, f"{name}_n")[: value.ndim] = value.shape
            else:
                setattr(made, name, value)
        return made

    return make


def _taken(structure: Any) -> tuple[Any, ...]:
    values = [getattr(structure, name) for name, _ in structure._fields_]
    return tuple(_taken(x) if isinstance(x, ctypes.Structure) else x for x in values)


def _made(structure: Any, values: Any) -> Any:
    """A structure with the numbers of a tuple."""
    pairs = zip(values, structure._fields_, strict=True)
    return structure(*(_made(kind, x) if isinstance(x, tuple) else x for x, (_, kind) in pairs))


def _converter(kind: Any) -> Callable[..., int]:
    """Address of an array's numbers; a TypeError for another type, gaps, or a read-only array."""
    wanted = np.dtype(kind)
    view = (ctypes.c_char * 0).from_buffer
    address_of = ctypes.addressof

    def address(array: Any, written: bool = False) -> int:
        if array.dtype is not wanted and array.dtype != wanted:
            raise TypeError(f"a kernel takes an array of {wanted}, not of {array.dtype}")
        try:
            return address_of(view(array))
        except TypeError:
            if not array.flags.c_contiguous:
                raise TypeError(
                    "a kernel takes arrays without gaps: use np.ascontiguousarray"
                ) from None
            if written:
                raise TypeError("a kernel writes to an array that is read-only: copy it") from None
            return int(array.ctypes.data)

    return address


_CONVERSIONS: dict[str, Callable[..., Any]] = {
    "_reals": _converter(np.float64),
    "_wholes": _converter(np.int64),
    "_flags": _converter(np.bool_),
    "_shorts": _converter(np.int32),
    "_int": int,
    "_address_of": ctypes.byref,
    "_taken": _taken,
}
