"""The kernels as warp functions, from the Python they are written in.

`frictionjoint.law` and `frictionjoint.effects` are written once, as scalar Python functions. Warp
compiles Python too, with a stricter grammar. `translate` rewrites a kernel and all it calls into
that grammar, statement by statement, and hands the text to warp; so an edit of
the law, or a new effect, is on the GPU without a second copy that could differ from the first.
Numbers are doubles throughout, as in the source.

What the rewriting knows about: scalar arithmetic, `while`, `for ... in range`, `if`, calls of other
kernels, `math`, arrays by subscript, `room` of a fixed size, and tuples
of numbers. Anything else is an error at translation, never a guess.
"""

import ast
import inspect
import linecache
import math
import textwrap
from typing import Any

from frictionjoint.compiled import room
from frictionjoint.errors import ModelError

_MATH = {"exp", "log", "sin", "cos", "tan", "atan", "tanh", "isnan", "sqrt"}
# Warp has neither. Kahan's forms lose no digits where the plain ones do.
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
# nodes of the syntax tree of a kernel that goes into its callers
_SMALL = 150
_AS_IT_IS = (
    ast.BoolOp,
    ast.IfExp,
    ast.Subscript,
    ast.Tuple,
    ast.Return,
    ast.Expr,
    ast.operator,
    ast.boolop,
    ast.unaryop,
    ast.expr_context,
)
_BUILTIN = {"abs", "min", "max", "range", "int", "bool"}


def translate(functions: list[Any], room: int, name: str) -> dict[str, Any]:
    """Warp functions of kernels, by name, in a namespace that also holds warp itself.

    Args:
        functions: marked by `compiled`; what they call follows by itself.
        room: numbers that an array made inside a function can hold.
        name: of the module warp compiles them into, and caches them under.
    Returns:
        The namespace: ``namespace[module_function]`` for ``package.module.function``.
    Raises:
        ModelError: a construct that the rewriting does not know.
    """
    text = source(functions, room)
    file = f"<{name}: made from the kernels>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    import warp as wp

    namespace: dict[str, Any] = {"wp": wp, "Any": Any, "__name__": name}
    exec(compile(text, file, "exec"), namespace)
    return namespace


def source(functions: list[Any], room: int) -> str:
    """The text that `translate` compiles, to be read."""
    done: dict[str, str] = {}
    vectors: dict[str, str] = {}

    def add(function: Any) -> None:
        key = _key(function)
        if key in done:
            return
        done[key] = ""
        rewriting = _Rewriting(function, room, vectors)
        text = rewriting.text()
        for callee in rewriting.calls:
            add(callee)
        # callees first: warp looks names up when it compiles, a reader from top to bottom
        del done[key]
        done[key] = text

    for function in functions:
        add(function)
    constants = "\n".join(f"{name} = {value}" for name, value in vectors.items())
    return "\n\n".join([_PRELUDE, constants, *done.values()]) + "\n"


def _key(function: Any) -> str:
    plain = function.py_func
    return "_".join([*plain.__module__.split(".")[-2:], plain.__name__.strip("_")])


