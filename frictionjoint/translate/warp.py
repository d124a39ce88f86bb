"""Kernels as Warp functions.

Warp compiles Python with a stricter grammar: numbers are not converted implicitly, and a comparison
has exactly two operands. All real numbers are doubles.
"""

import ast
import math
import textwrap
from collections.abc import Iterable
from typing import Any

from frictionjoint.compiled import define, elements, is_tuple, room
from frictionjoint.translate.kernel import Kernel, built_in, is_kernel, signature
from frictionjoint.translate.kinds import DOUBLE, WHOLE
from frictionjoint.translate.simple_statements import names_in, stored_in

_MATH = {"exp", "log", "sin", "cos", "tan", "atan", "tanh", "isnan", "sqrt"}
# Warp lacks both. Kahan's formulas keep the digits that the direct formulas lose.
_PRELUDE = '''
@wp.func
def log1p(x: Any):
    """ln(1 + x)."""
    u = wp.float64(1.0) + x
    if u == wp.float64(1.0):
        return x
    if u == wp.float64(wp.inf):
        return u
    return wp.log(u) * x / (u - wp.float64(1.0))


@wp.func
def expm1(x: Any):
    """exp(x) - 1."""
    u = wp.exp(x)
    if u == wp.float64(1.0):
        return x
    below = u - wp.float64(1.0)
    if below == wp.float64(-1.0) or u == wp.float64(wp.inf):
        return below
    return below * x / wp.log(u)
'''
_OWN = {"log1p", "expm1"}
_ZEROS = {DOUBLE: "wp.float64(0.0)", WHOLE: "int(0)"}


def translate(functions: Iterable[Any], size: int, name: str) -> dict[str, Any]:
    """Warp functions of kernels, each as ``module_function``, in a namespace with Warp itself.

    Args:
        functions: marked by `compiled`; functions that they call are added.
        size: largest number of elements of an array that a function creates.
        name: name of the module into which Warp compiles the functions, and of its cache.
    Raises:
        ModelError: a construct that cannot be translated.
    """
    import warp as wp

    namespace: dict[str, Any] = {"wp": wp, "Any": Any, "__name__": name}
    define(source(functions, size), f"{name}: made from the kernels", namespace)
    return namespace


def source(functions: Iterable[Any], size: int) -> str:
    """The text that `translate` compiles, for reading; functions follow those that they call."""
    done: dict[Any, str] = {}
    vectors: dict[str, str] = {}

    def add(function: Any) -> None:
        if function not in done:
            made = _Function(function, size, vectors)
            text = made.text()
            for callee in made.calls:
                add(callee)
            done[function] = text

    for function in functions:
        add(function)
    constants = "\n".join(f"{name} = {value}" for name, value in vectors.items())
    return "\n\n".join([_PRELUDE, constants, *done.values()]) + "\n"


