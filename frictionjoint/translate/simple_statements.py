"""Rewrite the statements of a kernel in a simpler form: each assigns one value to one target."""

import ast
import copy
from collections.abc import Iterator


def plain(body: list[ast.stmt], fresh: Iterator[str]) -> list[ast.stmt]:
    """Split assignments, including ``x += y``, ``x = y = a``, ``x, y = a, b`` and ``x: int = a``;
    ``x, y = f(a)`` stays as it is if x and y are names. `fresh`: new names for values that must be
    kept until other values have been computed.
    """
    made: list[ast.stmt] = []
    for node in body:
        if isinstance(node, ast.If | ast.While | ast.For):
            new = copy.copy(node)
            new.body, new.orelse = plain(node.body, fresh), plain(node.orelse, fresh)
            made.append(new)
        elif isinstance(node, ast.AugAssign):
            made.append(
                _assignment(node.target, ast.BinOp(_loaded(node.target), node.op, node.value))
            )
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            made.append(_assignment(node.target, node.value))
        elif isinstance(node, ast.Assign):
            made += _one_by_one(node.targets, node.value, fresh)
        else:
            made.append(node)
    return made


def names_in(node: ast.AST) -> set[str]:
    """All names in a piece of source."""
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def stored_in(node: ast.AST) -> set[str]:
    """Names that a piece of source assigns to."""
    nodes = (n for n in ast.walk(node) if isinstance(n, ast.Name))
    return {n.id for n in nodes if isinstance(n.ctx, ast.Store)}


def _one_by_one(
    targets: list[ast.expr], value: ast.expr, fresh: Iterator[str]
) -> Iterator[ast.stmt]:
    if len(targets) > 1 and not isinstance(value, ast.Name | ast.Constant):
        named = [to for to in targets if isinstance(to, ast.Name)]
        first = named[0] if named else ast.Name(next(fresh), ast.Store())
        yield _assignment(first, value)
        targets, value = [to for to in targets if to is not first], _loaded(first)
    for to in targets:
        if isinstance(to, ast.Tuple) and isinstance(value, ast.Tuple):
            yield from _side_by_side(list(zip(to.elts, value.elts, strict=True)), fresh)
        elif isinstance(to, ast.Tuple):
            names = [
                x if isinstance(x, ast.Name) else ast.Name(next(fresh), ast.Store())
                for x in to.elts
            ]
            yield _assignment(ast.Tuple([*names], ast.Store()), value)
            for place, name in zip(to.elts, names, strict=True):
                if place is not name:
                    yield _assignment(place, _loaded(name))
        else:
            yield _assignment(to, value)


def _side_by_side(
    pairs: list[tuple[ast.expr, ast.expr]], fresh: Iterator[str]
) -> Iterator[ast.stmt]:
    # assignments can be made one after the other unless a later value, or a later target, reads
    # a variable that an earlier one has set
    stored: set[str] = set()
    at_once = False
    for to, value in pairs:
        at_once |= bool(stored & (names_in(value) | _read(to)))
        stored |= _set_by(to)
    if at_once:
        held = [ast.Name(next(fresh), ast.Store()) for _ in pairs]
        for name, (_, value) in zip(held, pairs, strict=True):
            yield _assignment(name, value)
        pairs = [(to, _loaded(name)) for name, (to, _) in zip(held, pairs, strict=True)]
    for to, value in pairs:
        yield _assignment(to, value)


def _assignment(target: ast.expr, value: ast.expr) -> ast.stmt:
    return ast.fix_missing_locations(ast.Assign([target], value, lineno=0))


def _loaded(target: ast.expr) -> ast.expr:
    """The target of an assignment, as a value."""
    value = copy.copy(target)
    value.ctx = ast.Load()  # type: ignore[attr-defined]
    return value


def _set_by(target: ast.expr) -> set[str]:
    """The variable or array that an assignment changes."""
    while isinstance(target, ast.Subscript):
        target = target.value
    return names_in(target)


def _read(target: ast.expr) -> set[str]:
    """Names that the target of an assignment reads, for example in a subscript."""
    return names_in(target.slice) if isinstance(target, ast.Subscript) else set()
