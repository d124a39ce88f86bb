"""Between motor and link, with an encoder on each: stiffness, backlash, hysteresis of the gear.

    twist = motor / ratio - link = torque / K + b/2 side(torque) - h element(torque) + T velocity

The torque is what the gear transmits, from the rigid-body model behind it. In a gap of width b the
twist changes where the torque changes its sign. A contact that slides between motor and link makes
the twist lag behind the torque by h in each direction, as an elastic-plastic element in the torque.
A delay T of the link's encoder adds a twist proportional to the speed. The motor of a wrist may
also turn with the previous joint; that is gearing, not twist.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.signals import GEAR, TIME, Q, V
from frictionjoint.identify.basis import lengths
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.smooth import elastic_plastic
from frictionjoint.measured.log import JointLog
from frictionjoint.report.entries import Torsion

# rise of the torque over its span within which the contact comes to slide
_REACHES = (0.02, 0.05, 0.1, 0.2, 0.4)
# torque over its largest below which it changes its side: loads in the gap and the filter blur it
_TURNS = (0.005, 0.01, 0.02, 0.05, 0.1)


def torsion(logs: Sequence[JointLog], prepared: Prepared) -> Torsion | None:
    """The gear of a joint with a second encoder in its logs, as prepared; None without one."""
    if any(log.motor_position is None for log in logs):
        return None
    ratio, geared = _gears(logs)
    span = max(float(np.ptp(log.position)) for log in logs)
    pairs = list(zip(logs, prepared.segments, strict=True))
    twist = np.concatenate([_twist(log, s, ratio, geared) for log, s in pairs])
    torque = np.concatenate([s.balanced(s.signals[:, GEAR]) for s in prepared.segments])
    # a column of ones per log
    counts = [int(s.kept.sum()) for s in prepared.segments]
    offsets = np.repeat(np.eye(len(counts)), counts, axis=0)
    size = root_mean_square(twist - offsets @ (offsets.T @ twist / offsets.sum(axis=0)))
    # with no twist the second position was computed from the first
    if size <= 1e-6 * span or not np.ptp(torque):
        return None
    link = np.concatenate([s.balanced(s.signals[:, [Q, V]]) for s in prepared.segments])
    known = np.column_stack([offsets, link, torque])
    unit = torque / np.abs(torque).max()
    elements = [_element(prepared, reach) for reach in _REACHES]
    sides = [np.tanh(unit / t) for t in _TURNS]
    names = "velocity", "torque", "gap", "lag"
    models = [
        _Model(np.column_stack([known, side, -e]), twist, names) for side in sides for e in elements
    ]
    best = _pruned(min(models, key=_cost))
    per, slope = ("N/m", "m") if prepared.slide else ("N m/rad", "rad")
    delay, soft, gap, lag = (best.estimate(name) for name in names)
    return Torsion(
        ratio=1.0 / ratio,
        geared=geared,
        twist_rms=size,
        left_rms=root_mean_square(best.residual),
        stiffness=soft and Estimate(1.0 / soft[0], soft[1] / soft[0] ** 2, per),
        backlash=gap and Estimate(2.0 * gap[0], 2.0 * gap[1], slope),
        hysteresis=lag and Estimate(2.0 * lag[0], 2.0 * lag[1], slope),
        link_position_older=delay and Estimate(*delay, "s"),
    )


@dataclass(frozen=True)
class _Model:
    """Columns of the twist; of the last ones, with names, only the velocity's may be negative."""

    X: Array
    y: Array
    names: tuple[str, ...]

    @property
    def residual(self) -> Array:
        return np.asarray(self.y - self.X @ self.solved())

    def without(self, name: str) -> "_Model":
        names = tuple(n for n in self.names if n != name)
        return _Model(np.delete(self.X, self._at(name), axis=1), self.y, names)

    def estimate(self, name: str) -> tuple[float, float] | None:
        """Coefficient and its error, by a jackknife over time; None if there is no such part."""
        if name not in self.names:
            return None
        i, blocks = self._at(name), 20
        block = np.arange(len(self.y)) * blocks // len(self.y)
        left_out = np.array([self.solved(block != b)[i] for b in range(blocks)])
        error = float(np.sqrt((blocks - 1) * np.mean((left_out - left_out.mean()) ** 2)))
        value = float(self.solved()[i])
        # from four standard errors on a part of the twist is there
        return (value, error) if abs(value) > 4.0 * error else None

    def solved(self, part: NDArray[np.bool_] | slice = slice(None)) -> Array:
        """Least-squares coefficients from a part of the samples, shape (k,)."""
        X = self.X[part]
        size, low = lengths(X), np.full(X.shape[1], -np.inf)
        low[len(low) - len(self.names) + 1 :] = 0.0
        bounds = low, np.full(X.shape[1], np.inf)
        found = lsq_linear(X / size, self.y[part], bounds, method="bvls")
        return np.asarray(found.x / size)

    def _at(self, name: str) -> int:
        """Index of a column."""
        return len(self.X.T) - len(self.names) + self.names.index(name)


