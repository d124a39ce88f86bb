"""Blocks of time common to all joints, and the kinds of motion they belong to.

Joints of a robot are logged together, so their residuals are not independent: a block is a stretch
of time of all joints. Logs in which a joint stands still are not among that joint's logs.
"""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Index
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


class Clock:
    """Blocks of all logs in order, several correlation times long, as long as enough remain.

    Attributes:
        number: of each log, by its index among the logs of a joint, see `by_place`.
        length: duration of each log's blocks, s, shape (logs,). first: number of its first block.
        fold, log: of each block, shape (B,).
        alike: correlation time of the residuals in samples.
    """

    def __init__(self, joints: Sequence[FittedJoint]) -> None:
        found: dict[Place, float] = {}
        for joint in joints:
            for place, s in by_place(joint.prepared.segments).items():
                found.setdefault(place, float(np.ptp(s.signals[:, TIME])))
        self.number = {place: i for i, place in enumerate(found)}
        spans = np.array(list(found.values()))
        total = float(spans.sum())
        alike = [_correlation(joint) for joint in joints]
        longest = float(np.median([seconds for seconds, _ in alike]))
        # 120 blocks at most
        length = float(np.clip(CORRELATION_TIMES * longest, total / 120, total / FEWEST_BLOCKS))
        counts = np.maximum(2, np.round(spans / length)).astype(np.int64)
        self.length = spans / counts
        self.first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self.log = np.repeat(np.arange(len(spans)), counts)
        self.alike = float(np.median([n for _, n in alike]))
        self.fold = self.log if len(spans) >= LOGS else self._kinds(joints)

    @property
    def count(self) -> int:
        return len(self.log)

    def blocks(self, joint: FittedJoint) -> Blocks:
        return Blocks(self.of_sample(joint), self.fold, self.log, self.log)

    def of_sample(self, joint: FittedJoint) -> Index:
        """Block number of each kept sample of a joint's logs, shape (n,)."""
        found, ends = [], np.append(self.first[1:], self.count)
        for place, s in by_place(joint.prepared.segments).items():
            i = self.number[place]
            block = (s.at_kept(s.signals[:, TIME]) / self.length[i]).astype(np.int64)
            found.append(np.minimum(self.first[i] + block, ends[i] - 1))
        return np.concatenate(found)

    def _kinds(self, joints: Sequence[FittedJoint]) -> Index:
        """Kind of motion of each block: speed, acceleration, position, direction of all joints."""
        rows = []
        for joint in joints:
            of_sample = self.of_sample(joint)
            q, v, a = (joint.prepared.at_kept(k) for k in (Q, V, A))
            size = np.maximum(np.bincount(of_sample, minlength=self.count), 1)
            for x in (v**2, a**2, q, np.sign(v)):
                rows.append(np.bincount(of_sample, x, self.count) / size)
        return kinds_of(np.column_stack(rows))


def _correlation(joint: FittedJoint) -> tuple[float, float]:
    """Longest correlation time of the joints' residuals: s and samples."""
    e = joint.fit.residual * joint.fit.weight
    logs = enumerate(joint.prepared.segments)
    each = ((correlation_time(e[joint.fit.log_index == i]), s) for i, s in logs)
    return max((samples * s.dt * s.step, samples) for samples, s in each)
