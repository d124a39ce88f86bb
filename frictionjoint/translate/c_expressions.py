"""C text of the expressions in a kernel."""

import ast
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from frictionjoint.compiled import External, Table, elements, is_tuple, pointer
from frictionjoint.translate.kernel import Kernel, built_in, is_kernel, is_shape, place, signature
from frictionjoint.translate.kinds import DOUBLE, REALS, WHOLE, Dialect

# precedence of operators
_CHOICE, _OR, _AND, _COMPARISON, _SUM, _PRODUCT, _UNARY, _ATOM = range(8)
_BINARY = {
    ast.Add: ("+", _SUM),
    ast.Sub: ("-", _SUM),
    ast.Mult: ("*", _PRODUCT),
    ast.Div: ("/", _PRODUCT),
}
_WHOLE_BINARY = {ast.BitAnd: "&", ast.BitOr: "|", ast.RShift: ">>", ast.LShift: "<<"}
_FLOOR = {ast.FloorDiv: "floor_div", ast.Mod: "floor_mod"}
_COMPARE = {ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_HELPED = {"exp", "log", "expm1", "log1p", "sin", "cos", "tan", "atan", "tanh", "sqrt", "ceil"}
_MORE = {"copysign", "hypot", "atan2", "floor", "asin", "acos", "fabs", "pow", "fmod"}
_LIBRARY = {"exp", "log"}
_ROUNDED = {"ceil", "floor"}
_KEYWORDS = """_ auto break case char const continue default do double else enum extern float for
goto if inline int long register restrict return short signed sizeof static struct switch typedef
union unsigned void volatile while"""
# keywords of C, which cannot be names of values
_RESERVED = frozenset(_KEYWORDS.split())


@dataclass
class Gathered:
    """Definitions that the functions translated so far require.

    Attributes:
        dialect: dialect of C that is written.
        call: translates a kernel unless it is already translated.
        constants: values of module constants, by their C name.
        helpers: names in `c_math`. tuples: kinds of tuples. structures: NamedTuples, by kind.
        tables, externals: those of `frictionjoint.compiled`, by name.
    """

    dialect: Dialect
    call: "Callable[[Any], Expressions]"
    constants: dict[str, int | float | tuple[float, ...]] = field(default_factory=dict)
    helpers: set[str] = field(default_factory=set)
    tuples: set[str] = field(default_factory=set)
    structures: dict[str, Any] = field(default_factory=dict)
    tables: dict[str, Table] = field(default_factory=dict)
    externals: dict[str, Any] = field(default_factory=dict)


class Expressions(Kernel):
    """Expressions of one kernel.

    Attributes:
        written: arrays that the kernel writes to; of a complete kernel, parameters alone.
        axes: axes of array parameters whose lengths the kernel requires.
        roots: the array that each local pointer points into.
        same: the expression that each other local array name stands for.
    """

    def __init__(self, function: Any, gathered: Gathered) -> None:
        super().__init__(function)
        self.gathered, self.dialect = gathered, gathered.dialect
        gathered.structures.update(self.structures)
        self.written: set[str] = set()
        self.axes: dict[str, set[int]] = {}
        self.roots: dict[str, str] = {}
        self.same: dict[str, ast.expr] = {}

    def noted(self, kind: str) -> str:
        """Return a kind, and note that a tuple of this kind and those within it must be defined."""
        if is_tuple(kind):
            self.gathered.tuples.update([kind, *map(self.noted, filter(is_tuple, elements(kind)))])
        return kind

    # text

    def text(self, node: ast.expr, least: int = 0) -> str:
        """C text of an expression, in parentheses if its precedence is below `least`."""
        text, binds = self._expression(node)
        return f"({text})" if binds < least else text

    def target(self, node: ast.expr) -> str:
        """C text of the target of an assignment."""
        if isinstance(node, ast.Subscript) and self.is_local(node.value):
            self.write(node.value)
        elif not isinstance(node, ast.Name):
            self.unknown(node)
        return self.text(node)

    def write(self, node: ast.expr) -> None:
        """Note that the kernel writes to the array that a pointer points into."""
        if isinstance(node, ast.Call) and self.look_up(node.func) is pointer:
            self.write(node.args[0])
        if isinstance(node, ast.Name):
            self.written.add(node.id)
            if node.id in self.roots:
                self.write(ast.Name(self.roots[node.id]))

    def length(self, node: ast.expr, axis: int) -> str:
        """C text of an array's length along an axis."""
        if self.field(node):
            return f"{self.text(node)}_n[{axis}]"
        if not isinstance(node, ast.Name):
            self.unknown(node)
        if node.id in self.same:
            return self.length(self.same[node.id], axis)
        if node.id in self.parameters and node.id not in self.roots:
            self.axes.setdefault(node.id, set()).add(axis)
            return f"{safe(node.id)}_n{axis}"
        self.unknown(node)

    def _expression(self, node: ast.expr) -> tuple[str, int]:
        if isinstance(node, ast.Constant):
            return self.number(node.value, node), _ATOM
        if isinstance(node, ast.Name) and node.id in self.kinds:
            return safe(node.id), _ATOM
        if self.field(node) and isinstance(node, ast.Attribute):
            return f"{self.text(node.value)}->{node.attr}", _ATOM
        if isinstance(node, ast.Name | ast.Attribute):
            return self._constant(node), _ATOM
        if isinstance(node, ast.Subscript):
            return self._subscript(node), _ATOM
        if isinstance(node, ast.UnaryOp):
            sign = "!" if isinstance(node.op, ast.Not) else "-"
            text = self.text(node.operand, _UNARY)
            return sign + (f"({text})" if text.startswith("-") else text), _UNARY
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.BoolOp):
            sign, binds = (" || ", _OR) if isinstance(node.op, ast.Or) else (" && ", _AND)
            # && within || gets parentheses, because compilers warn if they are absent
            return sign.join(self.text(v, _COMPARISON) for v in node.values), binds
        if isinstance(node, ast.Compare):
            return self._compare(node)
        if isinstance(node, ast.IfExp):
            test, a, b = (self.text(n, _OR) for n in (node.test, node.body, node.orelse))
            return f"{test} ? {a} : {b}", _CHOICE
        if isinstance(node, ast.Call):
            return self._call(node), _ATOM
        self.unknown(node)

    def _literal(self, kind: str, texts: list[str]) -> str:
        return f"({self.noted(kind)}){{ {', '.join(texts)} }}"

    def as_kind(self, node: ast.expr, kind: str) -> str:
        """C text of a value, converted to the given kind; a tuple must have exactly this kind."""
        if not is_tuple(kind):
            return self.text(node)
        if isinstance(node, ast.Tuple):
            wanted = elements(kind)
            texts = [self.as_kind(x, k) for x, k in zip(node.elts, wanted, strict=True)]
            return self._literal(kind, texts)
        if self.kind(node) != kind:
            self.unknown(node)
        return self.text(node)

    def _subscript(self, node: ast.Subscript) -> str:
        if is_shape(node.value) and isinstance(node.value, ast.Attribute):
            return self.length(node.value.value, place(node.slice))
        if not self.is_local(node.value):
            return self._element_of_constant(node)
        if is_tuple(self.kind(node.value)):
            return f"{self.text(node.value, _ATOM)}._{place(node.slice)}"
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for part in parts:
            if isinstance(part, ast.Slice | ast.UnaryOp):
                self.unknown(node)
        index = self.text(parts[0])
        for axis, part in enumerate(parts[1:], start=1):
            outer = index if index.isidentifier() or index.isdecimal() else f"({index})"
            index = f"{outer} * {self.length(node.value, axis)} + {self.text(part, _SUM + 1)}"
        return f"{self.text(node.value, _ATOM)}[{index}]"

    def _element_of_constant(self, node: ast.Subscript) -> str:
        value = self.look_up(node.value)
        if isinstance(value, Table):
            self.gathered.tables[value.name] = value
            return f"fj_{value.name}[{self.text(node.slice)}]"
        if isinstance(value, np.ndarray) and value.ndim == 1:
            value = tuple(float(x) for x in value)
        if not isinstance(value, tuple):
            self.unknown(node)
        return f"{self._named(node.value, value)}[{self.text(node.slice)}]"

    def _binary(self, node: ast.BinOp) -> tuple[str, int]:
        if isinstance(node.op, ast.Pow):
            return f"pow({self.text(node.left)}, {self.text(node.right)})", _ATOM
        whole = self.wider(node.left, node.right) == WHOLE
        if type(node.op) in _FLOOR and whole:
            texts = [self.text(side) for side in (node.left, node.right)]
            return self._helper(_FLOOR[type(node.op)], texts), _ATOM
        if type(node.op) in _WHOLE_BINARY and whole:
            sides = (self.text(side, _ATOM) for side in (node.left, node.right))
            return f"({f' {_WHOLE_BINARY[type(node.op)]} '.join(sides)})", _ATOM
        if type(node.op) not in _BINARY:
            self.unknown(node)
        sign, binds = _BINARY[type(node.op)]
        left = self.text(node.left, binds)
        if isinstance(node.op, ast.Div) and whole:
            left = f"(double){self.text(node.left, _ATOM)}"
        return f"{left} {sign} {self.text(node.right, binds + 1)}", binds

    def _compare(self, node: ast.Compare) -> tuple[str, int]:
        texts = [self.text(term, _SUM) for term in (node.left, *node.comparators)]
        signs = [_COMPARE.get(type(op), "") for op in node.ops]
        if "" in signs:
            self.unknown(node)
        pairs = [f"{a} {s} {b}" for a, s, b in zip(texts, signs, texts[1:], strict=False)]
        return " && ".join(pairs), _COMPARISON if len(pairs) == 1 else _AND

    def _call(self, node: ast.Call) -> str:
        if node.keywords:
            self.unknown(node)
        name = built_in(node)
        if name == "len":
            of = node.args[0]
            return self.length(of, 0) if self.is_local(of) else str(len(self.look_up(of)))
        if name in ("min", "max") and len(node.args) != 2:
            self.unknown(node)
        if name in ("abs", "min", "max"):
            name += "" if self.wider(*node.args) == DOUBLE else "_int"
            return self._helper(name, [*map(self.text, node.args)])
        if name:
            return self._converted(name, node.args[0])
        called = self.look_up(node.func)
        if called is pointer:
            return f"({self.text(node.args[0], _ATOM)} + {self.text(node.args[1], _SUM + 1)})"
        if hasattr(called, "c_text"):
            return str(called.c_text.format(*(self.text(a, _ATOM) for a in node.args)))
        if isinstance(called, External):
            return self._external(called, node)
        if is_kernel(called):
            return self._kernel(called, node)
        return self._mathematics(called, node)

    def _converted(self, name: str, node: ast.expr) -> str:
        inner, kind = self.text(node, _ATOM), self.kind(node)
        if name == "bool" and kind == DOUBLE:
            return f"({inner} != 0.0)"
        wanted = DOUBLE if name == "float" else WHOLE
        return inner if kind == wanted else f"({self.dialect.type_of(wanted)}){inner}"

    def _kernel(self, called: Any, node: ast.Call) -> str:
        known = self.gathered.call(called)
        kinds = signature(called).kinds
        texts: list[str] = []
        for name, argument in zip(known.parameters, node.args, strict=True):
            texts.append(self.as_kind(argument, kinds[name]))
            if name in known.written:
                self.write(argument)
            texts += [self.length(argument, axis) for axis in sorted(known.axes.get(name, ()))]
        return f"fj_{known.name}({', '.join(texts)})"

    def _external(self, called: Any, node: ast.Call) -> str:
        self.gathered.externals[called.name] = called
        kinds = list(signature(called).kinds.values())
        for argument, kind in zip(node.args, kinds, strict=True):
            if kind == REALS:
                self.write(argument)
        return f"fj_{called.name}({', '.join(map(self.text, node.args))})"

    def _mathematics(self, called: Any, node: ast.Call) -> str:
        texts = [self.text(a) for a in node.args]
        if called is math.isnan:
            return f"({texts[0]} != {texts[0]})"
        name = getattr(called, "__name__", "")
        allowed = _HELPED if self.dialect.header else _HELPED | _MORE
        if getattr(math, name, None) is not called or name not in allowed:
            self.unknown(node)
        if self.dialect.header and name not in _LIBRARY:
            return self._helper(name, texts)
        rounded = f"({self.dialect.whole})" if name in _ROUNDED else ""
        return f"{rounded}{name}({', '.join(texts)})"

    def _helper(self, name: str, texts: list[str]) -> str:
        self.gathered.helpers.add(name)
        return f"fj_{name}({', '.join(texts)})"

    def _constant(self, node: ast.Name | ast.Attribute) -> str:
        value = self.look_up(node)
        if isinstance(value, np.floating | np.integer):
            value = value.item()
        if isinstance(value, tuple):
            texts = [self.number(x, node) for x in value]
            return self._literal(self._kind_of_constant(node), texts)
        module = self.python.__module__
        if isinstance(node, ast.Attribute):
            module = self.look_up(node.value).__name__
        if module in ("math", "numpy") or (isinstance(value, float) and not math.isfinite(value)):
            return self.number(value, node)
        if not isinstance(value, int | float):
            self.unknown(node)
        return self._named(node, value)

    def _named(self, node: ast.expr, value: Any) -> str:
        module, own = self.python.__module__, ast.unparse(node).split(".")[-1]
        if isinstance(node, ast.Attribute):
            module = self.look_up(node.value).__name__
        name = first = f"fj_{module.split('.')[-1]}_{own.strip('_')}"
        also = 1
        while self.gathered.constants.setdefault(name, value) != value:
            also += 1
            name = f"{first}_{also}"
        return name

    def number(self, value: Any, node: ast.AST) -> str:
        """C text of a number; a double has all its digits."""
        if isinstance(value, bool):
            return str(int(value))
        if isinstance(value, float) and not math.isfinite(value):
            return "NAN" if value != value else "INFINITY" if value > 0.0 else "(-INFINITY)"
        if isinstance(value, int | float):
            return repr(value)
        self.unknown(node)


def safe(name: str) -> str:
    """A name that is not reserved in C."""
    return f"{name}_" if name in _RESERVED else name
