"""Repairs of a log that need no guess, each with a note."""

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError
from frictionjoint.measured.columns import MEASURED_DRIVES, POSITIONS, TARGET_OF, VELOCITIES
from frictionjoint.measured.log import LARGEST_GAP, are_gaps

# Ranges that encoders and motor drives wrap at, rad: turns, and the +-12.5 rad of common drives.
_RANGES = (2 * np.pi, 4 * np.pi, 8 * np.pi, 25.0)
_MEASURED = ("position_rad", "motor_position_rad")
_CANNOT_LEAP = (*POSITIONS, "temperature_c")
_HELD = (*POSITIONS, *MEASURED_DRIVES)


def with_one_clock(time: Array) -> tuple[Array, tuple[str, ...]]:
    """Times on one clock with gaps, and a note, where a recorder has restarted its clock near the
    first time with each run. A smaller step back means that rows were swapped: it is left to the
    checks of the log."""
    if len(time) < 2 or not np.isfinite(time).all():
        return time, ()
    back = np.flatnonzero(np.diff(time) < 0.0) + 1
    # a run goes on from where it begins; one wrong time does not
    own = [i for i in back if i + 1 < len(time) and time[i + 1] < time[i - 1]]
    # a clock that starts again falls back to less than a tenth of its run, of 50 rows
    starts = [i for i in own if time[i] - time[0] < 0.1 * (time[i - 1] - time[0])]
    if not starts or len(starts) < len(back) or len(time) < 50 * (len(starts) + 1):
        return time, ()
    gap = 10.0 * LARGEST_GAP * float(np.median(np.abs(np.diff(time))))
    found = time.copy()
    for i in starts:
        found[i:] += found[i - 1] + gap - found[i]
    return found, (f"the clock starts again: read as {len(starts) + 1} runs.",)


