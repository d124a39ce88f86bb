"""Kernels as C99 functions, translated statement by statement from Python.

So a controller, a simulation and a fit run exactly the law that was identified. The order of
floating point operations is preserved.
"""

import ast
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from frictionjoint.compiled import is_tuple, pointer, room
from frictionjoint.translate.c_expressions import Expressions, Gathered, safe
from frictionjoint.translate.c_math import helpers_of
from frictionjoint.translate.kernel import Known, signature
from frictionjoint.translate.kinds import (
    DOUBLE,
    HEADER,
    NOTHING,
    POINTERS,
    REALS,
    Dialect,
    definitions,
    structure_definitions,
)
from frictionjoint.translate.simple_statements import names_in, stored_in

# C types of integers in external functions, by annotation
_FOREIGN = {"int": "int", "Size": "size_t"}
# a space at which lines are not broken
_GLUE = "\N{NO-BREAK SPACE}"


class Translation:
    """Kernels and all kernels that they call, as C.

    Args:
        functions: marked by `frictionjoint.compiled`. known: see `Kernel.read`.
    Attributes:
        made: each kernel, translated, by the Python function.
        gathered: definitions that the kernels require.
    Raises:
        ModelError: a construct that cannot be translated.
    """

    def __init__(
        self, functions: Iterable[Any], known: Known | None = None, dialect: Dialect = HEADER
    ) -> None:
        self.made: dict[Any, Expressions] = {}
        self._texts: list[str] = []
        self._known = known or {}
        self.gathered = Gathered(dialect, self._call)
        for function in functions:
            self._call(function)

    def _call(self, function: Any) -> Expressions:
        plain = function.py_func
        if plain not in self.made:
            made = _Function(function, self.gathered, self._known)
            if any(made.name == other.name for other in self.made.values()):
                raise AssertionError(f"two kernels are called {made.name}")
            text = made.translate()  # callees come first
            self._texts.append(text)
            made.written &= set(made.parameters)
            self.made[plain] = made
        return self.made[plain]

    def text(self) -> str:
        """C text, to be placed after ``#include <math.h>``."""
        gathered = self.gathered
        tuples = "\n".join(definitions(gathered.tuples, gathered.dialect))
        structures = structure_definitions(gathered.structures.values(), gathered.dialect)
        return "\n\n".join(
            [
                *helpers_of(gathered.helpers, gathered.dialect),
                *([tuples] if tuples else []),
                *structures,
                *_constants(gathered.constants, gathered.dialect),
                *_from_outside(gathered),
                *self._texts,
            ]
        )


def name_of(function: Any) -> str:
    """The C name of a kernel."""
    return f"fj_{signature(function).name}"


