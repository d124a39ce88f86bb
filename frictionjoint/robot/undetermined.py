"""Parameters that the logs of a robot do not determine, as rows for the report."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from frictionjoint.identify.result import LOOSE, Estimate
from frictionjoint.parameter_meanings import meaning
from frictionjoint.report.numbers import status_of
from frictionjoint.robot.information import BaseParameters, Information, base_parameters, errors


def undetermined(
    found: Information, friction: Mapping[str, Mapping[str, Estimate]]
) -> tuple[dict[str, Any], ...]:
    """Rows with ``kind``, ``parameters`` and ``text``; `friction` is the law of each joint."""
    base = base_parameters(found)
    unseen = _by_owner(found, base.unseen, "without effect", "no effect on these torques")
    rows = [*_sums(found, base), *unseen, *_loose(found, base)]
    for joint, estimates in friction.items():
        status = {n: status_of(n, estimates) for n in estimates}
        names = [n for n, x in status.items() if x in ("assumed", "not determined")]
        if names:
            assumed = {n: " (assumed)" if status[n] == "assumed" else "" for n in names}
            words = dict.fromkeys(meaning(n.partition("_")[0]) + assumed[n] for n in names)
            text = f"friction of {joint}: {', '.join(words)}"
            rows.append(_row("friction", names, text, joint=joint))
    return tuple(rows)


def _sums(found: Information, base: BaseParameters) -> list[dict[str, Any]]:
    """Parameters that appear only in sums, by owner, and the owners of the other terms."""
    owners: dict[str, tuple[list[str], list[str]]] = {}
    for k, other in enumerate(base.others):
        p = found.parameters[other]
        c = np.abs(base.sums[:, k])
        # parameters with a noticeable coefficient in the sum
        parts = [found.parameters[base.base[i]] for i in np.flatnonzero(c > 1e-3 * c.max())]
        names, partners = owners.setdefault(p.owner, ([], []))
        names.append(p.name)
        partners += [x.owner for x in parts]
    return [
        _row(
            "only in sums",
            names,
            f"{', '.join(names)} of {owner}: only in sums with parameters of "
            f"{', '.join(dict.fromkeys(partners))}",
            owner=owner,
        )
        for owner, (names, partners) in owners.items()
    ]


def _loose(found: Information, base: BaseParameters) -> list[dict[str, Any]]:
    # ten correlated samples count as one
    loose = base.base[errors(found, base.base) * np.sqrt(10.0) > LOOSE]
    text = f"known to no better than {LOOSE:.0%} of the model's own size"
    return _by_owner(found, loose, "loose", text)


def _by_owner(found: Information, at: Iterable[int], kind: str, text: str) -> list[dict[str, Any]]:
    owners: dict[str, list[str]] = {}
    for k in sorted(at):
        owners.setdefault(found.parameters[k].owner, []).append(found.parameters[k].name)
    return [
        _row(kind, names, f"{', '.join(names)} of {owner}: {text}", owner=owner)
        for owner, names in owners.items()
    ]


def _row(kind: str, names: list[str], text: str, **place: str) -> dict[str, Any]:
    return {"kind": kind, **place, "parameters": names, "text": text}
