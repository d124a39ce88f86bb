"""A kernel read from its source: statements in a simple form, and the kind of every value.

It serves C, Warp and derivatives. `frictionjoint.compiled` states which constructs a kernel may
contain; anything else is an error, never a guess.
"""

import ast
import functools
import inspect
import math
import textwrap
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from frictionjoint.compiled import External, Table, elements, is_tuple, pointer, room
from frictionjoint.errors import ModelError
from frictionjoint.translate.kinds import (
    DOUBLE,
    POINTERS,
    REALS,
    WHOLE,
    fields_of,
    is_structure,
    kind_of,
    tuple_of,
)
from frictionjoint.translate.simple_statements import plain, stored_in

# possible values of a number that selects a branch, by module and text of the expression
Known = Mapping[tuple[str, str], frozenset[float]]
_BUILT_IN = ("abs", "min", "max", "int", "float", "bool", "len")
_TO_WHOLE = (math.ceil, math.floor, math.isnan)


class Kernel:
    """One function.

    Attributes:
        python: the function itself. tree: its syntax tree. parameters: names in order.
        body: statements in the form of `plain`, after `read`.
        kinds: kind of each parameter and, after `read`, of each local variable.
        locals: names that the function assigns to. counters: loop counters.
        structures: NamedTuples among its arguments, by kind.
    """

    purpose = "translated"

    def __init__(self, function: Any) -> None:
        self.python: Callable[..., Any] = getattr(function, "py_func", function)
        self.in_line = bool(getattr(function, "in_line", False))
        tree = ast.parse(textwrap.dedent(inspect.getsource(self.python))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        self.tree = tree
        self.body: list[ast.stmt] = []
        self.structures: dict[str, Any] = {}
        self.kinds: dict[str, str] = {}
        self.kinds = {a.arg: self._annotation(a.annotation, a) for a in tree.args.args}
        self.parameters = list(self.kinds)
        self.locals = stored_in(tree)
        self.counters: set[str] = set()
        self._fresh = 0

    def read(self, known: Known | None = None, left_out: frozenset[str] = frozenset()) -> None:
        """Read the body, without the statements whose source is in `left_out`, and without branches
        for values that are not in `known`, the numbers by which the kernel selects."""
        doc = ast.get_docstring(self.tree)
        body = self._fold(self.tree.body[1:] if doc else self.tree.body, known or {}, left_out)
        self.body = plain(without_unread(body), iter(self._new_name, ""))
        self._infer()

    @property
    def name(self) -> str:
        """Name in the translation: the names of its package, its module and the function."""
        return "_".join([*self.python.__module__.split(".")[-2:], self.python.__name__.strip("_")])

    @property
    def aliases(self) -> dict[str, Any]:
        """Objects by name in the module of the function."""
        return self.python.__globals__

    @property
    def result(self) -> str:
        """Kind of the value that the kernel returns."""
        return self._annotation(self.tree.returns, self.tree)

    def unknown(self, node: ast.AST) -> NoReturn:
        """Raise ModelError for a construct that cannot be translated."""
        raise ModelError(
            f"{self.python.__module__}.{self.python.__name__} cannot be {self.purpose}: rewrite "
            f"{ast.unparse(node)!r} in plainer Python"
        )

    def look_up(self, node: ast.expr) -> Any:
        """The object that a name, or an attribute of a module, refers to."""
        if isinstance(node, ast.Attribute):
            return getattr(self.look_up(node.value), node.attr, None)
        if isinstance(node, ast.Name) and node.id in self.aliases:
            return self.aliases[node.id]
        self.unknown(node)

    def called(self, node: ast.Call) -> Any:
        """The function that a call calls; None for a built-in function."""
        if isinstance(node.func, ast.Name) and node.func.id not in self.aliases:
            return None
        return self.look_up(node.func)

    def is_local(self, node: ast.expr) -> bool:
        """Whether a value belongs to the function and not to a module."""
        if isinstance(node, ast.Name):
            return node.id in self.kinds or node.id in self.locals
        return isinstance(node, ast.Call) or bool(self.field(node))

    def field(self, node: ast.expr) -> str | None:
        """Kind of a field of a NamedTuple; None if the expression is not such a field."""
        if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
            return None
        kind = self.kinds.get(node.value.id)
        if kind is None or not is_structure(kind):
            return None
        return fields_of(self.structures[kind])[node.attr]

    # kinds

    def kind(self, node: ast.expr) -> str | None:
        """Kind of an expression; None while it depends on a local variable of unknown kind."""
        if isinstance(node, ast.Name) and self.is_local(node):
            return self.kinds.get(node.id)
        if self.field(node):
            return self.field(node)
        if isinstance(node, ast.Name | ast.Attribute):
            return self._kind_of_constant(node)
        if isinstance(node, ast.Constant):
            return DOUBLE if isinstance(node.value, float) else WHOLE
        if isinstance(node, ast.Subscript):
            return self._kind_of_element(node)
        if isinstance(node, ast.BoolOp | ast.Compare):
            return WHOLE
        if isinstance(node, ast.UnaryOp):
            return WHOLE if isinstance(node.op, ast.Not) else self.kind(node.operand)
        if isinstance(node, ast.IfExp):
            return self.wider(node.body, node.orelse)
        if isinstance(node, ast.BinOp):
            if isinstance(node.op, ast.Div | ast.Pow):
                return DOUBLE
            return self.wider(node.left, node.right)
        if isinstance(node, ast.Call):
            return self._kind_of_call(node)
        self.unknown(node)

    def wider(self, *nodes: ast.expr) -> str | None:
        """Kind that can represent the values of all given expressions."""
        kinds = [self.kind(node) for node in nodes]
        if len(set(kinds)) == 1:
            return kinds[0]
        return DOUBLE if DOUBLE in kinds else None if None in kinds else WHOLE

    def _annotation(self, node: ast.expr | None, where: ast.AST) -> str:
        kind = kind_of(node, self.aliases)
        if kind is None or node is None:
            self.unknown(where)
        if is_structure(kind):
            self.structures[kind] = self.aliases[ast.unparse(node)]
        return kind

    def _kind_of_constant(self, node: ast.Name | ast.Attribute) -> str:
        if is_shape(node):
            self.unknown(node)
        value = self.look_up(node)
        if isinstance(value, tuple):
            return tuple_of(DOUBLE if isinstance(x, float) else WHOLE for x in value)
        return DOUBLE if isinstance(value, float) else WHOLE

    def _kind_of_element(self, node: ast.Subscript) -> str | None:
        if is_shape(node.value):
            return WHOLE
        if isinstance(node.value, ast.Name | ast.Attribute) and not self.is_local(node.value):
            value = self.look_up(node.value)
            if isinstance(value, Table):
                return WHOLE
            return DOUBLE if any(isinstance(x, float) for x in value) else WHOLE
        kind = self.kind(node.value)
        if kind is None:
            return None
        if is_tuple(kind):
            return elements(kind)[place(node.slice)]
        return POINTERS[kind] if kind in POINTERS else self.unknown(node)

    def _kind_of_call(self, node: ast.Call) -> str | None:
        name = built_in(node)
        if name in ("abs", "min", "max"):
            return self.wider(*node.args)
        if name:
            return DOUBLE if name == "float" else WHOLE
        called = self.look_up(node.func)
        if called in (room, pointer):
            return REALS
        if is_kernel(called) or isinstance(called, External) or hasattr(called, "c_text"):
            return signature(called).result
        return WHOLE if called in _TO_WHOLE else DOUBLE

    def _infer(self) -> None:
        """Infer the kinds of local variables."""
        pairs: list[tuple[ast.expr, int, ast.expr]] = []
        for node in (n for statement in self.body for n in ast.walk(statement)):
            if isinstance(node, ast.Assign):
                to, value = node.targets[0], node.value
                many = to.elts if isinstance(to, ast.Tuple) else []
                pairs += [(each, i, value) for i, each in enumerate(many)] or [(to, -1, value)]
            elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
                self.counters.add(node.target.id)
                self.kinds.setdefault(node.target.id, WHOLE)
        own = set(self.kinds)
        for _ in pairs:
            before = dict(self.kinds)
            for to, at, value in pairs:
                if isinstance(to, ast.Name) and to.id not in own:
                    kind = self.kind(value)
                    if kind and at != -1:
                        kind = elements(kind)[at] if is_tuple(kind) else self.unknown(value)
                    if kind and self.kinds.get(to.id) != DOUBLE:
                        self.kinds[to.id] = kind
            if before == self.kinds:
                break

    # the body

    def _new_name(self) -> str:
        self._fresh += 1
        name = f"value_{self._fresh}"
        if name in self.locals or name in self.parameters:
            return self._new_name()
        self.locals.add(name)
        return name

    def _fold(self, body: list[ast.stmt], known: Known, left_out: frozenset[str]) -> list[ast.stmt]:
        """A body without the branches that known values exclude, and what cannot be reached."""
        kept: list[ast.stmt] = []
        for node in body:
            if left_out and ast.unparse(node) in left_out:
                continue
            if isinstance(node, ast.If | ast.While | ast.For):
                node.body = self._fold(node.body, known, left_out)
                node.orelse = self._fold(node.orelse, known, left_out)
            sure = self._decided(node.test, known) if isinstance(node, ast.If) else None
            if sure is None:
                kept.append(node)
            elif isinstance(node, ast.If):
                kept += node.body if sure else node.orelse
            if kept and isinstance(kept[-1], ast.Return):
                break
        return kept

    def _decided(self, test: ast.expr, known: Known) -> bool | None:
        if not isinstance(test, ast.Compare) or not isinstance(test.ops[0], ast.Eq | ast.NotEq):
            return None
        module = ".".join(self.python.__module__.split(".")[-2:])
        values = known.get((module, ast.unparse(test.left)))
        if values is None:
            return None
        right = test.comparators[0]
        value = right.value if isinstance(right, ast.Constant) else self.look_up(right)
        equal = isinstance(test.ops[0], ast.Eq)
        if value not in values:
            return not equal
        return equal if len(values) == 1 else None


@functools.cache
def signature(function: Any) -> Kernel:
    """Kinds of the arguments and the result of a kernel or another annotated function."""
    return Kernel(function.stub if isinstance(function, External) else function)


def is_kernel(value: Any) -> bool:
    """Whether something is a function marked by `frictionjoint.compiled`."""
    return hasattr(value, "py_func")


def built_in(node: ast.Call) -> str:
    """Name of the built-in Python function that a call calls, or an empty text."""
    return node.func.id if isinstance(node.func, ast.Name) and node.func.id in _BUILT_IN else ""


def is_shape(node: ast.expr) -> bool:
    """Whether an expression is the shape of an array."""
    return isinstance(node, ast.Attribute) and node.attr == "shape"


def place(node: ast.expr) -> int:
    """Value of a constant subscript."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int):
        return node.value
    raise ModelError(f"a tuple is taken apart by constants, not by {ast.unparse(node)!r}")


def without_unread(body: list[ast.stmt]) -> list[ast.stmt]:
    """A body without simple assignments of values that nothing reads."""
    nodes = [n for n in ast.walk(ast.Module(body, [])) if isinstance(n, ast.Name)]
    read = {n.id for n in nodes if isinstance(n.ctx, ast.Load)}

    def unread(node: ast.stmt) -> bool:
        if not isinstance(node, ast.Assign):
            return False
        calls = [n for n in ast.walk(node.value) if isinstance(n, ast.Call)]
        simple = all(ast.unparse(call.func) in ("int", "float") for call in calls)
        return simple and all(isinstance(t, ast.Name) and t.id not in read for t in node.targets)

    kept = [node for node in body if not unread(node)]
    return kept if len(kept) == len(body) else without_unread(kept)
