"""Write `frictionjoint.law.tangents`: the laws' kernels with their derivatives along.

    python -m frictionjoint.law.generate_tangents

A law is written once, as a scalar function for numba. Here its source is differentiated, statement
by statement, in forward mode: before ``x = f(y, z)`` comes ``x_t = df/dy y_t + df/dz z_t``, whose
factors are numbers and serve every direction (`frictionjoint.law.tangent`). Arrays P and X get
P_t and X_t, a call hands numbers on with their tangents and returns both. Tests, counts and the
given motion have no tangent and stay as they are, so that at a sample where an event happens the
derivative is one-sided. Tangents that nothing asks for are left out.

What the rewriting knows about: scalar arithmetic, `while`, `for ... in range`, `if`, calls of other
kernels, `math`, and arrays by subscript. Anything else is an error, never a guess; so is a test for
equality of a number that has a tangent, which would hide a derivative: such functions have theirs
in `frictionjoint.law.tangent_rules`.
"""

import ast
import inspect
import subprocess
import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from frictionjoint.law import (
    armstrong,
    dahl,
    elastoplastic,
    integrated,
    lugre,
    maxwell_slip,
    memory,
    relaxation,
    static,
    stribeck,
    tangent_rules,
)

FILE = Path(__file__).with_name("tangents.py")
_RULES: dict[Any, Any] = {
    stribeck.stribeck_level: tangent_rules.stribeck_level,
    relaxation.advance: tangent_rules.advance,
    relaxation.distance: tangent_rules.distance,
    relaxation.rate: tangent_rules.rate,
    dahl.remaining: tangent_rules.remaining,
}
_ROOTS: tuple[tuple[Any, frozenset[str]], ...] = tuple(
    (function, frozenset())
    for function in (
        integrated.start,
        integrated.step,
        memory.make_room,
        static.step,
        armstrong.step,
        dahl.step,
        lugre.step,
        elastoplastic.step,
        maxwell_slip.step,
    )
)
# Names in an index that mark a count, a flag or a choice among the numbers of an array.
_MARKS = [
    {name}
    for name in (
        *("DIRECTION", "N_MIN", "N_MAX", "VIRGIN", "FORGOTTEN", "BOUND", "LAMPAERT", "MASING"),
        *("SLIDING", "N_ELEMENTS"),
    )
] + [{"HEADER", "n"}]
# the exponent of the integrated law is a choice, that of Dahl's a number
_MARKS_OF = {integrated: [{"EXPONENT"}]}
# At the fixed point r = 1 the torque stays; its tangent goes on as that of any other step does.
_SHORT_CUTS = {"if r == 1.0:\n    break"}

# A bound that only rounding passes: the tangent is that of the second argument.
_ROUNDING = {"max(0.0, reach)"}
# The end of a loop, where the equality holds by assignment.
_HARMLESS = {"d == a"}

_DERIVATIVES: dict[str, Callable[[str, str], str]] = {
    # of the function's value y at x
    "exp": lambda x, y: y,
    "expm1": lambda x, y: f"{y} + 1.0",
    "log": lambda x, y: f"1.0 / ({x})",
    "log1p": lambda x, y: f"1.0 / (1.0 + {x})",
    "sin": lambda x, y: f"math.cos({x})",
}

_LAWS = ("static", "armstrong", "dahl", "lugre", "elastoplastic", "maxwell_slip")
_SIGNATURE = """@compiled
def drive_{law}(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
) -> None:"""
_INTEGRATED = (
    _SIGNATURE
    + """
    X = np.zeros(memory.HEADER + 2 * memory.CAPACITY)
    X_t = np.zeros((len(X), DIRECTIONS))
    integrated_start(P, P_t, 1, X, X_t, 0, memory.HEADER)
    H[0], H_t[:, 0] = 0.0, 0.0
    rate[0], rate_t[:, 0] = X[memory.RATE], 0.0
    for k in range(1, len(position)):
        dq = position[k] - position[k - 1]
        dt = time[k] - time[k - 1]
        integrated_step(P, P_t, 1, X, X_t, 0, 0, memory.HEADER, dq, dt, dq / dt)
        memory_make_room(X, X_t, 0, memory.HEADER)
        H[k], rate[k] = X[memory.FH], X[memory.RATE]
        for i in range(len(H_t)):
            H_t[i, k], rate_t[i, k] = X_t[memory.FH, i], X_t[memory.RATE, i]
"""
)
_RIVAL = (
    _SIGNATURE
    + """
    X = np.zeros(row_size(P, 0))
    X_t = np.zeros((len(X), DIRECTIONS))
    start_row(P, 0, X, 0)
    H[0], H_t[:, 0] = 0.0, 0.0
    rate[0], rate_t[:, 0] = X[bristle.RATE], 0.0
    for k in range(1, len(position)):
        dq = position[k] - position[k - 1]
        dt = time[k] - time[k - 1]
        {law}_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
        H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]
"""
)

