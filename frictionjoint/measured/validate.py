"""Checks of a log; each error is one line with file, row, column and remedy."""

from collections.abc import Callable, Mapping

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError, NoMotionError
from frictionjoint.measured.columns import MEASURED_DRIVES, POSITIONS, TARGET_OF, VELOCITIES
from frictionjoint.measured.log import FEWEST_ROWS, are_gaps
from frictionjoint.measured.units import TIME

# Row number of sample i in the file, as an editor counts it. Called only for an error.
RowOf = Callable[[int], int]

# Friction happens between 1 us and 0.15 s: outside, time is in another unit.
_STEP_S = (1e-6, 0.15)
# Beyond these a unit is wrong rather than a joint extreme.
_LARGEST = {
    "position_rad": (1e5, "radians (degrees, counts?)"),
    "target_rad": (1e5, "radians (degrees, counts?)"),
    "position_m": (20.0, "metres (millimetres?)"),
    "target_m": (20.0, "metres (millimetres?)"),
    "velocity_rad_s": (1e4, "rad/s (rpm, degrees per second?)"),
    "velocity_m_s": (100.0, "m/s (mm/s?)"),
    "torque_nm": (1e6, "newton metres (newton millimetres?)"),
    "force_n": (1e7, "newtons"),
    "voltage_v": (2e3, "volts (millivolts?)"),
    "current_a": (2e3, "amperes (milliamperes?)"),
    "supply_v": (2e3, "volts (millivolts?)"),
    "temperature_c": (200.0, "degrees Celsius (kelvin?)"),
}
_SPEED_OF = dict(zip(POSITIONS, VELOCITIES, strict=True))
# Ratio to a target in degrees or millimetres, and a travel that is long only in these:
# wrong units, where the joint follows it so well. A joint held by friction follows a short one.
_MISTAKEN_UNIT = {"position_rad": (np.pi / 180, np.pi), "position_m": (1e-3, 1.0)}
# rad: a hinge that turns farther in one log may be in degrees
FAR = 20.0
# With fewer different readings a joint stands, on the edge of a count, or its encoder is too coarse
# for any velocity.
_FEWEST_READINGS = 20
# rad/s^2 (m/s^2): no joint accelerates faster
_HARDEST = 1e4
# jumps of one position that may come from its encoder; more of them are a motion
_MOST_JUMPS = 18
# No log measures these in a joint that moves, if they never change.
_MUST_CHANGE = (*VELOCITIES, *MEASURED_DRIVES)


def check_rows(source: str, columns: Mapping[str, Array], row: RowOf) -> None:
    """Raise LogError unless columns, of shape (n,), are numbers along increasing ``time_s``."""
    check_lengths(source, columns)
    for name, x in columns.items():
        check_finite(source, name, x, row)
    check_time(source, columns["time_s"], row)


def check_columns(source: str, columns: Mapping[str, Array], row: RowOf) -> None:
    """Raise LogError if columns, see `check_rows`, positions unwrapped, cannot be right."""
    with np.errstate(over="ignore", invalid="ignore"):
        for name, x in columns.items():
            _check_magnitude(source, name, x, row)
            _check_fractions(source, name, x)
        for name in columns:
            prefix, dot, unit = name.rpartition(".")
            for check, names in ((_check_speed, _SPEED_OF), (_check_target, TARGET_OF)):
                other = f"{prefix}{dot}{names.get(unit)}"
                if other in columns:
                    check(source, name, other, columns)


def check_lengths(source: str, columns: Mapping[str, Array]) -> None:
    """Raise LogError for columns of different length, or too few rows."""
    n = len(columns["time_s"])
    for name, x in columns.items():
        if x.ndim != 1 or len(x) != n:
            size = " x ".join(str(k) for k in x.shape)
            raise LogError(f"{source}, {name}: {size} numbers, time_s has {n}: give one per row")
    if n < FEWEST_ROWS:
        fix = "record a longer log"
        raise LogError(f"{source}: {n} samples, at least {FEWEST_ROWS} are needed: {fix}")