class _Function(Kernel):
    """One function; `calls` collects the kernels that it calls."""

    purpose = "made a warp function"

    def __init__(self, function: Any, size: int, vectors: dict[str, str]) -> None:
        super().__init__(function)
        self.read()
        self.size, self.vectors = size, vectors
        self.calls: list[Any] = []

    def text(self) -> str:
        code = "\n".join(self._block(self.body, set(self.parameters), set()))
        arguments = ", ".join(f"{name}: Any" for name in self.parameters)
        # CUDA's compiler would inline every function everywhere, which takes minutes
        small = self.in_line and len([*ast.walk(self.tree)]) <= 150
        decorator = "@wp.func" if small else "@wp.func(inline=False)"
        return f"{decorator}\ndef {self.name}({arguments}):\n{textwrap.indent(code, '    ')}"

    # statements

    def _block(self, body: list[ast.stmt], known: set[str], outside: set[str]) -> list[str]:
        """Lines of a block. `known`: names that have a value before the block; names that it sets
        are added. `outside`: names that are used after it."""
        lines: list[str] = []
        for i, node in enumerate(body):
            after = names_in(ast.Module(body[i + 1 :], [])) | outside
            if isinstance(node, ast.While | ast.For):
                # A value used after a loop must be defined before it, or Warp loses it on `break`.
                handed_on = sorted((stored_in(node) & after) - known - self.counters)
                for name in handed_on:
                    zero = _ZEROS.get(self.kinds[name]) or self.unknown(node)
                    lines.append(f"{name} = {zero}")
                known |= set(handed_on)
            lines += self._statement(node, known, after)
        return lines

    def _inner(self, body: list[ast.stmt], known: set[str], after: set[str]) -> list[str]:
        return ["    " + line for line in self._block(body, known, after)]

    def _statement(self, node: ast.stmt, known: set[str], after: set[str]) -> list[str]:
        if isinstance(node, ast.Assign):
            known |= stored_in(node)
            return [self._assign(node.targets[0], node.value)]
        if isinstance(node, ast.If):
            lines = [f"if {self._text(node.test)}:", *self._inner(node.body, known, after)]
            orelse = self._inner(node.orelse, known, after)
            return [*lines, "else:", *orelse] if orelse else lines
        if isinstance(node, ast.While) and not node.orelse:
            head = f"while {self._text(node.test)}:"
            return [head, *self._inner(node.body, known, after | names_in(node))]
        if isinstance(node, ast.For) and not node.orelse:
            if not isinstance(node.iter, ast.Call) or ast.unparse(node.iter.func) != "range":
                self.unknown(node)
            bounds = ", ".join(map(self._text, node.iter.args))
            head = f"for {ast.unparse(node.target)} in range({bounds}):"
            return [head, *self._inner(node.body, known, after | names_in(node))]
        if isinstance(node, ast.Return) and node.value is not None:
            return [f"return {ast.unparse(self._as_kind(node.value, self.result))}"]
        if isinstance(node, ast.Return | ast.Break | ast.Continue):
            return [ast.unparse(node)]
        if isinstance(node, ast.Expr):
            return [self._text(node.value)]
        self.unknown(node)

    def _assign(self, target: ast.expr, value: ast.expr) -> str:
        if isinstance(target, ast.Tuple):
            places = [ast.unparse(self._visit(to)) for to in target.elts]
            return f"{', '.join(places)} = {self._text(value)}"
        kind = self.kind(target)
        new = self._as_kind(value, kind) if kind else self.unknown(target)
        if isinstance(new, ast.Constant):
            # in Warp a literal constant could not change in a loop
            new = _call(type(new.value).__name__, new)
        return f"{ast.unparse(self._visit(target))} = {ast.unparse(new)}"

    # expressions

    def _text(self, node: ast.expr) -> str:
        return ast.unparse(self._visit(node))

    def _as_kind(self, node: ast.expr, kind: str | None) -> ast.expr:
        """Text of a value, converted to the given kind."""
        if isinstance(node, ast.Tuple) and is_tuple(kind):
            pairs = zip(node.elts, elements(kind or ""), strict=True)
            return ast.Tuple([self._as_kind(part, own) for part, own in pairs], ast.Load())
        if isinstance(node, ast.IfExp):
            body, orelse = self._as_kind(node.body, kind), self._as_kind(node.orelse, kind)
            return ast.IfExp(self._visit(node.test), body, orelse)
        made = self._visit(node)
        if kind != DOUBLE or self.kind(node) == DOUBLE:
            return made
        if isinstance(made, ast.Constant):
            return self._number(float(ast.unparse(made)), node)
        return _call("wp.float64", made)

    def _same(self, *nodes: ast.expr) -> list[ast.expr]:
        """Texts of values converted to one kind, for operations that require equal kinds."""
        kind = self.wider(*nodes)
        return [self._as_kind(node, kind) for node in nodes]

    def _visit(self, node: ast.expr) -> ast.expr:
        if isinstance(node, ast.Constant):
            return self._number(node.value, node)
        if isinstance(node, ast.Name) and self.is_local(node):
            return node
        if isinstance(node, ast.Name | ast.Attribute):
            return self._constant(node)
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Call):
            self.unknown(node)  # of several results warp makes a list
        if isinstance(node, ast.Subscript) and not isinstance(node.slice, ast.Slice | ast.Tuple):
            return ast.Subscript(self._visit(node.value), self._visit(node.slice), node.ctx)
        if isinstance(node, ast.UnaryOp):
            operand = node.operand
            if isinstance(node.op, ast.USub) and isinstance(operand, ast.Constant):
                return self._number(ast.literal_eval(node), node)
            return ast.UnaryOp(node.op, self._visit(operand))
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.BoolOp):
            return ast.BoolOp(node.op, [self._visit(value) for value in node.values])
        if isinstance(node, ast.Compare):
            terms = [node.left, *node.comparators]
            pairs: list[ast.expr] = []
            for a, op, b in zip(terms, node.ops, terms[1:], strict=False):
                left, right = self._same(a, b)
                pairs.append(ast.Compare(left, [op], [right]))
            return pairs[0] if len(pairs) == 1 else ast.BoolOp(ast.And(), pairs)
        if isinstance(node, ast.IfExp):
            return self._as_kind(node, self.kind(node))
        if isinstance(node, ast.Call):
            return self._call(node)
        self.unknown(node)

    def _number(self, value: Any, node: ast.AST) -> ast.expr:
        if isinstance(value, int):
            return ast.Constant(value)
        if not isinstance(value, float):
            self.unknown(node)
        if math.isfinite(value):
            return _call("wp.float64", ast.Constant(value))
        made = _call("wp.float64", _name("wp.nan" if math.isnan(value) else "wp.inf"))
        return ast.UnaryOp(ast.USub(), made) if value < 0.0 else made

    def _constant(self, node: ast.Name | ast.Attribute) -> ast.expr:
        value = self.look_up(node)
        if not isinstance(value, tuple):
            return self._number(value, node)
        name = f"{self.name}_{ast.unparse(node).strip('_')}"
        numbers = ", ".join(repr(float(x)) for x in value)
        self.vectors[name] = f"wp.types.vector({len(value)}, wp.float64)({numbers})"
        return _name(name)

    def _binary(self, node: ast.BinOp) -> ast.expr:
        kind = self.kind(node)
        left, right = (self._as_kind(side, kind) for side in (node.left, node.right))
        return ast.BinOp(left, node.op, right)

    def _call(self, node: ast.Call) -> ast.expr:
        if node.keywords:
            self.unknown(node)
        name = built_in(node)
        if name in ("min", "max"):
            return _call(name, *self._same(*node.args))
        if name == "float":
            return self._as_kind(node.args[0], DOUBLE)
        if name in ("abs", "int", "bool"):
            return _call(name, self._visit(node.args[0]))
        called = self.called(node)
        if called is room:
            return _name(f"wp.zeros(shape={self.size}, dtype=wp.float64)")
        if is_kernel(called):
            self.calls.append(called)
            kinds = signature(called).kinds.values()
            pairs = zip(node.args, kinds, strict=True)
            return _call(signature(called).name, *(self._as_kind(a, kind) for a, kind in pairs))
        own = getattr(called, "__name__", "")
        if getattr(math, own, None) is called:
            arguments = [self._as_kind(argument, DOUBLE) for argument in node.args]
            if own in _OWN:
                return _call(own, *arguments)
            if own == "ceil":
                return _call("int", _call("wp.ceil", *arguments))
            if own in _MATH:
                return _call(f"wp.{own}", *arguments)
        self.unknown(node)


def _name(dotted: str) -> ast.expr:
    return ast.parse(dotted, mode="eval").body


def _call(dotted: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(_name(dotted), list(arguments), [])