Form = dict[str, ast.expr]  # factors of tangents, by the tangents' source


class UnknownError(Exception):
    """A construct that the rewriting does not know."""


def source() -> str:
    """The text of `frictionjoint.law.tangents`."""
    done: dict[Any, _Function] = {}

    def add(function: Any, moving: frozenset[str], wanted: bool) -> None:
        if function in done:
            if done[function].signature != (moving, wanted):
                raise UnknownError(f"{function} is called in two ways: {moving}, {wanted}")
            return
        made = _Function(function, moving, wanted)
        for callee in made.calls:
            add(*callee)
        done[function] = made

    for function, moving in _ROOTS:
        add(function, moving, False)
    modules = sorted({made.module for made in done.values()} | {"bristle"})
    drivers = [_INTEGRATED.format(law="integrated"), *(_RIVAL.format(law=x) for x in _LAWS)]
    body = "\n\n".join([*(made.text for made in done.values()), *drivers])
    helpers = [x for x in ("ZERO", "at", "put", "scaled", "sum2", "sum3", "sum4") if x in body]
    return f'''"""The laws' kernels with their tangents; `generate_tangents` writes this file."""

import math

import numpy as np

from frictionjoint.arrays import Array, Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import {", ".join(modules)}, tangent_rules
from frictionjoint.law.kernel import row_size, start_row
from frictionjoint.law.tangent import DIRECTIONS, {", ".join(helpers)}, Tangent, Tangents

{body}
'''