def check_finite(source: str, name: str, x: Array, row: RowOf) -> None:
    """Raise LogError for an empty cell, NaN or infinity."""
    finite = np.isfinite(x)
    if not finite.all():
        i = int(np.argmin(finite))
        what = "empty or NaN" if np.isnan(x[i]) else f"{x[i]}"
        fix = "repair that row or leave it out (--drop-nan leaves out all such rows)"
        raise LogError(f"{source}, row {row(i)}, {name}: {what}, {fix}")


def check_time(source: str, time: Array, row: RowOf) -> None:
    """Raise LogError for time that stands still, runs backwards or is not in seconds."""
    step = np.diff(time)
    if step.min() <= 0:
        i = int(np.argmax(step <= 0)) + 1
        what = f"{float(time[i])} after {float(time[i - 1])}, time must increase"
        several = ", or give each joint its own columns" if np.mean(step <= 0) > 0.3 else ""
        fix = f"sort the rows or remove repeats{several}"
        raise LogError(f"{source}, row {row(i)}, time_s: {what}: {fix}")
    median = float(np.median(step))
    if not _STEP_S[0] <= median <= _STEP_S[1]:
        units = ((name, factor * median) for name, factor in TIME.items())
        likely = next((x for x, step in units if 1e-4 <= step <= 0.1), "ms (us, ns)")
        kind = "slow for friction" if median > _STEP_S[1] else "fast for a joint"
        fix = f"give seconds, or the unit of the log, --unit time={likely}"
        raise LogError(f"{source}, time_s: {median:g} s between samples is too {kind}: {fix}")


def check_moves(source: str, columns: Mapping[str, Array]) -> None:
    """Raise LogError if a log's joint does not move (NoMotionError) or its drive is constant."""
    for name, x in columns.items():
        unit = name.rpartition(".")[2]
        if unit in _SPEED_OF and x.min() == x.max():
            what = "the joint does not move: check the column or record a motion"
            raise NoMotionError(f"{source}, {name}: constant at {x[0]:g}, {what}")
        if unit in _MUST_CHANGE and x.min() == x.max():
            what = "so probably not recorded: leave it out or check the column"
            raise LogError(f"{source}, {name}: constant at {x[0]:g}, {what}")


def require_motion(source: str, position: Array) -> None:
    """Raise NoMotionError if a position, shape (n,), has too few readings for a velocity."""
    n = len(np.unique(position))
    if n < _FEWEST_READINGS:
        what = f"only {n} different positions, the joint stands still and its encoder flickers"
        raise NoMotionError(f"{source}: {what}: record a motion, or use a finer encoder")


def check_leaps(source: str, columns: Mapping[str, Array]) -> None:
    """Raise LogError if a position, without repeated rows, jumps, or much of its travel does."""
    time = columns["time_s"]
    for name, x in columns.items():
        if name.rpartition(".")[2] not in _SPEED_OF:
            continue
        # distance from each sample to the next one; over a gap it says nothing
        step = np.abs(np.diff(x)) * ~are_gaps(time)
        i = _lone_jump(time, step)
        if i is not None:
            raise LogError(
                f"{source}, {name}: jumps by {x[i + 1] - x[i]:.3g} within a sample at {time[i]:g} "
                "s, as no joint moves: the encoder was set anew, or lost counts. Cut the log there "
                "in two, or take the jump out of the positions after it"
            )
        leapt = _travel_leapt(step)
        # logs of servos at 50 Hz leap over up to 3%; where a bus loses messages it is most of it
        if leapt > 0.25:
            raise LogError(
                f"{source}, {name}: {leapt:.0%} of the travel lies in jumps between repeated "
                "readings: the joint moves on while they repeat (lost messages?), or rows of "
                "several joints alternate: record each reading once, with its own time_s, and one "
                "joint per file or column"
            )


def _lone_jump(time: Array, step: Array) -> int | None:
    """Sample before the largest of a few jumps that no inertia allows, or None."""
    i = int(np.argmax(step))
    # of 291 signals without a jump, the largest step was at most 1.5 times the second largest
    largest = np.sort(step)[-_MOST_JUMPS - 1 :]
    alone = np.any(largest[1:] > 10.0 * largest[:-1]) and largest[0] > 0.0
    return i if alone and step[i] > _HARDEST * (time[i + 1] - time[i]) ** 2 else None


