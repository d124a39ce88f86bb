"""Activity analysis: which numbers of a kernel have a tangent.

In the terms of automatic differentiation, a number is *varied* if it depends on a parameter of the
law. Tangents that nothing uses are left to the compiler, which removes them.
"""

import ast
import inspect
from typing import Any

from frictionjoint.law.tangents.particulars import COUNTS, COUNTS_OF, LEFT_OUT, ROUNDED
from frictionjoint.translate.kernel import Kernel, is_kernel, signature, without_unread
from frictionjoint.translate.kinds import DOUBLE, NOTHING, REALS


class Activity(Kernel):
    """A kernel, and which of its numbers have a tangent.

    Attributes:
        arguments: annotation of each argument by name. arrays: arguments that are arrays.
        varied: local numbers with a tangent.
    """

    purpose = "differentiated"

    def __init__(self, kernel: Any, moving: frozenset[str], wanted: bool) -> None:
        """Analyse a kernel; for the arguments see `differentiate.Differentiated`."""
        super().__init__(kernel)
        self.read(left_out=LEFT_OUT)
        if not wanted:
            self.body = without_unread(self._without_value(self.body))
        self.owner: Any = inspect.getmodule(self.python)
        self.rounded = ROUNDED.get(kernel, {})
        self.exact: set[ast.AST] = set()
        self.arguments = {a.arg: ast.unparse(a.annotation or a) for a in self.tree.args.args}
        self.arrays = {name for name in self.parameters if self.kinds[name] == REALS}
        nodes = [node for statement in self.body for node in ast.walk(statement)]
        assigned = [(x.targets[0], x.value) for x in nodes if isinstance(x, ast.Assign)]
        pairs = [(to.id, value) for to, value in assigned if isinstance(to, ast.Name)]
        self.varied = set(moving)
        for _ in pairs:  # a value may depend on one that is assigned further below, in a loop
            self.varied |= {name for name, value in pairs if self.moves(value)}

    def moves(self, node: ast.expr) -> bool:
        """Whether a value has a tangent, or a call sets one."""
        node = self.exactly(node)
        if isinstance(node, ast.Name):
            return node.id in self.varied
        if isinstance(node, ast.Subscript):
            return not self.is_count(node)
        if isinstance(node, ast.Compare | ast.BoolOp | ast.Constant | ast.Attribute):
            return False
        if isinstance(node, ast.Call):
            kernel = self.kernel_of(node)
            if kernel is None and ast.unparse(node.func) in ("int", "len", "range"):
                return False
            if kernel is not None:
                if signature(kernel).result not in (DOUBLE, NOTHING):
                    return False
                if any(ast.unparse(argument) in self.arrays for argument in node.args):
                    return True
        return any(self.moves(part) for part in _parts(node))

    def exactly(self, node: ast.expr) -> ast.expr:
        """The expression to differentiate instead of a given one, equal except for rounding."""
        found = self.rounded.get(ast.unparse(node))
        if found is None or node in self.exact:
            return node
        tree = ast.parse(found, mode="eval").body
        # the new expression may contain the old one, which must not be replaced again
        self.exact.update(ast.walk(tree))
        return tree

    def is_count(self, node: ast.Subscript) -> bool:
        """Whether an array element is a count, a flag or a choice."""
        names = {n.id for n in ast.walk(node.slice) if isinstance(n, ast.Name)}
        return any(count <= names for count in COUNTS + COUNTS_OF.get(self.owner, ()))

    def _without_value(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """A body that returns nothing; of returned values, calls that write to arrays stay."""
        kept: list[ast.stmt] = []
        for node in body:
            if isinstance(node, ast.If | ast.While | ast.For):
                node.body, node.orelse = map(self._without_value, (node.body, node.orelse))
            elif isinstance(node, ast.Return):
                if isinstance(node.value, ast.Call) and self._writes(node.value):
                    kept.append(ast.Expr(node.value))
                node = ast.Return()
            kept.append(node)
        return kept

    def _writes(self, node: ast.Call) -> bool:
        """Whether a call is of a kernel that sets elements of arrays."""
        kernel = self.kernel_of(node)
        nodes = ast.walk(signature(kernel).tree) if kernel else ()
        return any(isinstance(n, ast.Subscript) and isinstance(n.ctx, ast.Store) for n in nodes)

    def kernel_of(self, node: ast.Call) -> Any:
        """The kernel that a call calls; None if the called function is not a kernel."""
        found = self.called(node)
        return found if is_kernel(found) else None


def _parts(node: ast.expr) -> list[ast.expr]:
    """Subexpressions of a value; those of a choice without its condition."""
    if isinstance(node, ast.Call):
        return list(node.args)
    if isinstance(node, ast.IfExp):
        return [node.body, node.orelse]
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]
