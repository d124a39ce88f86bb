"""How well logs determine a robot's rigid body: its regressor with friction projected out.

Parameters are scaled by their own size, so that a direction of the parameter space is weak or
strong in any units: the mass of a link by its mass, first moments by mass times size, inertias
by mass times size squared, a rotor by the inertia about its joint.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from scipy.linalg import qr

from frictionjoint.arrays import Array, Index
from frictionjoint.eigenvalues import eigh
from frictionjoint.identify.basis import lengths, pseudo_inverse, without
from frictionjoint.identify.result import LOOSE, Estimate
from frictionjoint.model_joints import mass_at_start
from frictionjoint.parameter_meanings import meaning
from frictionjoint.report.numbers import status_of
from frictionjoint.robot.causes.catalogue import body_label, links_of
from frictionjoint.robot.columns import law_columns
from frictionjoint.robot.inertia import NAMES
from frictionjoint.robot.joint import FittedJoint


@dataclass(frozen=True)
class Parameter:
    """A parameter of a link or of a joint's rotor, its owner; `size` is its scale, SI units."""

    owner: str
    name: str
    size: float


@dataclass(frozen=True)
class Information:
    """Gram matrix, shape (k, k), of the scaled columns of parameters, in units of the residuals."""

    parameters: tuple[Parameter, ...]
    gram: Array = field(repr=False)


def _sizes(model: mujoco.MjModel, body: int) -> tuple[float, ...]:
    """Scales of the ten parameters; a length is the radius of gyration or the centre's distance."""
    mass = float(model.body_mass[body])
    gyration = float(np.sqrt(model.body_inertia[body].sum() / max(mass, 1e-9)))
    size = max(gyration, float(np.linalg.norm(model.body_ipos[body])), 0.01)
    mass = max(mass, 1e-3)
    return mass, *(mass * size,) * 3, *(mass * size**2,) * 6


def information(joints: Sequence[FittedJoint], moving: Sequence[str]) -> Information:
    model = joints[0].alongs[0].model
    names = [j.name for j in joints]
    bodies = links_of(model, names, moving)
    parameters = []
    for b in bodies:
        scales = zip(NAMES, _sizes(model, b), strict=True)
        parameters += [Parameter(body_label(model, b), name, size) for name, size in scales]
    of_dof = np.diag(mass_at_start(model)).tolist()
    own = ((n, of_dof[int(model.joint(n).dofadr[0])]) for n in names)
    parameters += [Parameter(n, "rotor inertia", size) for n, size in own]
    G = np.zeros((len(parameters),) * 2)
    for i, joint in enumerate(joints):
        rows = []
        for along in joint.alongs:
            rotors = np.zeros((len(along.rate), len(joints)))
            rotors[:, i] = along.rate
            rows.append(np.column_stack([*(along.bodies(b) for b in bodies), rotors]))
        X = np.concatenate(rows) * (joint.fit.weight / joint.left)[:, None]
        G += gram_without(X * [p.size for p in parameters], law_columns(joint))
    return Information(tuple(parameters), G)


def gram_without(X: Array, known: Array) -> Array:
    """Gram matrix of columns with others projected out, shape (k, k)."""
    left = without(X, known / lengths(known))
    return np.asarray(left.T @ left)


class BaseParameters:
    """Which parameters logs determine, alone or in sums, by a pivoted QR (Gautier 1991).

    The factor is computed from the Gram matrix, so directions below the square root of rounding do
    not count.

    Attributes:
        base: indices of the base parameters, shape (b,). others: indices of those that appear only
            in sums with them, shape (c,). sums: coefficients, shape (b, c).
        unseen: indices of parameters without any torque.
    """

    def __init__(self, found: Information) -> None:
        values, vectors = eigh(found.gram)
        # of the largest singular value: smaller ones are exact columns of what never shows
        least = 1e-7
        keep = values > least**2 * values[-1]
        root = np.sqrt(values[keep])[:, None] * vectors[:, keep].T
        size = np.linalg.norm(root, axis=0)
        self.unseen = np.flatnonzero(size <= least * size.max())
        seen = np.setdiff1d(np.arange(len(size)), self.unseen)
        _, R, order = qr(root[:, seen] / size[seen], mode="economic", pivoting=True)
        rank = int(np.sum(np.abs(np.diag(R)) > least * np.abs(R[0, 0])))
        self.base, self.others = seen[order[:rank]], seen[order[rank:]]
        sums = np.linalg.solve(R[:rank, :rank], R[:rank, rank:])
        self.sums = sums * size[self.others] / size[self.base][:, None]


def errors(found: Information, base: Index) -> Array:
    """Relative standard errors of base parameters, for independent samples, shape (b,)."""
    # smaller eigenvalues are rounding
    return np.asarray(np.sqrt(np.diag(pseudo_inverse(found.gram[np.ix_(base, base)], 1e-15))))


def undetermined(
    found: Information, friction: Mapping[str, Mapping[str, Estimate]]
) -> tuple[dict[str, Any], ...]:
    """Rows with ``kind``, ``parameters`` and ``text``; `friction` is the law of each joint."""
    base = BaseParameters(found)
    unseen = _by_owner(found, base.unseen, "without effect", "no effect on these torques")
    # ten correlated samples count as one
    at = base.base[errors(found, base.base) * np.sqrt(10.0) > LOOSE]
    text = f"known to no better than {LOOSE:.0%} of the model's own size"
    rows = [*_sums(found, base), *unseen, *_by_owner(found, at, "loose", text)]
    for joint, estimates in friction.items():
        status = {n: status_of(n, estimates) for n in estimates}
        names = [n for n, x in status.items() if x in ("assumed", "not determined")]
        if names:
            assumed = {n: " (assumed)" if status[n] == "assumed" else "" for n in names}
            words = dict.fromkeys(meaning(n.partition("_")[0]) + assumed[n] for n in names)
            text = f"friction of {joint}: {', '.join(words)}"
            place = {"kind": "friction", "joint": joint}
            rows.append(place | {"parameters": names, "text": text})
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
    sums = "only in sums"
    return [
        _row(sums, owner, names, f"{sums} with parameters of {others}, assumed correct")
        for owner, (names, partners) in owners.items()
        for others in (", ".join(dict.fromkeys(partners)),)
    ]


def _by_owner(found: Information, at: Iterable[int], kind: str, text: str) -> list[dict[str, Any]]:
    owners: dict[str, list[str]] = {}
    for k in sorted(at):
        owners.setdefault(found.parameters[k].owner, []).append(found.parameters[k].name)
    return [_row(kind, owner, names, text) for owner, names in owners.items()]


def _row(kind: str, owner: str, names: list[str], text: str) -> dict[str, Any]:
    row = {"kind": kind, "owner": owner, "parameters": names}
    return row | {"text": f"{', '.join(names)} of {owner}: {text}"}
