"""The compiled kernels as C99 functions, from the one source that numba compiles.

`frictionjoint.law` and `frictionjoint.effects` are written once, as scalar Python functions for
numba. `source` translates such a function and all it calls, statement by statement, so a
controller runs the very law that was identified, not a second version that could differ. Floating
point operations keep their order.

What the translation knows: annotated functions of numbers and vectors, scalar arithmetic, `while`,
`for ... in range`, `if`, calls of other numba functions, `math`, arrays by subscript, `room` of a
constant size, assignments of several values. Anything else is an error, never a guess. `math` is
reduced to exp, log and pow of the C library (`frictionjoint.export.c_math`).
"""

import ast
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from frictionjoint.export.c_expressions import BINARY, POINTER, Expressions, Gathered, safe
from frictionjoint.export.c_math import HELPERS, with_dependencies

# values that a selecting number can take, by module of the kernel and text of the expression
Known = Mapping[tuple[str, str], frozenset[float]]
_WIDTH = 100
# a space at which no line is broken
_GLUE = "\N{NO-BREAK SPACE}"


def source(functions: Iterable[Any], known: Known) -> str:
    """C text of numba functions and all they call, ready to follow ``#include <math.h>``.

    Args:
        functions: compiled by numba, annotated; each becomes `name_of(function)`.
        known: where a kernel selects by a number, the values it can have; what is selected by
            others is left out.
    Raises:
        ModelError: a construct that the translation does not know.
    """
    # by the Python function: callees first
    done: dict[Any, tuple[str, list[bool]]] = {}

    def call(function: Any) -> tuple[str, list[bool]]:
        name = name_of(function)
        if function.py_func not in done:
            if any(name == name_of_plain(other) for other in done):
                raise AssertionError(f"two kernels are called {name}")
            done[function.py_func] = _Function(function, gathered, known).translate()
        return name, done[function.py_func][1]

    gathered = Gathered(call)
    for function in functions:
        call(function)
    helpers = [HELPERS[name] for name in with_dependencies(gathered.helpers)]
    texts = [text for text, _ in done.values()]
    return "\n\n".join([*helpers, *_constants(gathered.constants), *texts])


def name_of(function: Any) -> str:
    """The C name of a numba function."""
    return name_of_plain(function.py_func)


def name_of_plain(plain: Any) -> str:
    """The C name of what numba compiled a function from."""
    return "_".join(["fj", *plain.__module__.split(".")[-2:], plain.__name__.strip("_")])


