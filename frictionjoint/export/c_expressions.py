"""C text and C type of the expressions a kernel consists of."""

import ast
import inspect
import math
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NoReturn

from frictionjoint.compiled import room
from frictionjoint.errors import ModelError

POINTER = "double *"
_KINDS = {"float": "double", "int": "int", "bool": "int", "None": "void", "Vector": POINTER}
BINARY = {ast.Add: ("+", 4), ast.Sub: ("-", 4), ast.Mult: ("*", 5), ast.Div: ("/", 5)}
_COMPARE = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
# how strongly operators bind; the numbers in BINARY belong to the same scale
_CHOICE, _OR, _AND, _COMPARISON, _SUM, _UNARY, _ATOM = 0, 1, 2, 3, 4, 6, 7
_MATH = {"exp", "log", "expm1", "log1p", "sin", "cos", "tan", "atan", "tanh", "sqrt", "ceil"}
_LIBRARY = {"exp", "log"}
_KEYWORDS = """_ auto break case char const continue default do double else enum extern float for
goto if inline int long register restrict return short signed sizeof static struct switch typedef
union unsigned void volatile while"""
_RESERVED = frozenset(_KEYWORDS.split())


@dataclass
class Gathered:
    """What functions translated so far need besides themselves.

    Attributes:
        call: translates a numba function unless it is there; its C name, and for each parameter
            whether it writes to what that points to.
        constants: values of module constants, by their C name.
        helpers: names in `c_math`.
    """

    call: Callable[[Any], tuple[str, list[bool]]]
    constants: dict[str, int | float | tuple[float, ...]] = field(default_factory=dict)
    helpers: set[str] = field(default_factory=set)