def _gears(logs: Sequence[JointLog]) -> tuple[float, dict[str, float]]:
    """Turns of the link per turn of the motor, and `Torsion.geared`; zeros are fitted per log."""
    motor, link = (
        _moved([getattr(x, name) for x in logs]) for name in ("motor_position", "position")
    )
    shared = set.intersection(*(set(log.other_positions) for log in logs))
    others = {name: _moved([log.other_positions[name] for log in logs]) for name in sorted(shared)}
    names: tuple[str, ...] = ()
    known, left = _regressed([motor], link)
    while rest := [name for name in others if name not in names]:
        tried = {n: _regressed([motor, *(others[x] for x in (*names, n))], link) for n in rest}
        best = min(rest, key=lambda name: tried[name][1])
        # a gear to another joint leaves almost nothing of the twist; a torque is never so nearly
        # proportional to a position
        if tried[best][1] > 0.01 * left:
            break
        names, (known, left) = (*names, best), tried[best]
    return float(known[0]), {n: -float(x) for n, x in zip(names, known[1:], strict=True)}


def _moved(positions: Sequence[Array]) -> Array:
    """Each array without its mean, concatenated."""
    return np.concatenate([x - x.mean() for x in positions])


def _regressed(columns: Sequence[Array], y: Array) -> tuple[Array, float]:
    """Least-squares coefficients and the residual sum of squares."""
    X = np.column_stack(columns)
    found = np.linalg.lstsq(X, y, rcond=None)[0]
    return np.asarray(found), float(np.sum((y - X @ found) ** 2))


def _twist(log: JointLog, segment: Segment, ratio: float, geared: Mapping[str, float]) -> Array:
    """Twist on the kept samples, after the torque filter."""
    assert log.motor_position is not None
    time = log.time[0] + segment.signals[:, TIME]
    turned = log.position + sum(c * log.other_positions[name] for name, c in geared.items())
    return segment.balanced(np.interp(time, log.time, ratio * log.motor_position - turned))


def _element(prepared: Prepared, reach: float) -> Array:
    """Elastic-plastic element in the torque, 1 where it slides, shape (n, 1)."""
    rows = []
    for s in prepared.segments:
        torque = np.ascontiguousarray(s.signals[:, GEAR])
        rows.append(s.balanced(elastic_plastic(torque, np.array([reach * np.ptp(torque)]))))
    return np.concatenate(rows)


def _pruned(model: _Model) -> _Model:
    """The model without a gap or a lag that the logs do not support."""
    whole = _cost(model.without("torque").without("gap").without("lag"))
    for name in ("gap", "lag"):
        less = model.without(name)
        # a gap or a hysteresis must explain 2% of the variance
        if _cost(less) - _cost(model) < 0.02 * whole or model.estimate(name) is None:
            model = less
    return model


def _cost(model: _Model) -> float:
    return float(np.sum(model.residual**2))
