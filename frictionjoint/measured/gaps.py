"""Gaps in a log: the parts before and after become two logs."""

import itertools
from dataclasses import replace

import numpy as np

from frictionjoint.errors import LogError
from frictionjoint.measured.log import FEWEST_ROWS, LARGEST_GAP, JointLog


def split_at_gaps(log: JointLog) -> list[JointLog]:
    """The parts of a log between gaps, each with a note; the log itself if it has no gap. LogError
    if no part is long enough."""
    step = np.diff(log.time)
    at = np.flatnonzero(step > LARGEST_GAP * float(np.median(step))) + 1
    if not at.size:
        return [log]
    ends = [0, *(int(i) for i in at), len(log.time)]
    stretches = list(itertools.pairwise(ends))
    long = [(a, b) for a, b in stretches if b - a >= FEWEST_ROWS]
    where = f"{step[at[0] - 1]:.3g} s at {log.time[at[0]]:.6g} s"
    many = "" if at.size == 1 else f" and {at.size - 1} more"
    if not long:
        raise LogError(
            f"{log.name}: gaps ({where}{many}) leave no part of {FEWEST_ROWS} samples: record "
            "a log without gaps"
        )
    left_out = sum(b - a for a, b in stretches) - sum(b - a for a, b in long)
    note = f"{log.name}: a gap of {where}{many}: split there."
    if left_out:
        note += f" {left_out} samples in stretches under {FEWEST_ROWS} are left out."
    return [
        replace(log.part(slice(a, b), f" ({i + 1} of {len(long)})"), notes=(*log.notes, note))
        for i, (a, b) in enumerate(long)
    ]