class _Function(Expressions):
    """The translation of one function."""

    def __init__(self, function: Any, gathered: Gathered, known: Known) -> None:
        super().__init__(function, gathered)
        self.known = known
        self.declared: set[str] = set(self.kinds)
        self.counters: set[str] = set()

    def translate(self) -> tuple[str, list[bool]]:
        """C text, and for each parameter whether the function writes to what it points to."""
        tree = self.tree
        doc = ast.get_docstring(tree) or ""
        body = _without_unread(self._fold(tree.body[1:] if doc else tree.body))
        self._infer(body)
        lines = self._block(body, set())
        arguments = [a.arg for a in tree.args.args]
        read = _names(ast.Module(body, []))
        lines = [f"(void){safe(name)};" for name in arguments if name not in read] + lines
        parameters = ", ".join(map(self._parameter, arguments))
        head = _wrapped(f"static inline {self.result} {name_of_plain(self.plain)}({parameters})")
        inner = "\n".join(_wrapped("    " + line) for line in lines)
        return f"{comment(doc)}{head}\n{{\n{inner}\n}}", [a in self.written for a in arguments]

    def _parameter(self, name: str) -> str:
        kind = self.kinds[name]
        const = "const " if kind == POINTER and name not in self.written else ""
        return f"{const}{kind}{'' if kind == POINTER else ' '}{safe(name)}"

    # what is known beforehand

    def _fold(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Without branches that the known values rule out, and what follows a sure return."""
        kept: list[ast.stmt] = []
        for node in body:
            if isinstance(node, ast.If | ast.While | ast.For):
                node.body, node.orelse = self._fold(node.body), self._fold(node.orelse)
            sure = self._decided(node.test) if isinstance(node, ast.If) else None
            if sure is None:
                kept.append(node)
            elif isinstance(node, ast.If):
                kept += node.body if sure else node.orelse
            if kept and isinstance(kept[-1], ast.Return):
                break
        return kept

    def _decided(self, test: ast.expr) -> bool | None:
        if not isinstance(test, ast.Compare) or not isinstance(test.ops[0], ast.Eq | ast.NotEq):
            return None
        module = ".".join(self.plain.__module__.split(".")[-2:])
        values = self.known.get((module, ast.unparse(test.left)))
        if values is None:
            return None
        right = test.comparators[0]
        value = right.value if isinstance(right, ast.Constant) else self.look_up(right)
        equal = isinstance(test.ops[0], ast.Eq)
        if value not in values:
            return not equal
        return equal if len(values) == 1 else None

    # types of locals

    def _infer(self, body: list[ast.stmt]) -> None:
        pairs: list[tuple[ast.expr, ast.expr]] = []
        for node in (n for statement in body for n in ast.walk(statement)):
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    pairs += _matched(target, node.value)
            elif isinstance(node, ast.AugAssign):
                pairs.append((node.target, node.value))
            elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                self.counters.add(node.target.id)
                self.kinds.setdefault(node.target.id, "int")
        own = set(self.kinds)
        for _ in pairs:
            before = dict(self.kinds)
            for to, value in pairs:
                if isinstance(to, ast.Name) and to.id not in own:
                    kind = self.kind(value)
                    if kind and self.kinds.get(to.id) != "double":
                        self.kinds[to.id] = kind
            if before == self.kinds:
                break

    # statements

    def _block(self, body: list[ast.stmt], outside: set[str]) -> list[str]:
        """Lines of a block. `outside`: names that are used after it."""
        lines: list[str] = []
        for i, node in enumerate(body):
            after = _names(ast.Module(body[i + 1 :], [])) | outside
            if isinstance(node, ast.If | ast.While | ast.For):
                shared = sorted(name for name in _names(node) & after if self._is_new(name))
                self.declared.update(shared)
                lines += [f"{self.kinds[name]} {safe(name)} = 0;" for name in shared]
            lines += self._statement(node, after)
        return lines

    def _is_new(self, name: str) -> bool:
        return name in self.kinds and name not in self.declared | self.counters

    def _statement(self, node: ast.stmt, after: set[str]) -> list[str]:
        if isinstance(node, ast.Assign):
            return [line for target in node.targets for line in self._assign(target, node)]
        if isinstance(node, ast.AugAssign) and type(node.op) in BINARY:
            sign = BINARY[type(node.op)][0]
            return [f"{self.target(node.target)} {sign}= {self.text(node.value)};"]
        if isinstance(node, ast.If):
            return self._if(node, after)
        if isinstance(node, ast.While) and not node.orelse:
            endless = isinstance(node.test, ast.Constant) and node.test.value is True
            test = "1" if endless else self.text(node.test)
            return [f"while ({test}) {{", *self._inner(node.body, after), "}"]
        if isinstance(node, ast.For) and not node.orelse:
            return self._for(node, after)
        if isinstance(node, ast.Return):
            return [f"return {self.text(node.value)};" if node.value else "return;"]
        if isinstance(node, ast.Expr):
            return [f"{self.text(node.value)};"]
        if isinstance(node, ast.Break | ast.Continue):
            return [f"{type(node).__name__.lower()};"]
        self.unknown(node)

    def _inner(self, body: list[ast.stmt], after: set[str]) -> list[str]:
        before = set(self.declared)
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
        call, counter = node.iter, node.target
        if not isinstance(call, ast.Call) or ast.unparse(call.func) != "range":
            self.unknown(node)
        # a counter belongs to its loop in C
        if not isinstance(counter, ast.Name) or counter.id in self.declared or len(call.args) > 2:
            self.unknown(node)
        bounds = ["0", *map(self.text, call.args)][-2:]
        name = safe(counter.id)
        head = f"for (int {name} = {bounds[0]}; {name} < {bounds[1]}; {name}++) {{"
        self.declared.add(counter.id)
        inner = self._inner(node.body, after)
        self.declared.discard(counter.id)
        return [head, *inner, "}"]

    def _assign(self, target: ast.expr, node: ast.Assign) -> list[str]:
        pairs = _matched(target, node.value)
        lines: list[str] = []
        stored: set[str] = set()
        for to, value in pairs:
            # one after the other is as good as all at once unless a later value reads what an
            # earlier one has set
            if stored & _names(value):
                self.unknown(node)
            lines.append(self._single(to, value))
            stored |= _names(to)
        if not pairs:
            self.unknown(node)
        return lines

    def _single(self, target: ast.expr, value: ast.expr) -> str:
        if isinstance(value, ast.Call) and self.kind(value) == POINTER:
            name = self.target(target)
            self.declared.add(name)
            return f"double {name}[{self.text(value.args[0])}] = {{0}};"
        text = self.text(value)
        if isinstance(target, ast.Name) and self._is_new(target.id):
            self.declared.add(target.id)
            return f"{self.kinds[target.id]} {safe(target.id)} = {text};"
        return f"{self.target(target)} = {text};"


def _matched(target: ast.expr, value: ast.expr) -> list[tuple[ast.expr, ast.expr]]:
    """Pairs of what is set and to what; none where several are set from one."""
    if not isinstance(target, ast.Tuple):
        return [(target, value)]
    if not isinstance(value, ast.Tuple) or len(value.elts) != len(target.elts):
        return []
    return list(zip(target.elts, value.elts, strict=True))


def _names(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _without_unread(body: list[ast.stmt]) -> list[ast.stmt]:
    """Without assignments of plain values that nothing reads since branches were left out."""
    nodes = [n for n in ast.walk(ast.Module(body, [])) if isinstance(n, ast.Name)]
    read = {n.id for n in nodes if isinstance(n.ctx, ast.Load)}

    def unread(node: ast.stmt) -> bool:
        if not isinstance(node, ast.Assign):
            return False
        calls = [n for n in ast.walk(node.value) if isinstance(n, ast.Call)]
        plain = all(ast.unparse(call.func) in ("int", "float") for call in calls)
        return plain and all(isinstance(t, ast.Name) and t.id not in read for t in node.targets)

    return [node for node in body if not unread(node)]


def _constants(values: Mapping[str, int | float | tuple[float, ...]]) -> list[str]:
    """Definitions of the modules' constants, by kind."""
    whole = [f"{name}{_GLUE}={_GLUE}{x}" for name, x in values.items() if isinstance(x, int)]
    made = [f"#define {name} {x!r}" for name, x in values.items() if isinstance(x, float)]
    blocks = ["\n".join(sorted(made))] if made else []
    if whole:
        inner = _wrapped("    " + ", ".join(sorted(whole)), deeper=0).replace(_GLUE, " ")
        blocks.append(f"enum {{\n{inner}\n}};")
    for name, value in values.items():
        if isinstance(value, tuple):
            numbers = ", ".join(repr(float(x)) for x in value)
            blocks.append(_wrapped(f"static const double {name}[{len(value)}] = {{{numbers}}};"))
    return blocks


def comment(text: str) -> str:
    """The first paragraph as a C comment on lines of its own; nothing for nothing."""
    plain = " ".join(text.split("\n\n")[0].split()).replace("*/", "* /")
    return _wrapped(f"/* {plain} */", deeper=3) + "\n" if plain else ""


def _wrapped(line: str, deeper: int = 4) -> str:
    indent = len(line) - len(line.lstrip())
    return textwrap.fill(
        line,
        _WIDTH,
        subsequent_indent=" " * (indent + deeper),
        break_long_words=False,
        break_on_hyphens=False,
    )