class Expressions:
    """Expressions of one function.

    Attributes:
        kinds: C type of each parameter and local. written: arrays that are written to.
    """

    def __init__(self, function: Any, gathered: Gathered) -> None:
        self.plain: Callable[..., Any] = function.py_func
        self.gathered = gathered
        tree = ast.parse(textwrap.dedent(inspect.getsource(self.plain))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        self.tree = tree
        self.kinds = {a.arg: self._annotation(a.annotation, a) for a in tree.args.args}
        self.written: set[str] = set()
        nodes = (n for n in ast.walk(tree) if isinstance(n, ast.Name))
        self.locals = {n.id for n in nodes if isinstance(n.ctx, ast.Store)}

    def unknown(self, node: ast.AST) -> NoReturn:
        """Raise ModelError for what cannot be translated."""
        raise ModelError(
            f"{self.plain.__module__}.{self.plain.__name__} cannot be made C: rewrite "
            f"{ast.unparse(node)!r} in plainer Python"
        )

    def look_up(self, node: ast.expr) -> Any:
        """What a name or an attribute of a module stands for."""
        if isinstance(node, ast.Attribute):
            return getattr(self.look_up(node.value), node.attr)
        if isinstance(node, ast.Name) and node.id in self.plain.__globals__:
            return self.plain.__globals__[node.id]
        self.unknown(node)

    @property
    def result(self) -> str:
        """C type of what the function returns."""
        return self._annotation(self.tree.returns, self.tree)

    def _annotation(self, node: ast.expr | None, where: ast.AST) -> str:
        name = ast.unparse(node) if node is not None else ""
        if name not in _KINDS:
            self.unknown(where)
        return _KINDS[name]

    # types

    def kind(self, node: ast.expr) -> str | None:
        """C type of an expression; None while it hangs on a local not yet known."""
        if isinstance(node, ast.Name) and (node.id in self.kinds or node.id in self.locals):
            return self.kinds.get(node.id)
        if isinstance(node, ast.Name | ast.Attribute):
            return "double" if isinstance(self.look_up(node), float) else "int"
        if isinstance(node, ast.Constant):
            return "double" if isinstance(node.value, float) else "int"
        if isinstance(node, ast.Subscript):
            return "double"
        if isinstance(node, ast.BoolOp | ast.Compare):
            return "int"
        if isinstance(node, ast.UnaryOp):
            return self.kind(node.operand)
        if isinstance(node, ast.IfExp):
            return self._wider(node.body, node.orelse)
        if isinstance(node, ast.BinOp):
            if isinstance(node.op, ast.Div | ast.Pow):
                return "double"
            return self._wider(node.left, node.right)
        if isinstance(node, ast.Call):
            return self._call_kind(node)
        self.unknown(node)

    def _wider(self, *nodes: ast.expr) -> str | None:
        kinds = [self.kind(node) for node in nodes]
        return "double" if "double" in kinds else None if None in kinds else "int"

    def _call_kind(self, node: ast.Call) -> str | None:
        name = _built_in(node)
        if name in ("abs", "min", "max"):
            return self._wider(*node.args)
        if name:
            return _KINDS[name]
        called = self.look_up(node.func)
        if called is room:
            return POINTER
        if hasattr(called, "py_func"):
            return Expressions(called, self.gathered).result
        return "int" if called in (math.ceil, math.isnan) else "double"

    # text

    def text(self, node: ast.expr, least: int = 0) -> str:
        """C text, in parentheses where it binds less than `least`."""
        text, binds = self._expression(node)
        return f"({text})" if binds < least else text

    def target(self, node: ast.expr) -> str:
        """C text of what is assigned to."""
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
            self.written.add(node.value.id)
        elif not isinstance(node, ast.Name):
            self.unknown(node)
        return self.text(node)

    def _expression(self, node: ast.expr) -> tuple[str, int]:
        if isinstance(node, ast.Constant):
            return self.number(node.value, node), _ATOM
        if isinstance(node, ast.Name) and node.id in self.kinds:
            return safe(node.id), _ATOM
        if isinstance(node, ast.Name | ast.Attribute):
            return self._constant(node), _ATOM
        if isinstance(node, ast.Subscript):
            return f"{self.text(node.value, _ATOM)}[{self.text(node.slice)}]", _ATOM
        if isinstance(node, ast.UnaryOp):
            sign = "!" if isinstance(node.op, ast.Not) else "-"
            text = self.text(node.operand, _UNARY)
            return sign + (f"({text})" if text.startswith("-") else text), _UNARY
        if isinstance(node, ast.BinOp):
            return self._binary(node)
        if isinstance(node, ast.BoolOp):
            sign, binds = (" || ", _OR) if isinstance(node.op, ast.Or) else (" && ", _AND)
            # && within || in parentheses, which compilers warn of the absence of
            return sign.join(self.text(v, _COMPARISON) for v in node.values), binds
        if isinstance(node, ast.Compare):
            return self._compare(node)
        if isinstance(node, ast.IfExp):
            test, a, b = (self.text(n, _OR) for n in (node.test, node.body, node.orelse))
            return f"{test} ? {a} : {b}", _CHOICE
        if isinstance(node, ast.Call):
            return self._call(node), _ATOM
        self.unknown(node)

    def _binary(self, node: ast.BinOp) -> tuple[str, int]:
        if isinstance(node.op, ast.Pow):
            if isinstance(node.right, ast.Constant) and node.right.value == 2:
                self.gathered.helpers.add("square")
                return f"fj_square({self.text(node.left)})", _ATOM
            return f"pow({self.text(node.left)}, {self.text(node.right)})", _ATOM
        if type(node.op) not in BINARY:
            self.unknown(node)
        sign, binds = BINARY[type(node.op)]
        left = self.text(node.left, binds)
        if isinstance(node.op, ast.Div) and self._wider(node.left, node.right) == "int":
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
        texts = [self.text(a) for a in node.args]
        name = _built_in(node)
        if name in ("abs", "min", "max"):
            name += "" if self._wider(*node.args) == "double" else "_int"
            return self._helper(name, texts)
        if name:
            inner = self.text(node.args[0], _ATOM)
            same = name == "bool" or self.kind(node.args[0]) == _KINDS[name]
            return inner if same else f"({_KINDS[name]}){inner}"
        called = self.look_up(node.func)
        if hasattr(called, "py_func"):
            name, writes = self.gathered.call(called)
            for argument, write in zip(node.args, writes, strict=True):
                if write and isinstance(argument, ast.Name):
                    self.written.add(argument.id)
            return f"{name}({', '.join(texts)})"
        if called is math.isnan:
            return f"({texts[0]} != {texts[0]})"
        name = getattr(called, "__name__", "")
        if getattr(math, name, None) is not called or name not in _MATH:
            self.unknown(node)
        return f"{name}({texts[0]})" if name in _LIBRARY else self._helper(name, texts)

    def _helper(self, name: str, texts: list[str]) -> str:
        self.gathered.helpers.add(name)
        return f"fj_{name}({', '.join(texts)})"

    def _constant(self, node: ast.Name | ast.Attribute) -> str:
        value = self.look_up(node)
        module, own = self.plain.__module__, ast.unparse(node).split(".")[-1]
        if isinstance(node, ast.Attribute):
            module = self.look_up(node.value).__name__
        if module == "math" or (isinstance(value, float) and not math.isfinite(value)):
            return self.number(value, node)
        if not isinstance(value, int | float | tuple):
            self.unknown(node)
        name = f"fj_{module.split('.')[-1]}_{own.strip('_')}"
        if self.gathered.constants.setdefault(name, value) != value:
            self.unknown(node)
        return name

    def number(self, value: Any, node: ast.AST) -> str:
        """A number as C has it; doubles with all their digits."""
        if isinstance(value, bool):
            return str(int(value))
        if isinstance(value, float) and not math.isfinite(value):
            return "NAN" if value != value else "INFINITY" if value > 0.0 else "(-INFINITY)"
        if isinstance(value, int | float):
            return repr(value)
        self.unknown(node)


def safe(name: str) -> str:
    """A name that C does not take for itself."""
    return f"{name}_" if name in _RESERVED else name


def _built_in(node: ast.Call) -> str:
    known = ("abs", "min", "max", "int", "float", "bool")
    return node.func.id if isinstance(node.func, ast.Name) and node.func.id in known else ""