class _Function(Expressions):
    """The translation of one function."""

    def __init__(self, function: Any, gathered: Gathered, known: Known) -> None:
        super().__init__(function, gathered)
        self.read(known)
        self.declared: set[str] = set(self.parameters)
        # arrays that this function creates; each exists as long as its block
        nodes = [n for statement in self.body for n in ast.walk(statement)]
        assigned = [n for n in nodes if isinstance(n, ast.Assign)]
        self.rooms = {ast.unparse(n.targets[0]) for n in assigned if self._is_room(n.value)}
        for kind in (*self.kinds.values(), self.result):
            self.noted(kind)

    def translate(self) -> str:
        """C text of the function; afterwards `written` and `axes` are complete."""
        doc = ast.get_docstring(self.tree) or ""
        lines = self._block(self.body, set())
        read = names_in(ast.Module(self.body, []))
        lines = [f"(void){safe(name)};" for name in self.parameters if name not in read] + lines
        taken = [one for name in self.parameters for one in self._parameter(name)]
        head = "static inline" if self.dialect.header else "static"
        if self.in_line and not self.dialect.header:
            head = "FJ_IN_LINE"
        result = self.dialect.type_of(self.result)
        start = _wrapped(f"{head} {result} fj_{self.name}({', '.join(taken) or 'void'})")
        inner = "\n".join(_wrapped("    " + line) for line in lines)
        return f"{comment(doc)}{start}\n{{\n{inner}\n}}"

    def _parameter(self, name: str) -> list[str]:
        kind = self.kinds[name]
        whole = self.dialect.whole
        const = self.dialect.header and kind == REALS and name not in self.written
        own = f"{'const ' if const else ''}{self._declared(name)}"
        return [own, *(f"{whole} {safe(name)}_n{k}" for k in sorted(self.axes.get(name, ())))]

    def _is_room(self, value: ast.expr) -> bool:
        return isinstance(value, ast.Call) and self.called(value) is room

    # statements

    def _block(self, body: list[ast.stmt], outside: set[str]) -> list[str]:
        """Lines of a block, with the names used after it in `outside`."""
        lines: list[str] = []
        for i, node in enumerate(body):
            after = names_in(ast.Module(body[i + 1 :], [])) | outside
            if isinstance(node, ast.If | ast.While | ast.For):
                shared = sorted(name for name in names_in(node) & after if self._is_new(name))
                self.declared.update(shared)
                for name in shared:
                    zero = "{0}" if is_tuple(self.kinds[name]) else "0"
                    lines.append(f"{self._declared(name)} = {zero};")
            lines += self._statement(node, after)
        return lines

    def _declared(self, name: str) -> str:
        return f"{self.dialect.declared(self.kinds[name])}{safe(name)}"

    def _is_new(self, name: str) -> bool:
        return name in self.kinds and name not in self.declared | self.counters | self.rooms

    def _statement(self, node: ast.stmt, after: set[str]) -> list[str]:
        if isinstance(node, ast.Assign):
            return self._assign(node.targets[0], node.value)
        if isinstance(node, ast.If):
            return self._if(node, after)
        if isinstance(node, ast.While) and not node.orelse:
            endless = isinstance(node.test, ast.Constant) and node.test.value is True
            test = "1" if endless else self.text(node.test)
            return [f"while ({test}) {{", *self._inner(node.body, after), "}"]
        if isinstance(node, ast.For) and not node.orelse:
            return self._for(node, after)
        if isinstance(node, ast.Return):
            return [f"return {self.as_kind(node.value, self.result)};" if node.value else "return;"]
        if isinstance(node, ast.Expr):
            return [f"{self.text(node.value)};"]
        if isinstance(node, ast.Break | ast.Continue):
            return [f"{type(node).__name__.lower()};"]
        self.unknown(node)

    def _inner(
        self, body: list[ast.stmt], after: set[str], counter: str | None = None
    ) -> list[str]:
        before = set(self.declared)
        self.declared |= {counter} if counter else set()
        lines = ["    " + line for line in self._block(body, after)]
        self.declared = before
        return lines

    def _if(self, node: ast.If, after: set[str]) -> list[str]:
        made = [f"if ({self.text(node.test)}) {{", *self._inner(node.body, after)]
        if len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If):
            first, *rest = self._if(node.orelse[0], after)
            return [*made, f"}} else {first}", *rest]
        if node.orelse:
            made += ["} else {", *self._inner(node.orelse, after)]
        return [*made, "}"]

    def _for(self, node: ast.For, after: set[str]) -> list[str]:
        counter = node.target
        # in C a counter exists only within its loop
        if not isinstance(counter, ast.Name) or counter.id in self.declared:
            self.unknown(node)
        call = node.iter
        if not isinstance(call, ast.Call) or ast.unparse(call.func) != "range":
            self.unknown(node)
        whole, name = self.dialect.whole, safe(counter.id)
        bounds = ["0", *map(self.text, call.args[:2])][-2:]
        step = f"{name} += {self.text(call.args[2])}" if len(call.args) == 3 else f"{name}++"
        end, first = bounds[1], f"{whole} {name} = {bounds[0]}"
        if not self._stays(call.args[min(len(call.args), 2) - 1], node.body):
            end, first = f"{name}_end", f"{first}, {name}_end = {end}"
        head = f"for ({first}; {name} < {end}; {step}) {{"
        return [head, *self._inner(node.body, after, counter.id), "}"]

    def _stays(self, bound: ast.expr, body: list[ast.stmt]) -> bool:
        """Whether the end of a loop clearly has the same value in each iteration."""
        if any(isinstance(n, ast.Call | ast.Subscript) for n in ast.walk(bound)):
            return False
        return not names_in(bound) & stored_in(ast.Module(body, []))

    # assignments

    def _assign(self, target: ast.expr, value: ast.expr) -> list[str]:
        if not isinstance(target, ast.Tuple):
            return self._single(target, value)
        kind, lines, held = self.kind(value), [], value
        if kind is None:
            self.unknown(value)
        if not isinstance(value, ast.Name):
            held = ast.Name(self._new_name())
            self.kinds[held.id] = self.noted(kind)
            lines = self._single(held, value)
        for i, to in enumerate(target.elts):
            # a variable that is never read is a warning in C
            if not (isinstance(to, ast.Name) and to.id.startswith("_")):
                lines += self._single(to, ast.Subscript(held, ast.Constant(i)))
        return lines

    def _single(self, target: ast.expr, value: ast.expr) -> list[str]:
        if isinstance(value, ast.Call) and self._is_room(value):
            return self._room(target, value)
        if not isinstance(target, ast.Name):
            return [f"{self.target(target)} = {self.text(value)};"]
        kind = self.kinds[target.id]
        if kind in POINTERS:
            self._point(target.id, value)
        text = self.as_kind(value, kind)
        if self._is_new(target.id):
            self.declared.add(target.id)
            return [f"{self._declared(target.id)} = {text};"]
        return [f"{safe(target.id)} = {text};"]

    def _point(self, name: str, value: ast.expr) -> None:
        """Record which array a local pointer points into."""
        if not isinstance(value, ast.Call):
            self.same[name] = value
        while isinstance(value, ast.Call) and self.called(value) is pointer:
            value = value.args[0]
        if isinstance(value, ast.Name):
            self.roots[name] = value.id

    def _room(self, target: ast.expr, value: ast.Call) -> list[str]:
        name, size = self.target(target), value.args[0]
        text = self.text(size)
        calls = any(isinstance(n, ast.Call) for n in ast.walk(size))
        if not calls and not names_in(size) & (self.locals | set(self.parameters)):
            return [f"double {name}[{text}] = {{0}};"]
        count = f"{name}_n0"
        return [
            f"{self.dialect.whole} {count} = {text};",
            f"double {name}[{count} > 0 ? {count} : 1];",
            f"memset({name}, 0, sizeof({name}));",
        ]