class _Function:
    """One kernel with tangents: `text`, and the kernels it calls in `calls`."""

    def __init__(self, function: Any, moving: frozenset[str], wanted: bool) -> None:
        """Translate.

        Args:
            function: compiled by numba. moving: its arguments, numbers, that have a tangent.
            wanted: whether the caller uses the value returned.
        """
        self.signature = (moving, wanted)
        self.wanted = wanted
        self.python = function.py_func
        self.owner: Any = inspect.getmodule(self.python)
        self.module = self.owner.__name__.rpartition(".")[2]
        self.calls: list[tuple[Any, frozenset[str], bool]] = []
        tree = ast.parse(textwrap.dedent(inspect.getsource(self.python))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        body = tree.body[1:] if ast.get_docstring(tree) else tree.body
        body = _plain(body) if wanted else _without_value(_plain(body))
        self.arguments = {a.arg: ast.unparse(a.annotation) for a in tree.args.args if a.annotation}
        self.vectors = {name for name, kind in self.arguments.items() if kind == "Vector"}
        stored = {n.id for s in body for n in ast.walk(s) if _is_stored(n)}
        self.locals = set(self.arguments) | stored
        self.count = 0
        self.varied = set(moving)
        self._fixpoint(body, self.varied, self._spread)
        self.used: set[str] = set()
        self._fixpoint(body, self.used, self._need)
        self.used &= self.varied
        statements = [
            f"{name}_t = ZERO"
            for name in self.arguments
            if name in self.used and name not in moving
        ]
        statements += self._statements(body)
        self.text = self._head(function, tree, moving) + textwrap.indent(
            "\n".join(statements), "    "
        )

    def _head(self, function: Any, tree: ast.FunctionDef, moving: frozenset[str]) -> str:
        options = function.targetoptions
        small = options.get("inline") == "always" or options.get("forceinline")
        arguments = []
        for name, kind in self.arguments.items():
            arguments.append(f"{name}: {kind}")
            if name in self.vectors:
                arguments.append(f"{name}_t: Tangents")
            elif name in moving:
                arguments.append(f"{name}_t: Tangent")
        returned = "tuple[float, Tangent]" if self.wanted else "None"
        name = _name(function)
        return (
            f"@{'in_line' if small else 'compiled'}\n"
            f"def {name}({', '.join(arguments)}) -> {returned}:\n"
        )

    # which numbers have a tangent, and which of them is used

    def _fixpoint(
        self, body: list[ast.stmt], names: set[str], grow: Callable[[ast.stmt], Iterable[str]]
    ) -> None:
        while True:
            found = {x for s in body for node in ast.walk(s) for x in grow(node)}  # type: ignore[arg-type]
            if found <= names:
                return
            names |= found

    def _spread(self, node: ast.AST) -> Iterable[str]:
        if isinstance(node, ast.Assign) and self._moves(node.value):
            target = node.targets[0]
            if isinstance(target, ast.Name):
                return {target.id}
        return ()

    def _need(self, node: ast.AST) -> Iterable[str]:
        if isinstance(node, ast.Assign):
            target = node.targets[0]
            needed = target.id in self.used if isinstance(target, ast.Name) else True
            if isinstance(target, ast.Subscript):
                needed = not self._is_mark(target)
            return self._leaves(node.value) if needed else ()
        if isinstance(node, ast.Return) and node.value is not None and self.wanted:
            return self._leaves(node.value)
        if isinstance(node, ast.Call) and self._kernel(node) and self._moves(node):
            return {x for a in node.args for x in self._leaves(a)}
        return ()

    def _leaves(self, node: ast.expr) -> set[str]:
        """Names with a tangent that a value's tangent is made of."""
        if not self._moves(node):
            return set()
        if isinstance(node, ast.Name):
            return {node.id}
        return {x for child in _parts(node) for x in self._leaves(child)}

    def _moves(self, node: ast.expr) -> bool:
        """Whether a value has a tangent, or a call sets one."""
        if isinstance(node, ast.Name):
            return node.id in self.varied
        if isinstance(node, ast.Subscript):
            return not self._is_mark(node)
        if isinstance(node, ast.Compare | ast.BoolOp | ast.Constant | ast.Attribute):
            return False
        if isinstance(node, ast.Call):
            kernel = self._kernel(node)
            if kernel is not None:
                kind = inspect.signature(kernel.py_func).return_annotation
                if kind not in (float, None):
                    return False
                on_array = any(ast.unparse(a) in self.vectors for a in node.args)
                return on_array or any(self._moves(a) for a in node.args)
            if ast.unparse(node.func) in ("int", "len", "range"):
                return False
        return any(self._moves(child) for child in _parts(node))

    def _is_mark(self, node: ast.Subscript) -> bool:
        names = {n.id for n in ast.walk(node.slice) if isinstance(n, ast.Name)}
        return any(mark <= names for mark in _MARKS + _MARKS_OF.get(self.owner, []))

    # statements

    def _statements(self, body: list[ast.stmt]) -> list[str]:
        return [line for statement in body for line in self._statement(statement)]

    def _statement(self, node: ast.stmt) -> list[str]:
        if isinstance(node, ast.Assign):
            return self._assign(node.targets[0], node.value)
        if isinstance(node, ast.If):
            lines = [f"if {self._test(node.test)}:", *_indented(self._statements(node.body))]
            if node.orelse:
                lines += ["else:", *_indented(self._statements(node.orelse))]
            return lines
        if isinstance(node, ast.While) and not node.orelse:
            return [f"while {self._test(node.test)}:", *_indented(self._statements(node.body))]
        if isinstance(node, ast.For) and not node.orelse:
            head = f"for {ast.unparse(node.target)} in {self._plain(node.iter)}:"
            return [head, *_indented(self._statements(node.body))]
        if isinstance(node, ast.Break | ast.Continue):
            return [ast.unparse(node)]
        if isinstance(node, ast.Return):
            if not self.wanted or node.value is None:
                return ["return"]
            if isinstance(node.value, ast.IfExp) and self._moves(node.value):
                choice = node.value
                return [
                    f"if {self._test(choice.test)}:",
                    *_indented(self._statement(ast.Return(choice.body))),
                    *self._statement(ast.Return(choice.orelse)),
                ]
            before, value, form = self._split(node.value)
            return [*before, f"return {_text(value)}, {_combined(form)}"]
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            return [self._call(node.value, False, [])]
        raise self._unknown(node)

    def _assign(self, target: ast.expr, value: ast.expr) -> list[str]:
        name = ast.unparse(target)
        if isinstance(value, ast.IfExp) and self._moves(value):
            return [
                f"if {self._test(value.test)}:",
                *_indented(self._assign(target, value.body)),
                "else:",
                *_indented(self._assign(target, value.orelse)),
            ]
        if isinstance(target, ast.Subscript):
            place = self._plain(target)
            array, index = ast.unparse(target.value), self._plain(target.slice)
            if self._is_mark(target):
                return [f"{place} = {self._plain(value)}"]
            before, new, form = self._split(value)
            put = f"put({array}_t, {index}, {_combined(form)})"
            return [*before, put, f"{place} = {_text(new)}"]
        if name not in self.used:
            return [f"{name} = {self._plain(value)}"]
        if isinstance(value, ast.Call) and self._kernel(value) and self._moves(value):
            before: list[str] = []
            call = self._call(value, True, before)
            return [*before, f"{name}, {name}_t = {call}"]
        before, new, form = self._split(value)
        return [*before, f"{name}_t = {_combined(form)}", f"{name} = {_text(new)}"]

    def _test(self, node: ast.expr) -> str:
        for part in ast.walk(node):
            if isinstance(part, ast.Compare):
                same = any(isinstance(op, ast.Eq | ast.NotEq) for op in part.ops)
                if (
                    same
                    and ast.unparse(part) not in _HARMLESS
                    and any(self._moves(x) for x in (part.left, *part.comparators))
                ):
                    raise self._unknown(node)
        return self._plain(node)

    # expressions

    def _split(self, node: ast.expr) -> tuple[list[str], ast.expr, Form]:
        """Statements to go before, the value, and its tangent as a sum of tangents."""
        before: list[str] = []
        value, form = self._differentiate(node, before)
        return before, value, form

    def _differentiate(self, node: ast.expr, before: list[str]) -> tuple[ast.expr, Form]:
        if not self._moves(node):
            return self._plain_tree(node), {}
        if isinstance(node, ast.Name):
            return node, {f"{node.id}_t": _one()}
        if isinstance(node, ast.Subscript):
            place = self._plain_tree(node)
            array, index = ast.unparse(node.value), self._plain(node.slice)
            return place, {f"at({array}_t, {index})": _one()}
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            value, form = self._differentiate(node.operand, before)
            return ast.UnaryOp(node.op, value), _opposite(form)
        if isinstance(node, ast.BinOp):
            return self._binary(node, before)
        if isinstance(node, ast.Call):
            return self._function(node, before)
        raise self._unknown(node)

    def _binary(self, node: ast.BinOp, before: list[str]) -> tuple[ast.expr, Form]:
        a, of_a = self._differentiate(node.left, before)
        b, of_b = self._differentiate(node.right, before)
        value = ast.BinOp(a, node.op, b)
        if isinstance(node.op, ast.Add):
            return value, _sum(of_a, of_b)
        if isinstance(node.op, ast.Sub):
            return value, _sum(of_a, _opposite(of_b))
        if isinstance(node.op, ast.Mult):
            return value, _sum(_times(of_a, b), _times(of_b, a))
        if isinstance(node.op, ast.Div):
            by_a = _expression(f"1.0 / ({_text(b)})")
            by_b = _expression(f"-({_text(value)}) * (1.0 / ({_text(b)}))")
            return value, _sum(_times(of_a, by_a), _times(of_b, by_b))
        if isinstance(node.op, ast.Pow):
            y = self._held(value, before)
            by_a = _expression(f"({_text(b)}) * {y.id} / ({_text(a)})")
            by_b = _expression(f"{y.id} * math.log({_text(a)})")
            return y, _sum(_times(of_a, by_a), _times(of_b, by_b))
        raise self._unknown(node)

    def _function(self, node: ast.Call, before: list[str]) -> tuple[ast.expr, Form]:
        if self._kernel(node) is not None:
            call = self._call(node, True, before)
            name = self._new()
            before.append(f"{name}, {name}_t = {call}")
            return _expression(name), {f"{name}_t": _one()}
        name = ast.unparse(node.func)
        parts = [self._differentiate(a, before) for a in node.args]
        if ast.unparse(node) in _ROUNDING:
            return ast.Call(node.func, [x for x, _ in parts], []), parts[1][1]
        if name in ("min", "max") and len(parts) == 2:
            return self._extreme(name, parts, before)
        (x, form), *more = parts
        if name == "abs":
            return ast.Call(node.func, [x], []), _times(
                form, _expression(f"math.copysign(1.0, {_text(x)})")
            )
        derivative = _DERIVATIVES.get(name.removeprefix("math."))
        if more or derivative is None:
            raise self._unknown(node)
        y = self._held(ast.Call(node.func, [x], []), before)
        return y, _times(form, _expression(derivative(_text(x), y.id)))

    def _extreme(
        self, name: str, parts: list[tuple[ast.expr, Form]], before: list[str]
    ) -> tuple[ast.expr, Form]:
        (a, of_a), (b, of_b) = parts
        made = self._new()
        test = _smaller(a, b) if name == "min" else _smaller(b, a)
        before += [
            f"if {test}:",
            f"    {made}, {made}_t = {_text(a)}, {_combined(of_a)}",
            "else:",
            f"    {made}, {made}_t = {_text(b)}, {_combined(of_b)}",
        ]
        return _expression(made), {f"{made}_t": _one()}

    def _held(self, value: ast.expr, before: list[str]) -> ast.Name:
        name = self._new()
        before.append(f"{name} = {_text(value)}")
        return ast.Name(name, ast.Load())

    def _new(self) -> str:
        self.count += 1
        name = f"y{self.count}"
        assert name not in self.locals
        return name

    def _call(self, node: ast.Call, wanted: bool, before: list[str]) -> str:
        """Call of a kernel with tangents."""
        kernel = self._kernel(node)
        if kernel is None:
            raise self._unknown(node)
        names = list(inspect.signature(kernel.py_func).parameters)
        rule = _RULES.get(kernel)
        takes = set(inspect.signature(rule.py_func).parameters) if rule else None
        arguments: list[str] = []
        moving: set[str] = set()
        for name, argument in zip(names, node.args, strict=True):
            if ast.unparse(argument) in self.vectors:
                arguments += [ast.unparse(argument), f"{ast.unparse(argument)}_t"]
                continue
            value, form = self._differentiate(argument, before)
            arguments.append(_text(value))
            if f"{name}_t" in takes if takes is not None else self._moves(argument):
                moving.add(name)
                arguments.append(_combined(form))
            elif form:
                raise self._unknown(node)
        if rule:
            return f"tangent_rules.{rule.py_func.__name__}({', '.join(arguments)})"
        self.calls.append((kernel, frozenset(moving), wanted))
        return f"{_name(kernel)}({', '.join(arguments)})"

    def _kernel(self, node: ast.Call) -> Any:
        name = ast.unparse(node.func)
        found = self.python.__globals__.get(name)
        return found if hasattr(found, "py_func") else None

    def _plain(self, node: ast.expr) -> str:
        return _text(self._plain_tree(node))

    def _plain_tree(self, node: ast.expr) -> ast.expr:
        """The same expression outside its module."""

        class Rename(ast.NodeTransformer):
            def visit_Name(inner, name: ast.Name) -> ast.expr:  # noqa: N805
                if name.id in self.locals or name.id not in self.python.__globals__:
                    return name
                if name.id == "math":
                    return name
                return _expression(f"{self.module}.{name.id}")

        made: ast.expr = Rename().visit(_expression(ast.unparse(node)))
        return made

    def _unknown(self, node: ast.AST) -> UnknownError:
        where = f"{self.python.__module__}.{self.python.__name__}"
        return UnknownError(f"{where} cannot be differentiated: {ast.unparse(node)!r}")


def _name(function: Any) -> str:
    python = function.py_func
    return f"{python.__module__.rpartition('.')[2]}_{python.__name__.strip('_')}"


def _plain(body: list[ast.stmt]) -> list[ast.stmt]:
    """Without short cuts, and with assignments one by one: of `x += y` and of `x, y = a, b`."""
    made: list[ast.stmt] = []
    for node in body:
        if ast.unparse(node) in _SHORT_CUTS:
            continue
        if isinstance(node, ast.If | ast.While | ast.For):
            node.body, node.orelse = _plain(node.body), _plain(node.orelse)
        if isinstance(node, ast.AugAssign):
            left = _expression(ast.unparse(node.target))
            made.append(_assignment(node.target, ast.BinOp(left, node.op, node.value)))
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Tuple):
            made += _one_by_one(node, node.targets[0].elts)
        elif isinstance(node, ast.Assign) and len(node.targets) > 1:
            *others, last = node.targets
            made.append(_assignment(last, node.value))
            made += [_assignment(t, _expression(ast.unparse(last))) for t in others]
        else:
            made.append(node)
    return made


