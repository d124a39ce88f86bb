"""Derive a kernel with tangents from the source of a kernel.

Before ``x = f(y, z)`` the statement ``x_t = df/dy y_t + df/dz z_t`` is added. Its factors are
numbers and are the same for every direction (`frictionjoint.law.tangents.direction`). Arrays P and
X get arrays P_t and X_t of tangents. A call passes numbers with their tangents and returns both.
Tests and counts have no tangent and stay as they are, so the derivative is one-sided at a sample
where an event happens.

Supported are scalar arithmetic, `while`, `for ... in range`, `if`, calls of other kernels, `math`,
and array elements. Anything else is an error, never a guess. An equality test of a number with a
tangent is also an error, because it would hide a derivative.
"""

import ast
import inspect
from collections.abc import Callable
from typing import Any

from frictionjoint.law.tangents.activity import Activity
from frictionjoint.law.tangents.particulars import HARMLESS, RULES

# source of the factor of each tangent, by the source of the tangent
Terms = dict[str, str]
_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
# derivative of a function with value y at x
_DERIVATIVES: dict[str, Callable[[str, str], str]] = {
    "math.exp": lambda x, y: y,
    "math.expm1": lambda x, y: f"{y} + 1.0",
    "math.log1p": lambda x, y: f"1.0 / (1.0 + {x})",
    "math.sin": lambda x, y: f"math.cos({x})",
    "abs": lambda x, y: f"math.copysign(1.0, {x})",
}


def name_of(kernel: Any) -> str:
    """Name of a kernel with tangents: the name of its module, then its own name."""
    python = kernel.py_func
    return f"{python.__module__.rpartition('.')[2]}_{python.__name__.strip('_')}"