def _constants(
    values: Mapping[str, int | float | tuple[float, ...]], dialect: Dialect
) -> list[str]:
    """Definitions of the modules' constants, by kind."""
    whole = [f"{name}{_GLUE}={_GLUE}{int(x)}" for name, x in values.items() if isinstance(x, int)]
    made = [f"#define {name} {x!r}" for name, x in values.items() if isinstance(x, float)]
    blocks = ["\n".join(sorted(made))] if made else []
    if whole:
        inner = _wrapped("    " + ", ".join(sorted(whole)), deeper=0).replace(_GLUE, " ")
        blocks.append(f"enum {{\n{inner}\n}};")
    for name, value in values.items():
        if isinstance(value, tuple):
            kind = DOUBLE if any(isinstance(x, float) for x in value) else dialect.whole
            numbers = ", ".join(map(repr, value))
            blocks.append(_wrapped(f"static const {kind} {name}[{len(value)}] = {{{numbers}}};"))
    return blocks


def _from_outside(gathered: Gathered) -> list[str]:
    """Declarations of tables that Python fills and of functions that Python provides."""
    made = [f"FJ_SHARED int64_t fj_{x.name}[{x.size}];" for x in gathered.tables.values()]
    for outside in gathered.externals.values():
        seen = signature(outside)
        annotated = zip(seen.tree.args.args, seen.kinds.values(), strict=True)
        kinds = [_FOREIGN.get(ast.unparse(a.annotation or a), kind) for a, kind in annotated]
        made.append(f"FJ_SHARED {seen.result} (*fj_{outside.name})({', '.join(kinds) or NOTHING});")
    return ["\n".join(made)] if made else []


def comment(text: str) -> str:
    """First paragraph of a text as a C comment on its own lines; empty for an empty text."""
    plain = " ".join(text.split("\n\n")[0].split()).replace("*/", "* /").replace("/*", "/ *")
    return _wrapped(f"/* {plain} */", deeper=3) + "\n" if plain else ""


def _wrapped(line: str, deeper: int = 4) -> str:
    indent = len(line) - len(line.lstrip())
    return textwrap.fill(
        line,
        width=100,
        subsequent_indent=" " * (indent + deeper),
        break_long_words=False,
        break_on_hyphens=False,
    )
