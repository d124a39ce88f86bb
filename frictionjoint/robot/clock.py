"""Blocks of time common to all joints, and the kinds of motion they belong to.

Joints of a robot are logged together, so their residuals are not independent: a block is a stretch
of time of all joints. Logs in which a joint stands still are not among that joint's logs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.signals import TIME, A, Q, V
from frictionjoint.identify.blocks import (
    CORRELATION_TIMES,
    FEWEST_BLOCKS,
    LOGS,
    Blocks,
    correlation_time,
    kinds_of,
)
from frictionjoint.robot.joint import FittedJoint
from frictionjoint.robot.logs import Place, by_place


@dataclass(frozen=True)
class Clock:
    """Blocks of all logs in order.

    Attributes:
        number: of each log, by its index among the logs of a joint, see `by_place`.
        length: duration of each log's blocks, s, shape (logs,). first: number of its first block.
        fold, log: of each block, shape (B,).
        alike: correlation time of the residuals in samples.
    """

    number: Mapping[Place, int]
    length: Array
    first: Index
    fold: Index
    log: Index
    alike: float

    @property
    def count(self) -> int:
        return len(self.log)

    def blocks(self, joint: FittedJoint) -> Blocks:
        return Blocks(
            self.of_sample(joint), self.fold, self.log, self.log, np.zeros(self.log.max() + 1)
        )

    def of_sample(self, joint: FittedJoint) -> Index:
        """Block number of each kept sample of a joint's logs, shape (n,)."""
        found, ends = [], np.append(self.first[1:], self.count)
        for place, s in by_place(joint.prepared.segments).items():
            i = self.number[place]
            block = (s.at_kept(s.signals[:, TIME]) / self.length[i]).astype(np.int64)
            found.append(np.minimum(self.first[i] + block, ends[i] - 1))
        return np.concatenate(found)


def clock(joints: Sequence[FittedJoint]) -> Clock:
    """Blocks several correlation times long, as long as enough of them remain."""
    found: dict[Place, float] = {}
    for joint in joints:
        for place, s in by_place(joint.prepared.segments).items():
            found.setdefault(place, float(np.ptp(s.signals[:, TIME])))
    number = {place: i for i, place in enumerate(found)}
    spans = np.array(list(found.values()))
    total = float(spans.sum())
    alike = [_correlation(joint) for joint in joints]
    longest = float(np.median([seconds for seconds, _ in alike]))
    # 120 blocks at most
    length = float(np.clip(CORRELATION_TIMES * longest, total / 120, total / FEWEST_BLOCKS))
    counts = np.maximum(2, np.round(spans / length)).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    log = np.repeat(np.arange(len(spans)), counts)
    samples = float(np.median([n for _, n in alike]))
    made = Clock(number, spans / counts, first, log, log, samples)
    return made if len(spans) >= LOGS else replace(made, fold=_kinds(joints, made))


def _correlation(joint: FittedJoint) -> tuple[float, float]:
    """Longest correlation time of the joints' residuals: s and samples."""
    e = joint.fit.residual * joint.fit.weight
    found = []
    for i, s in enumerate(joint.prepared.segments):
        samples = correlation_time(e[joint.fit.log_index == i])
        found.append((samples * s.dt * s.step, samples))
    return max(found)


def _kinds(joints: Sequence[FittedJoint], blocks: Clock) -> Index:
    """Kind of motion of each block: speed, acceleration, position and direction of all joints."""
    rows = []
    for joint in joints:
        of_sample = blocks.of_sample(joint)
        q, v, a = (joint.prepared.at_kept(k) for k in (Q, V, A))
        size = np.maximum(np.bincount(of_sample, minlength=blocks.count), 1)
        for x in (v**2, a**2, q, np.sign(v)):
            rows.append(np.bincount(of_sample, x, blocks.count) / size)
    return kinds_of(np.column_stack(rows))
