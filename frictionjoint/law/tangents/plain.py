"""Statements of a kernel brought into a plainer form before they are differentiated."""

import ast

from frictionjoint.law.tangents.terms import expression


class UnknownError(Exception):
    """A construct that cannot be differentiated."""


def plain(body: list[ast.stmt], left_out: set[str]) -> list[ast.stmt]:
    """Assignments one by one, those of ``x += y`` and of ``x, y = a, b`` too.

    Args:
        left_out: source of statements to leave out.
    Raises:
        UnknownError: a tuple is not given by its elements, or one of them needs one before it.
    """
    made: list[ast.stmt] = []
    for node in body:
        if ast.unparse(node) in left_out:
            continue
        if isinstance(node, ast.If | ast.While | ast.For):
            node.body, node.orelse = plain(node.body, left_out), plain(node.orelse, left_out)
        if isinstance(node, ast.AugAssign):
            left = expression(ast.unparse(node.target))
            made.append(_assignment(node.target, ast.BinOp(left, node.op, node.value)))
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Tuple):
            made += _one_by_one(node, node.targets[0].elts)
        elif isinstance(node, ast.Assign):
            *others, last = node.targets
            made.append(_assignment(last, node.value))
            made += [_assignment(target, last) for target in others]
        else:
            made.append(node)
    return made


def without_value(body: list[ast.stmt]) -> list[ast.stmt]:
    """Without the value returned, and without what was computed for it alone."""
    for node in (n for statement in body for n in ast.walk(statement)):
        if isinstance(node, ast.Return):
            node.value = None
    if isinstance(body[-1], ast.Return):
        body = body[:-1]
    while True:
        names = [n for s in body for n in ast.walk(s) if isinstance(n, ast.Name)]
        used = {n.id for n in names if isinstance(n.ctx, ast.Load)}
        left = [s for s in body if not (isinstance(s, ast.Assign) and _sets_none_of(used, s))]
        if len(left) == len(body):
            return left
        body = left


def _one_by_one(node: ast.Assign, targets: list[ast.expr]) -> list[ast.stmt]:
    if not isinstance(node.value, ast.Tuple):
        raise UnknownError(ast.unparse(node))
    pairs = list(zip(targets, node.value.elts, strict=True))
    set_before: set[str] = set()
    for target, value in pairs:
        if set_before & {n.id for n in ast.walk(value) if isinstance(n, ast.Name)}:
            raise UnknownError(ast.unparse(node))
        set_before.add(ast.unparse(target))
    return [_assignment(target, value) for target, value in pairs]


def _sets_none_of(used: set[str], node: ast.Assign) -> bool:
    target = node.targets[0]
    return isinstance(target, ast.Name) and target.id not in used


def _assignment(target: ast.expr, value: ast.expr) -> ast.stmt:
    return ast.parse(f"{ast.unparse(target)} = {ast.unparse(value)}").body[0]