def _one_by_one(node: ast.Assign, targets: list[ast.expr]) -> list[ast.stmt]:
    """`x, y = a, b` where nothing uses what was set before it."""
    if not isinstance(node.value, ast.Tuple):
        raise UnknownError(ast.unparse(node))
    seen: set[str] = set()
    for target, value in zip(targets, node.value.elts, strict=True):
        if seen & {n.id for n in ast.walk(value) if isinstance(n, ast.Name)}:
            raise UnknownError(ast.unparse(node))
        seen.add(ast.unparse(target))
    return [_assignment(t, x) for t, x in zip(targets, node.value.elts, strict=True)]


def _assignment(target: ast.expr, value: ast.expr) -> ast.stmt:
    return ast.parse(f"{ast.unparse(target)} = {ast.unparse(value)}").body[0]


def _without_value(body: list[ast.stmt]) -> list[ast.stmt]:
    """Without the value returned, and without what was computed for it alone."""
    returns = [n for s in body for n in ast.walk(s) if isinstance(n, ast.Return)]
    for node in returns:
        node.value = None
    if isinstance(body[-1], ast.Return):
        body = body[:-1]
    while True:
        names = [n for s in body for n in ast.walk(s) if isinstance(n, ast.Name)]
        loaded = {n.id for n in names if isinstance(n.ctx, ast.Load)}
        left = [s for s in body if not (isinstance(s, ast.Assign) and _unused(s, loaded))]
        if len(left) == len(body):
            return left
        body = left