def _travel_leapt(step: Array) -> float:
    """Fraction of travel in single samples with almost no motion around them."""
    moved = step[step > 0.0]
    if not len(moved):
        return 0.0
    neighbouring = np.maximum(step[:-2], step[2:])
    count = float(np.quantile(moved, 0.01))
    here = step[1:-1]
    # A reading held while the joint went on is a leap over more than four counts, four times as far
    # as the neighbouring steps; no inertia allows one. Fewer than ten may be anything.
    leaps = (here > 4.0 * neighbouring) & (here > 4.5 * count)
    if np.count_nonzero(leaps) < 10:
        return 0.0
    return float(here[leaps].sum() / step.sum())


def _check_magnitude(source: str, name: str, x: Array, row: RowOf) -> None:
    largest, fix = _LARGEST.get(name.rpartition(".")[2], (np.inf, ""))
    i = max(int(np.argmax(x)), int(np.argmin(x)), key=lambda k: abs(x[k]))
    size = abs(float(x[i]))
    if size > largest:
        raise LogError(f"{source}, row {row(i)}, {name}: {x[i]:g} is too large: give {fix}")


def _check_fractions(source: str, name: str, x: Array) -> None:
    """Raise if positions are whole numbers, counts or degrees: no encoder steps by a radian."""
    if name.rpartition(".")[2] not in _SPEED_OF or np.any(x != np.round(x)):
        return
    n = len(np.unique(x))
    if n >= _FEWEST_READINGS:
        fix = f"give {'radians' if name.endswith('rad') else 'metres'}"
        what = f"all of its {n} readings are whole numbers"
        raise LogError(f"{source}, {name}: {what}: {fix} (degrees, counts, millimetres?)")


def _check_speed(source: str, name: str, speed_name: str, columns: Mapping[str, Array]) -> None:
    """Compare with a measured velocity: it reveals a wrong unit of position or time."""
    time, position, speed = (columns[x] for x in ("time_s", name, speed_name))
    # sums of speed^2, slope * speed and slope^2, in blocks so that long logs need no copies
    sums, block = np.zeros(3), 1 << 16
    for start in range(0, len(time) - 1, block):
        part = slice(start, start + block + 1)
        rate = np.diff(position[part]) / np.diff(time[part])
        v = 0.5 * (speed[part][1:] + speed[part][:-1])
        sums += (v @ v, rate @ v, rate @ rate)
    power, cross, slope = sums.tolist()
    # Where the two barely correlate the joint barely moves, and units cannot be inferred.
    sure = cross * cross > 0.25 * power * slope
    if sure and not 0.5 < cross / power < 2.0:
        what = f"{name} changes {cross / power:.3g} times as fast as {speed_name} states"
        raise LogError(f"{source}: {what}: check the units and signs of the two, and of time_s")


def _check_target(source: str, name: str, target_name: str, columns: Mapping[str, Array]) -> None:
    """Compare the units of target and position: a joint may stick, but does not run far beyond its
    target. If it moves less, only the exact factor of degrees or millimetres counts as a wrong
    unit, and only for a target with much motion."""
    # the standard deviation of what is constant is its rounding, as of a step before the log
    if min(float(np.ptp(columns[c])) for c in (name, target_name)) == 0.0:
        return
    ratio = float(np.std(columns[name]) / np.std(columns[target_name]))
    follows = float(np.corrcoef(columns[name], columns[target_name])[0, 1]) > 0.95
    factor, far = _MISTAKEN_UNIT[name.rpartition(".")[2]]
    long = float(np.ptp(columns[target_name])) > far
    mistaken = follows and long and abs(ratio / factor - 1.0) < 0.2
    # a joint does not run 20 times as far as its target
    if ratio > 20.0 or mistaken:
        what = f"{name} moves {ratio:.3g} times as far as {target_name}"
        raise LogError(f"{source}: {what}: check the units of the two")