class Differentiated(Activity):
    """A kernel with tangents.

    Attributes:
        source: source of the function with tangents.
        calls: kernels that it calls, each as the arguments of this class.
    """

    def __init__(self, kernel: Any, moving: frozenset[str], wanted: bool) -> None:
        """Differentiate a kernel.

        Args:
            kernel: marked by `compiled`. moving: names of its number arguments that have a tangent.
            wanted: whether the caller uses the returned value.
        Raises:
            ModelError: a construct that cannot be differentiated.
        """
        super().__init__(kernel, moving, wanted)
        self.wanted = wanted
        self.calls: list[tuple[Any, frozenset[str], bool]] = []
        self.made = 0
        set_later = self.varied - moving
        still = [f"{name}_t = ZERO" for name in self.arguments if name in set_later]
        lines = [*still, *self._statements(self.body)]
        self.source = self._head(kernel, moving) + "\n".join(_indented(lines))

    def _head(self, kernel: Any, moving: frozenset[str]) -> str:
        arguments = []
        for name, kind in self.arguments.items():
            arguments.append(f"{name}: {kind}")
            if name in self.arrays:
                arguments.append(f"{name}_t: Vector")
            elif name in moving:
                arguments.append(f"{name}_t: Tangent")
        returned = "tuple[float, Tangent]" if self.wanted else "None"
        head = f"def {name_of(kernel)}({', '.join(arguments)}) -> {returned}:\n"
        return f"@{'in_line' if kernel.in_line else 'compiled'}\n{head}"

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
            head = f"for {ast.unparse(node.target)} in {ast.unparse(node.iter)}:"
            return [head, *_indented(self._statements(node.body))]
        if isinstance(node, ast.Break | ast.Continue):
            return [ast.unparse(node)]
        if isinstance(node, ast.Return):
            return self._return(node.value)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            return [self._call(node.value, False, [])]
        self.unknown(node)

    def _return(self, value: ast.expr | None) -> list[str]:
        if value is None:
            return ["return"]
        if isinstance(value, ast.IfExp) and self.moves(value):
            body, orelse = self._return(value.body), self._return(value.orelse)
            return [f"if {self._test(value.test)}:", *_indented(body), *orelse]
        before: list[str] = []
        new, terms = self._differentiate(value, before)
        return [*before, f"return {new}, {_combined(terms)}"]

    def _assign(self, target: ast.expr, value: ast.expr) -> list[str]:
        if isinstance(value, ast.IfExp) and self.moves(value):
            body, orelse = self._assign(target, value.body), self._assign(target, value.orelse)
            return [f"if {self._test(value.test)}:", *_indented(body), "else:", *_indented(orelse)]
        before: list[str] = []
        place = ast.unparse(target)
        if isinstance(target, ast.Subscript):
            if self.is_count(target):
                return [f"{place} = {ast.unparse(value)}"]
            new, terms = self._differentiate(value, before)
            array, index = ast.unparse(target.value), ast.unparse(target.slice)
            put = f"put({array}_t, {index}, {_combined(terms)})"
            return [*before, put, f"{place} = {new}"]
        if place not in self.varied:
            return [f"{place} = {ast.unparse(value)}"]
        if isinstance(value, ast.Call) and self.kernel_of(value) and self.moves(value):
            call = self._call(value, True, before)
            return [*before, f"{place}, {place}_t = {call}"]
        new, terms = self._differentiate(value, before)
        return [*before, f"{place}_t = {_combined(terms)}", f"{place} = {new}"]

    def _test(self, node: ast.expr) -> str:
        for part in ast.walk(node):
            if isinstance(part, ast.Compare) and any(
                isinstance(op, ast.Eq | ast.NotEq) for op in part.ops
            ):
                hides = any(self.moves(x) for x in (part.left, *part.comparators))
                if hides and ast.unparse(part) not in HARMLESS:
                    self.unknown(node)
        return ast.unparse(node)

    # expressions

    def _differentiate(self, node: ast.expr, before: list[str]) -> tuple[str, Terms]:
        """Source of the value and tangent of an expression; statements that must precede it are
        added to `before`.
        """
        source = ast.unparse(node)
        if not self.moves(node):
            return source, {}
        exact = self.exactly(node)
        if exact is not node:
            return source, self._differentiate(exact, before)[1]
        if isinstance(node, ast.Name):
            return source, {f"{source}_t": "1.0"}
        if isinstance(node, ast.Subscript):
            return source, {f"at({ast.unparse(node.value)}_t, {ast.unparse(node.slice)})": "1.0"}
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            value, terms = self._differentiate(node.operand, before)
            return f"-({value})", _opposite(terms)
        if isinstance(node, ast.BinOp):
            return self._binary(node, before)
        if isinstance(node, ast.Call):
            return self._function(node, before)
        self.unknown(node)

    def _binary(self, node: ast.BinOp, before: list[str]) -> tuple[str, Terms]:
        if type(node.op) not in _SIGNS:
            self.unknown(node)
        a, of_a = self._differentiate(node.left, before)
        b, of_b = self._differentiate(node.right, before)
        value = f"({a}) {_SIGNS[type(node.op)]} ({b})"
        if isinstance(node.op, ast.Add):
            return value, _added(of_a, of_b)
        if isinstance(node.op, ast.Sub):
            return value, _added(of_a, _opposite(of_b))
        by_a, by_b = b, a
        if isinstance(node.op, ast.Div):
            by_a, by_b = f"1.0 / ({b})", f"-({value}) * (1.0 / ({b}))"
        elif isinstance(node.op, ast.Pow):
            value = self._held(value, before)
            by_a, by_b = f"({b}) * {value} / ({a})", f"{value} * math.log({a})"
        return value, _added(_times(of_a, by_a), _times(of_b, by_b))

    def _function(self, node: ast.Call, before: list[str]) -> tuple[str, Terms]:
        if self.kernel_of(node) is not None:
            call, name = self._call(node, True, before), self._new()
            before.append(f"{name}, {name}_t = {call}")
            return name, {f"{name}_t": "1.0"}
        called = ast.unparse(node.func)
        parts = [self._differentiate(argument, before) for argument in node.args]
        if called in ("min", "max") and len(parts) == 2:
            return self._extreme(node, parts, before)
        if called not in _DERIVATIVES or len(parts) != 1:
            self.unknown(node)
        ((x, terms),) = parts
        y = self._held(f"{called}({x})", before)
        return y, _times(terms, _DERIVATIVES[called](x, y))

    def _extreme(
        self, node: ast.Call, parts: list[tuple[str, Terms]], before: list[str]
    ) -> tuple[str, Terms]:
        """The smaller or the larger of two values, chosen by an `if` statement in front."""
        order = ("<=", ">=") if ast.unparse(node.func) == "min" else (">=", "<=")
        (a, _), (b, _) = parts
        constant = isinstance(node.args[0], ast.Constant)
        test = f"{b} {order[1]} {a}" if constant else f"{a} {order[0]} {b}"
        name = self._new()
        for head, (value, terms) in zip((f"if {test}:", "else:"), parts, strict=True):
            before += [head, f"    {name}, {name}_t = {value}, {_combined(terms)}"]
        return name, {f"{name}_t": "1.0"}

    def _call(self, node: ast.Call, wanted: bool, before: list[str]) -> str:
        """Call of a kernel with tangents."""
        kernel = self.kernel_of(node)
        if kernel is None:
            self.unknown(node)
        names = list(inspect.signature(kernel.py_func).parameters)
        rule = RULES.get(kernel)
        taken = inspect.signature(rule.py_func).parameters if rule else None
        arguments: list[str] = []
        moving: set[str] = set()
        for name, argument in zip(names, node.args, strict=True):
            if ast.unparse(argument) in self.arrays:
                arguments += [ast.unparse(argument), f"{ast.unparse(argument)}_t"]
                continue
            value, terms = self._differentiate(argument, before)
            arguments.append(value)
            if f"{name}_t" in taken if taken is not None else self.moves(argument):
                moving.add(name)
                arguments.append(_combined(terms))
            elif terms:
                self.unknown(node)
        if rule:
            return f"rules.{rule.py_func.__name__}({', '.join(arguments)})"
        self.calls.append((kernel, frozenset(moving), wanted))
        return f"{name_of(kernel)}({', '.join(arguments)})"

    def _held(self, value: str, before: list[str]) -> str:
        name = self._new()
        before.append(f"{name} = {value}")
        return name

    def _new(self) -> str:
        self.made += 1
        name = f"y{self.made}"
        assert name not in self.locals
        return name


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def _times(terms: Terms, factor: str) -> Terms:
    """A sum with every factor multiplied by another factor."""
    return {tangent: f"({factor}) * ({x})" for tangent, x in terms.items()}


def _opposite(terms: Terms) -> Terms:
    """A sum with the sign of every factor reversed."""
    return {tangent: f"-({x})" for tangent, x in terms.items()}


def _added(a: Terms, b: Terms) -> Terms:
    """The total of two sums; the factors of a tangent that occurs in both are added."""
    both = {tangent: f"({a[tangent]}) + ({x})" if tangent in a else x for tangent, x in b.items()}
    return a | both


def _combined(terms: Terms) -> str:
    """Source of a sum, as calls of functions in `frictionjoint.law.tangents.direction`."""
    if not terms:
        return "ZERO"
    factors = list(terms.items())
    if len(factors) == 1:
        ((tangent, x),) = factors
        return f"scaled({x}, {tangent})"
    if len(factors) == 2:
        return f"sum2({', '.join(f'{x}, {tangent}' for tangent, x in factors)})"
    first = 4 if len(factors) > 4 else 2
    parts = (_combined(dict(some)) for some in (factors[:first], factors[first:]))
    return f"sum2(1.0, {', 1.0, '.join(parts)})"