class _Rewriting(ast.NodeTransformer):
    """One function. `calls` collects the kernels it calls."""

    def __init__(self, function: Any, room: int, vectors: dict[str, str]) -> None:
        self.function = function.py_func
        self.in_line = function.in_line
        self.key = _key(function)
        self.room = room
        self.vectors = vectors
        self.calls: list[Any] = []
        tree = ast.parse(textwrap.dedent(inspect.getsource(self.function))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        self.tree = tree
        self.locals = {a.arg for a in tree.args.args}
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                self.locals.add(node.id)

    def text(self) -> str:
        tree = self.tree
        body = tree.body[1:] if ast.get_docstring(tree) else tree.body
        statements: list[ast.stmt] = []
        for statement in body:
            statements += self._statement(statement)
        arguments = ", ".join(f"{a.arg}: Any" for a in tree.args.args)
        code = "\n".join(ast.unparse(ast.fix_missing_locations(s)) for s in statements)
        # out of line but for the smallest: CUDA's compiler would inline all of it everywhere, and
        # take minutes
        small = self.in_line and len([*ast.walk(tree)]) <= _SMALL
        decorator = "@wp.func" if small else "@wp.func(inline=False)"
        return f"{decorator}\ndef {self.key}({arguments}):\n{textwrap.indent(code, '    ')}"

    def _unknown(self, node: ast.AST) -> ModelError:
        return ModelError(
            f"{self.function.__module__}.{self.function.__name__} cannot be made a warp function: "
            f"rewrite {ast.unparse(node)!r} in plainer Python"
        )

    # statements

    def _statements(self, body: list[ast.stmt]) -> list[ast.stmt]:
        return [made for statement in body for made in self._statement(statement)]

    def _statement(self, node: ast.stmt) -> list[ast.stmt]:
        if isinstance(node, ast.Assign):
            return self._assign(node)
        if isinstance(node, ast.AugAssign):
            left = ast.parse(ast.unparse(node.target), mode="eval").body
            value = ast.BinOp(left, node.op, node.value)
            return self._assign(ast.Assign([node.target], value))
        if isinstance(node, ast.If):
            body, orelse = self._statements(node.body), self._statements(node.orelse)
            return [ast.If(self.visit(node.test), body, orelse)]
        if isinstance(node, ast.While | ast.For):
            self._check_loop(node)
        if isinstance(node, ast.While) and not node.orelse:
            return [ast.While(self.visit(node.test), self._statements(node.body), [])]
        if isinstance(node, ast.For) and not node.orelse and isinstance(node.target, ast.Name):
            return [ast.For(node.target, self.visit(node.iter), self._statements(node.body), [])]
        if isinstance(node, ast.Return | ast.Expr):
            return [self.visit(node)]
        if isinstance(node, ast.Break | ast.Continue):
            return [node]
        raise self._unknown(node)

    def _check_loop(self, loop: ast.While | ast.For) -> None:
        """What a loop hands on must be there before it: warp loses it on `break` otherwise."""
        end = loop.end_lineno or loop.lineno
        names = [n for n in ast.walk(self.tree) if isinstance(n, ast.Name)]
        stored = [n for n in names if isinstance(n.ctx, ast.Store)]
        before = {n.id for n in stored if n.lineno < loop.lineno}
        before |= {a.arg for a in self.tree.args.args}
        inside = {n.id for n in stored if loop.lineno <= n.lineno <= end} - before
        for name in names:
            if isinstance(name.ctx, ast.Load) and name.lineno > end and name.id in inside:
                again = any(n.id == name.id and end < n.lineno < name.lineno for n in stored)
                if not again:
                    raise ModelError(
                        f"{self.function.__module__}.{self.function.__name__} cannot be made a "
                        f"warp function: give {name.id!r} a value before the loop"
                    )

    def _assign(self, node: ast.Assign) -> list[ast.stmt]:
        made: list[ast.stmt] = []
        for target in node.targets:
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                # one after the other, through temporaries: warp would bind names, not copy values
                names = [ast.Name(f"{ast.unparse(t)}_new", ast.Store()) for t in target.elts]
                for name, value in zip(names, node.value.elts, strict=True):
                    made += self._single(name, value)
                for t, name in zip(target.elts, names, strict=True):
                    self.locals.add(name.id)
                    made += self._single(t, ast.Name(name.id, ast.Load()))
            else:
                made += self._single(target, node.value)
        return made

    def _single(self, target: ast.expr, value: ast.expr) -> list[ast.stmt]:
        new = self.visit(value)
        if isinstance(target, ast.Subscript):
            # an array holds doubles; counts go into it too
            new = new if _is_double(new) else _call("wp.float64", new)
            target = self.visit(target)
        elif isinstance(new, ast.Constant):
            # a bare constant could not change in a loop
            new = _call("bool" if isinstance(new.value, bool) else "int", new)
        return [ast.Assign([target], new)]

    # expressions

    def visit(self, node: ast.AST) -> Any:
        if not hasattr(self, f"visit_{type(node).__name__}") and not isinstance(node, _AS_IT_IS):
            raise self._unknown(node)
        return super().visit(node)

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return self._number(node.value, node)

    def _number(self, value: Any, node: ast.AST) -> ast.expr:
        if isinstance(value, bool | int):
            return ast.Constant(value)
        if isinstance(value, float):
            if math.isfinite(value):
                return _call("wp.float64", ast.Constant(value))
            special = "wp.nan" if math.isnan(value) else "wp.inf"
            made = _call("wp.float64", _name(special))
            return made if not value < 0.0 else ast.UnaryOp(ast.USub(), made)
        raise self._unknown(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        operand = node.operand
        if isinstance(node.op, ast.USub) and isinstance(operand, ast.Constant):
            if isinstance(operand.value, int | float):
                return self._number(-operand.value, node)
            raise self._unknown(node)
        return ast.UnaryOp(node.op, self.visit(node.operand))

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self.locals:
            return _name(node.id)
        return self._global(self._look_up(node), node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return self._global(self._look_up(node), node)

    def _look_up(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Attribute):
            return getattr(self._look_up(node.value), node.attr)
        if isinstance(node, ast.Name) and node.id in self.function.__globals__:
            return self.function.__globals__[node.id]
        raise self._unknown(node)

    def _global(self, value: Any, node: ast.expr) -> ast.expr:
        if isinstance(value, tuple):
            name = f"{self.key}_{ast.unparse(node).strip('_')}"
            numbers = ", ".join(repr(float(x)) for x in value)
            self.vectors[name] = f"wp.types.vector({len(value)}, wp.float64)({numbers})"
            return _name(name)
        return self._number(value, node)

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        left, right = self.visit(node.left), self.visit(node.right)
        if isinstance(node.op, ast.Pow) and isinstance(right, ast.Constant):
            if right.value != 2:
                raise self._unknown(node)
            return ast.BinOp(left, ast.Mult(), left)
        return ast.BinOp(left, node.op, right)

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        terms = [node.left, *node.comparators]
        pairs: list[ast.expr] = []
        for left, op, right in zip(terms, node.ops, terms[1:], strict=False):
            a, b = self.visit(left), self.visit(right)
            # array elements are doubles, the names of laws and effects whole numbers
            whole = b.value if isinstance(b, ast.Constant) else None
            if isinstance(left, ast.Subscript) and isinstance(whole, int):
                b = _call("wp.float64", ast.Constant(float(whole)))
            pairs.append(ast.Compare(a, [op], [b]))
        return pairs[0] if len(pairs) == 1 else ast.BoolOp(ast.And(), pairs)

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if node.keywords:
            raise self._unknown(node)
        arguments = [self.visit(a) for a in node.args]
        if isinstance(node.func, ast.Name) and node.func.id in _BUILTIN:
            return ast.Call(_name(node.func.id), arguments, [])
        if isinstance(node.func, ast.Name) and node.func.id == "float":
            return _call("wp.float64", *arguments)
        called = self._look_up(node.func)
        if called is room:
            return ast.parse(f"wp.zeros(shape={self.room}, dtype=wp.float64)", mode="eval").body
        if hasattr(called, "py_func"):
            self.calls.append(called)
            return ast.Call(_name(_key(called)), arguments, [])
        name = getattr(called, "__name__", "")
        if getattr(math, name, None) is called:
            if name in _OWN:
                return ast.Call(_name(name), arguments, [])
            if name == "ceil":
                return _call("int", _call("wp.ceil", *arguments))
            if name in _MATH:
                return _call(f"wp.{name}", *arguments)
        raise self._unknown(node)


def _is_double(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and ast.unparse(node.func) == "wp.float64"


def _name(dotted: str) -> ast.expr:
    return ast.parse(dotted, mode="eval").body


def _call(dotted: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(_name(dotted), list(arguments), [])