def with_position(columns: Mapping[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The columns with a position, integrated from the velocity where a log has none, and a note.
    It begins at 0 and drifts with an offset of the velocity, which must be sampled fast enough."""
    found, notes = dict(columns), []
    for speed, position in zip(VELOCITIES, POSITIONS, strict=True):
        if speed in found and not found.keys() & POSITIONS:
            x = found[speed]
            steps = 0.5 * (x[1:] + x[:-1]) * np.diff(found["time_s"])
            found[position] = np.concatenate([[0.0], np.cumsum(steps)])
            notes.append(
                "the log has no position: it was integrated from the velocity, starting at 0. What "
                "depends on the position itself cannot be trusted."
            )
    return found, tuple(notes)


def without_lone_readings(columns: Mapping[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The columns with corrupt readings of position and temperature interpolated, and notes: a bus
    that loses a byte returns a distant position for one sample; no joint moves there and back."""
    found, notes = dict(columns), []
    for name, x in columns.items():
        if name.rpartition(".")[2] in _CANNOT_LEAP and len(lone := lone_readings(x)):
            found[name] = interpolated(x, lone)
            notes.append(f"{_outliers(name, x, lone)}: interpolated.")
    return found, tuple(notes)


def interpolated(x: Array, lone: NDArray[np.intp]) -> Array:
    """A signal with the mean of both neighbours in place of single readings."""
    found = x.copy()
    found[lone] = 0.5 * (x[lone - 1] + x[lone + 1])
    return found


def lone_readings(x: Array) -> NDArray[np.intp]:
    """Indices of single readings far from both neighbours, which agree."""
    if len(x) < 3:
        return np.zeros(0, dtype=np.intp)
    off = np.abs(x[1:-1] - 0.5 * (x[:-2] + x[2:]))
    usual = float(np.quantile(np.abs(np.diff(x)), 0.99))
    travel = float(np.ptp(np.quantile(x, (0.01, 0.99))))
    # away and back over 30% of the travel of the others, and eight times as far as they move
    least = max(0.3 * travel, 8.0 * usual)
    lone = (off > least) & (np.abs(x[2:] - x[:-2]) < 0.1 * off) & (least > 0.0)
    # what one sample in a hundred does is a motion
    return np.flatnonzero(lone) + 1 if lone.sum() <= 0.01 * len(x) else np.zeros(0, dtype=np.intp)


def _outliers(name: str, x: Array, lone: NDArray[np.intp]) -> str:
    many = "1 outlier" if len(lone) == 1 else f"{len(lone)} outliers"
    return f"{name}: {many} (first in sample {lone[0] + 1}: {x[lone[0]]:.4g})"


def silent_runs(time: Array, position: Array, drive: Array) -> list[tuple[int, int]]:
    """Start and end of each interval in which a joint moves without a drive, which is off where it
    is exactly zero for long; all arrays of shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], drive == 0.0, [0]]).astype(int)))
    # half a second of exactly zero: the drive is off
    return [
        (int(a), int(b))
        for a, b in zip(edges[::2], edges[1::2], strict=True)
        if time[b - 1] - time[a] > 0.5 and _moves(position[a:b])
    ]


def _moves(position: Array) -> bool:
    """Whether a position moves further than its reading jitters between samples."""
    if len(position) < 3:
        return False
    jitter = float(np.sqrt(np.mean(np.diff(position, 2) ** 2) / 6.0))
    # five times the deviation of the reading noise
    return float(np.std(position - position[0])) > 5.0 * jitter


def drive_notes(columns: Mapping[str, Array]) -> tuple[str, ...]:
    """Notes on drives that are exactly zero for long while the joint moves, or leap for one sample,
    which is not repaired because a drive may leap; the columns include a position."""
    position = next(x for name, x in columns.items() if name in POSITIONS)
    time, notes = columns["time_s"], []
    for name, x in columns.items():
        if name not in MEASURED_DRIVES:
            continue
        if len(lone := lone_readings(x)):
            notes.append(
                f"{_outliers(name, x, lone)}: if they are wrong readings, leave these rows out."
            )
        runs = silent_runs(time, position, x)
        if runs:
            share = sum(b - a for a, b in runs) / len(x)
            first, last = time[runs[0][0]], time[runs[0][1] - 1]
            notes.append(
                f"{name}: exactly 0 in {share:.0%} of the log while the joint moves (first from "
                f"{first:.4g} to {last:.4g} s): the drive is off, or another one turns the joint."
            )
    return tuple(notes)


def unwrapped(
    source: str, columns: Mapping[str, Array], wrap: float | None
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The columns with positions unwrapped at a range, rad (m), or at the usual ranges, and a note
    on each change; LogError: a position jumps by another range, or the range is not positive."""
    if wrap is not None and not (np.isfinite(wrap) and wrap > 0.0):
        raise LogError(f"--wrap {wrap:g}: give the range that the position wraps at, above 0")
    found, notes = dict(columns), []
    for name, x in columns.items():
        prefix, dot, unit = name.rpartition(".")
        if unit not in _MEASURED and not (wrap and unit in TARGET_OF):
            continue
        period = wrap or _range_of(source, name, x, columns["time_s"])
        if period is None:
            continue
        whole = np.unwrap(x, period=period)
        leaps = int(np.count_nonzero(np.diff(np.round(whole - x, 3))))
        if not leaps:
            continue
        found[name] = whole
        target = f"{prefix}{dot}{TARGET_OF.get(unit, '')}"
        if target in columns:  # it steps by itself: what it stands for is near the position
            y = columns[target]
            found[target] = y + period * np.round((whole - y) / period)
        places = "place" if leaps == 1 else "places"
        notes.append(f"{name} wrapped at {period:.4g} in {leaps} {places}: unwrapped.")
    return found, tuple(notes)


def _range_of(source: str, name: str, x: Array, time: Array) -> float | None:
    """Range by which a position jumps; None if it does not jump."""
    step = np.diff(x)
    size = np.abs(step)
    # a leap goes over 80% of all travel in one sample, four times as far as any other
    leap = (size > 0.8 * float(np.ptp(x))) & ~are_gaps(time)
    rest = float(size[~leap].max(initial=0.0))
    # a position that stands but for a count leaps by no more than its other steps
    leap &= size > 4.0 * rest
    if not leap.any() or rest == 0.0:
        return None
    at = np.flatnonzero(leap)
    # the joint went on meanwhile, as it did one sample before
    before = np.where(at > 0, step[at - 1], 0.0)
    before[np.isin(at - 1, at)] = 0.0
    distance = np.abs(step[at] - before)
    typical = float(np.median(distance))
    period = min(_RANGES, key=lambda p: abs(p - typical))
    # 0.02: how near to a range a leap must be
    if np.all(np.abs(distance - period) < 0.02 * period + 2.0 * rest):
        return period
    i = int(at[0])
    leaps = f"from {x[i]:.4g} to {x[i + 1]:.4g} in one sample at {time[i + 1]:.6g} s"
    fix = "repair it, or give the range it wraps at, --wrap RANGE"
    raise LogError(f"{source}, {name}: jumps {leaps}: {fix}")


def without_repeats(columns: Mapping[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """One row per measurement if the recorder wrote faster than it measured: repeated rows would
    turn the motion into steps and pretend more samples than there are."""
    n = len(columns["time_s"])
    changes = np.zeros(n - 1, dtype=bool)
    for name in columns.keys() & _HELD:
        changes |= np.diff(columns[name]) != 0.0
    at = np.flatnonzero(changes) + 1
    runs = np.diff(at)
    k = int(np.median(runs)) if len(at) > 2 else 1
    off = np.abs(runs - k * np.maximum(1, np.round(runs / k)))
    # 95% of the runs must be of one length; that of a long run may be off by one
    if k < 2 or np.mean(off <= (1 if k >= 5 else 0)) < 0.95:
        return dict(columns), ()
    # at rest nothing changes: there one row in k stays
    ends = np.concatenate([[0], at, [n]])
    kept = np.concatenate(
        [np.arange(a, max(b - k // 2, a + 1), k) for a, b in itertools.pairwise(ends)]
    )
    note = f"every row is repeated {k} times: {len(kept)} of {n} rows are used."
    return {name: x[kept] for name, x in columns.items()}, (note,)