def _unused(node: ast.Assign, loaded: set[str]) -> bool:
    target = node.targets[0]
    return isinstance(target, ast.Name) and target.id not in loaded


def _is_stored(node: ast.AST) -> bool:
    return isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)


def _parts(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.Call):
        return list(node.args)
    if isinstance(node, ast.IfExp):
        return [node.body, node.orelse]
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines or ["pass"]]


def _expression(text: str) -> Any:
    return ast.parse(text, mode="eval").body


def _text(node: ast.expr) -> str:
    return ast.unparse(ast.fix_missing_locations(node))


def _one() -> ast.expr:
    return ast.Constant(1.0)


def _smaller(a: ast.expr, b: ast.expr) -> str:
    if isinstance(a, ast.Constant):
        return f"{_text(b)} >= {_text(a)}"
    return f"{_text(a)} <= {_text(b)}"


def _product(a: ast.expr, b: ast.expr) -> ast.expr:
    if _is_one(a) or _is_one(b):
        return b if _is_one(a) else a
    for x, y in ((a, b), (b, a)):
        if isinstance(x, ast.UnaryOp) and isinstance(x.op, ast.USub):
            return _negative(_product(x.operand, y))
    return ast.BinOp(a, ast.Mult(), b)


def _negative(node: ast.expr) -> ast.expr:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return node.operand
    return ast.UnaryOp(ast.USub(), node)


def _is_one(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1.0


def _times(form: Form, factor: ast.expr) -> Form:
    return {name: _product(factor, x) for name, x in form.items()}


def _opposite(form: Form) -> Form:
    return {name: _negative(x) for name, x in form.items()}


def _sum(a: Form, b: Form) -> Form:
    both = dict(a)
    for name, x in b.items():
        both[name] = ast.BinOp(both[name], ast.Add(), x) if name in both else x
    return both


def _combined(form: Form) -> str:
    """A sum of tangents as a call."""
    if not form:
        return "ZERO"
    if len(form) > 4:
        terms = list(form.items())
        first, others = _combined(dict(terms[:4])), _combined(dict(terms[4:]))
        return f"sum2(1.0, {first}, 1.0, {others})"
    if len(form) == 1:
        ((name, x),) = form.items()
        return name if _is_one(x) else f"scaled({_text(x)}, {name})"
    terms = ", ".join(f"{_text(x)}, {name}" for name, x in form.items())
    return f"sum{len(form)}({terms})"


if __name__ == "__main__":
    FILE.write_text(source())
    for command in ("format", "check --select I --fix"):
        subprocess.run(["ruff", *command.split(), "--quiet", str(FILE)], check=True)
