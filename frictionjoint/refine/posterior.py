"""Uncertainty of a model as parameter sets to draw, for domain randomisation.

The posterior is that of the numbers of a parameter file, not of the variables of a fit, so a report
alone is sufficient to draw from it. Nonnegative numbers are drawn from lognormal distributions, a
curve by its increments; an impossible set is drawn again.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.eigenvalues import eigh
from frictionjoint.errors import ParameterError
from frictionjoint.files import joint_friction, toml_document
from frictionjoint.identify.rival_shape import Constraint
from frictionjoint.joint_friction import JointFriction

_PAIRS = ("pos", "neg")


@dataclass(frozen=True)
class Posterior:
    """A joint distribution of the numbers of a parameter file."""

    content: dict[str, Any]  # of the file at the mean
    # change of each number with each of r independent standard normal numbers, shape (m, r), in the
    # order of `numbers_in`
    factor: Array
    # number of first columns that stem from the gain of the drive, which the logs determine
    # together with the friction: 1, or 0 if the torque was measured
    of_gain: int = 0
    # how friction acts in the logs, if they show MuJoCo's own `frictionloss`
    constraint: Constraint | None = None

    @property
    def cov(self) -> Array:
        """Covariance of the numbers if the gain of the drive is known, shape (m, m)."""
        rest = self.factor[:, self.of_gain :]
        return np.asarray(rest @ rest.T)

    @classmethod
    def of(
        cls,
        values: Array,
        cov: Array,
        made: Callable[[Array], JointFriction],
        has_gain: bool = False,
    ) -> "Posterior":
        """From a fit's numbers, whose first may be the gain of the drive, their covariance, and the
        friction they define."""
        gain: Array = np.zeros((0, len(values)))
        if has_gain and np.isfinite(cov[0]).all() and cov[0, 0] > 0.0:
            gain = cov[:1] / np.sqrt(cov[0, 0])
            cov = cov - gain.T @ gain
        squares, U = eigh(0.5 * (cov + cov.T))
        known = np.isfinite(squares) & (squares > 0.0)
        moves = np.concatenate([gain, (U[:, known] * np.sqrt(squares[known])).T])
        content = _content(made(values))
        mean = numbers_in(content)
        size = len(mean)

        def reached(x: Array) -> Array | None:
            """The numbers of a friction, None if it is impossible."""
            try:
                return numbers_in(_content(made(x)))
            except ParameterError:
                return None

        columns, h = [], 0.1  # a step, in standard errors
        for move in moves:
            up, down = (reached(values + d * move) for d in (h, -h))
            # at the end of a range there is one side alone, in its corner none
            width = h * ((up is not None) + (down is not None)) or 1.0
            columns.append(
                ((mean if up is None else up) - (mean if down is None else down)) / width
            )
        factor = np.column_stack(columns) if columns else np.zeros((size, 0))
        return cls(content, factor, len(gain))

    def sample(self, n: int, seed: int = 0) -> tuple[JointFriction, ...]:
        """Draw parameter sets, for `install`; ParameterError: fewer than one requested, a negative
        seed, almost no drawn set is possible."""
        if n < 1 or seed < 0:
            raise ParameterError(f"{n} samples, seed {seed}: give at least 1, and a seed from 0")
        rng = np.random.default_rng(seed)
        mean = numbers_in(self.content)
        positive = np.array([entry.positive for entry in entries(self.content)], dtype=bool)
        found: list[JointFriction] = []
        tries = 100 * n
        for _ in range(tries):
            # nothing is drawn beyond three standard errors
            z = np.clip(rng.standard_normal(self.factor.shape[1]), -3.0, 3.0)
            step = self.factor @ z
            safe = np.where(mean != 0.0, mean, 1.0)
            relative = np.clip(step / safe, -3.0 * 0.7, 3.0 * 0.7)
            drawn = np.where(positive, mean * np.exp(relative), mean + step)
            try:
                found.append(joint_friction(with_numbers(self.content, drawn)))
            except ParameterError:
                continue
            if len(found) == n:
                return tuple(found)
        raise ParameterError(
            f"of {tries} sets drawn {len(found)} are possible: the logs determine too little"
        )

    def to_dict(self) -> dict[str, Any]:
        """The content of report.json."""
        own = {"parameters": self.content, "factor": self.factor.tolist(), "of_gain": self.of_gain}
        return own | ({"constraint": self.constraint._asdict()} if self.constraint else {})

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> "Posterior":
        """Inverse of `to_dict`; ParameterError: no friction, or a factor that is not of it."""
        parameters, rows = dict(content["parameters"]), content["factor"]
        joint_friction(parameters)
        size = len(numbers_in(parameters))
        if len(rows) != size or len({len(row) for row in rows}) != 1:
            raise ParameterError(f"posterior: its factor must be {size} rows of one length")
        own = content.get("constraint")
        constraint = Constraint(float(own["lead"]), float(own["V0"])) if own else None
        factor = np.array(rows, dtype=float)
        return cls(parameters, factor, content.get("of_gain", 0), constraint)


def _content(friction: JointFriction) -> dict[str, Any]:
    content: dict[str, Any] = toml_document(friction.parameters, friction.effects).unwrap()
    return content


def numbers_in(content: Mapping[str, Any]) -> Array:
    """All numbers of a parameter file: Fs as its excess over Fc, curves as increments."""
    return np.array([entry.value for entry in entries(content)])


class Entry(NamedTuple):
    """A number of a parameter file."""

    key: str  # its name in the file
    effect: Mapping[str, Any] | None  # table that contains it; None: a number of the law
    value: float  # see `numbers_in`
    positive: bool  # whether it can never be negative


def entries(content: Mapping[str, Any]) -> list[Entry]:
    """All numbers of a parameter file, in its order."""
    found: list[Entry] = []
    for key, x in content.items():
        if key == "knots":
            steps = np.diff(np.array(x), axis=0, prepend=[[0.0, 0.0]]).ravel()
            found += [Entry(key, None, step, True) for step in steps.tolist()]
        elif key == "effects":
            own = [(k, table, v) for table in x for k, v in table.items() if is_number(k, v)]
            found += [Entry(k, table, v, v > 0.0) for k, table, v in own]
        elif is_number(key, x):
            side = key.rpartition("_")[2]
            below = content.get(f"Fc_{side}", 0.0) if key.startswith("Fs_") else 0.0
            found.append(Entry(key, None, float(x) - float(below), True))
    return found


def with_numbers(content: Mapping[str, Any], numbers: Array) -> dict[str, Any]:
    """A parameter file with other numbers."""
    left = iter(float(x) for x in numbers)
    found: dict[str, Any] = {}
    for key, x in content.items():
        if key == "knots":
            found[key] = np.cumsum([[next(left), next(left)] for _ in x], axis=0).tolist()
        elif key == "effects":
            found[key] = [
                {k: next(left) if is_number(k, v) else v for k, v in table.items()} for table in x
            ]
        else:
            found[key] = next(left) if is_number(key, x) else x
    for side in _PAIRS:
        if f"Fs_{side}" in found:
            found[f"Fs_{side}"] += found[f"Fc_{side}"]
    if "knots" in found:  # the curve goes on to where the levels need it
        ends = [sum(c[f"Fs_{side}"] for side in _PAIRS) for c in (content, found)]
        scale = content["knots"][-1][1] / ends[0] * ends[1] / found["knots"][-1][1]
        found["knots"] = [[z, F * scale] for z, F in found["knots"]]
    return found


def is_number(key: str, x: Any) -> bool:
    return isinstance(x, float) and key not in ("n", "form")
