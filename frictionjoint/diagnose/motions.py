"""Motions to record next, within the range that the logs and the MJCF show."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from frictionjoint.arrays import Array
from frictionjoint.effects.signals import TEMP, A, Q, V
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared

# durations to try, s: each record, one of usual length at most, and one that warms the joint
DURATIONS = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)
_LONGEST, _WARMING = DURATIONS[3], DURATIONS[-1]
# s: of rests between moves, and of a start from rest
_RESTS, _EASE = (0.1, 1.0, 10.0), 1.0
# slow waves: s in which they grow tenfold, and the first one over the presliding displacement
_GROWTH, _FIRST = 20.0, 3.0


@dataclass(frozen=True)
class Limits:
    """Limits of a proposed motion."""

    low: float  # rad (m)
    high: float
    speed: float  # rad/s
    acceleration: float  # rad/s^2
    beyond: str = ""  # how they exceed the logs, as text; empty if they do not

    @property
    def reach(self) -> float:
        """Half the range."""
        return 0.5 * (self.high - self.low)


@dataclass(frozen=True)
class Motion:
    """A motion to record."""

    name: str  # description with figures
    dt: float  # s
    position: Array  # rad (m), shape (n,), from rest in the middle of the range
    once: float  # duration of one whole pass, s
    payload: float = 0.0  # fraction of the carried load to add
    temperature: float | None = None  # of the joint, deg C; None if no log contains it
    beyond: str = ""  # see `Limits`

    @property
    def duration(self) -> float:
        """s."""
        return self.dt * (len(self.position) - 1)

    @property
    def speed(self) -> float:
        """Largest, rad/s."""
        return float(np.abs(np.gradient(self.position, self.dt)).max())

    def part(self, duration: float) -> "Motion":
        """The first part of the motion."""
        return replace(self, position=self.position[: round(duration / self.dt) + 1])


def seen(prepared: Prepared, body: RigidBody) -> Limits:
    """Range, speed and acceleration of the logs, within the MJCF's range."""
    q, v, a = (np.concatenate([s.signals[:, k] for s in prepared.segments]) for k in (Q, V, A))
    low, high = _model_range(body)
    # single samples are noise
    speed, acceleration = (float(np.quantile(np.abs(x), 0.99)) for x in (v, a))
    return Limits(max(float(q.min()), low), min(float(q.max()), high), speed, acceleration)


def least_travel(prepared: Prepared) -> float:
    """Smallest travel that the position noise of the logs does not hide, rad (m)."""
    # six counts of an encoder
    return 20.0 * max(s.noise.resolution for s in prepared.segments)


def between(low: float, high: float, unit: str) -> str:
    """A range as text, to 1% of its width or finer."""
    decimals = max(0, 2 - math.floor(math.log10(high - low))) if high > low else 3
    # a rounded -0.001 is 0, not -0
    first, last = (f"{round(x, decimals) + 0.0:.{decimals}f}" for x in (low, high))
    return f"{first} to {last} {unit}"


def wider(limits: Limits, body: RigidBody) -> Limits:
    """The MJCF's range, else twice the logs'; twice the speed, four times the acceleration."""
    low, high = _model_range(body)
    if not np.isfinite(low):
        low, high = limits.low - limits.reach, limits.high + limits.reach
    unit = "m" if body.slide else "rad"
    # speeds are of all motions of the family: the record itself may need less
    return Limits(
        low,
        high,
        2.0 * limits.speed,
        4.0 * limits.acceleration,
        f"the logs went from {between(limits.low, limits.high, unit)} and up to "
        f"{limits.speed:.3g} {unit}/s, {limits.acceleration:.3g} {unit}/s^2",
    )


def _model_range(body: RigidBody) -> tuple[float, float]:
    if not body.model.jnt_limited[body.joint_id]:
        return -np.inf, np.inf
    low, high = body.model.jnt_range[body.joint_id]
    return float(low), float(high)


def family(limits: Limits, prepared: Prepared, presliding: float) -> Iterator[Motion]:
    """The motions to try, each with the longest allowed duration.

    Without motions that position noise hides or that take too long for one pass.

    Args:
        presliding: displacement over which friction builds up, rad (m); 0 for a law without
            presliding.
    """
    if min(limits.reach, limits.speed, limits.acceleration) <= 0.0:
        return
    least = least_travel(prepared)
    for motion in _any_motion(limits, prepared, presliding, least):
        if motion.once <= motion.duration and np.ptp(motion.position) > least:
            yield motion


def _any_motion(
    limits: Limits, prepared: Prepared, presliding: float, least: float
) -> Iterator[Motion]:
    """All motions, including impossible ones."""
    unit = "m" if prepared.slide else "rad"
    dt = sampling(limits, prepared) * kept_period(prepared)
    bandwidth = prepared.segments[0].bandwidth_hz
    temperatures = np.concatenate([s.signals[:, TEMP] for s in prepared.segments])
    known = float(np.ptp(temperatures)) > 0.0

    def motion(name: str, q: Array, once: float) -> Motion:
        usual = float(temperatures.mean()) if known else None
        return Motion(name, dt, q, once, temperature=usual, beyond=limits.beyond)

    t = np.arange(0.0, _LONGEST + 0.5 * dt, dt)
    natural = limits.speed / (2.0 * np.pi * limits.reach)
    top = _top(limits)
    for f in np.geomspace(0.25 * natural, min(top, 0.5 * bandwidth), 5):
        yield motion(f"a sine of {f:.2g} Hz", _sine(t, f, limits), _easing(f) + 1.0 / f)
    # half of the way, the joint has the speed that the motion is named by, for half a second
    top_speed = min(
        limits.speed, math.sqrt(0.5 * limits.reach * limits.acceleration), limits.reach / 0.5
    )
    speeds = [part * top_speed for part in (1.0, 0.3, 0.05)]
    for speed in speeds:
        name = f"in both directions at a constant {speed:.2g} {unit}/s"
        yield motion(name, _sweeps(t, [speed], limits), 4.0 * limits.reach / speed)
    slow = motion(
        f"in both directions at {', '.join(f'{x:.2g}' for x in speeds)} {unit}/s in turn",
        _sweeps(t, speeds, limits),
        sum(4.0 * limits.reach / x for x in speeds),
    )
    yield slow
    rests = ", ".join(f"{x:g}" for x in _RESTS)
    name = f"moves with rests of {rests} s in turn between them"
    yield motion(name, _moves(t, limits), 2.0 * sum(_RESTS))
    highest = min(top, bandwidth / 3.0)
    fast = motion(
        f"a multisine up to {highest:.2g} Hz", _multisine(t, highest, limits), 10.0 / highest
    )
    yield fast
    # the first wave must show, or what happens before sliding does not
    if presliding > 0.0 and 2.0 * _FIRST * presliding > least:
        name = "slow reversals that grow from presliding to sliding"
        yield motion(name, _reversals(t, presliding, limits), _GROWTH)
    for payload in (0.5, 1.0):
        yield replace(slow, payload=payload)
        yield replace(fast, payload=payload)
    full = f"a sine of {natural:.2g} Hz"
    if known:
        for word, x in (("cold", temperatures.min()), ("warm", temperatures.max())):
            name = f"{full}, the joint {word} from the start ({x:.3g} deg C)"
            sine = motion(name, _sine(t, natural, limits), _easing(natural) + 1.0 / natural)
            yield replace(sine, temperature=float(x))
    long = np.arange(0.0, _WARMING + 0.5 * dt, dt)
    yield motion(f"{full}, kept up to warm the joint", _sine(long, natural, limits), _LONGEST)


def kept_period(prepared: Prepared) -> float:
    """Time between the samples that a fit keeps, s."""
    return min(s.dt * s.step for s in prepared.segments)


def sampling(limits: Limits, prepared: Prepared) -> int:
    """Decimation of the kept samples that suffices for these motions."""
    # s; twelve samples in the shortest period
    enough = min(0.02, 1.0 / (12.0 * _top(limits)))
    return max(1, int(enough / kept_period(prepared)))


def _top(limits: Limits) -> float:
    """Highest frequency to try, Hz: twice the one at which speed and acceleration limit."""
    return max(limits.acceleration / limits.speed, limits.speed / limits.reach) / np.pi


def _easing(f: float) -> float:
    """Time, s, over which a sine of f Hz fades in without exceeding its later speed."""
    return max(_EASE, 1.0 / f)


def _eased(t: Array, over: float = _EASE) -> Array:
    """From 0 to 1 in a given time, with zero speed and acceleration at both ends."""
    s = np.clip(t / over, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


def _middle(limits: Limits) -> float:
    return 0.5 * (limits.low + limits.high)


def _sine(t: Array, f: float, limits: Limits) -> Array:
    w = 2.0 * np.pi * f
    return np.asarray(_middle(limits) + _most(limits, w) * np.sin(w * t) * _eased(t, _easing(f)))


def _most(limits: Limits, w: float) -> float:
    """Largest amplitude of a sine of w rad/s."""
    return min(limits.reach, limits.speed / w, limits.acceleration / w**2)


def _through(t: Array, corners: list[float], times: list[float], smooth: float) -> Array:
    """Straight lines through corners; the speed changes over `smooth` seconds."""
    q = np.interp(t, times, corners)
    size = max(1, round(smooth / float(t[1] - t[0])))
    return np.asarray(uniform_filter1d(q, size, mode="nearest"))


def _sweeps(t: Array, speeds: list[float], limits: Limits) -> Array:
    """Sweeps over the whole range and back, one per speed."""
    corners, times = [_middle(limits)], [_EASE]
    ends = itertools.cycle((limits.high, limits.low))
    for speed in itertools.cycle(speeds):
        for to in (next(ends), next(ends)):
            times.append(times[-1] + abs(to - corners[-1]) / speed)
            corners.append(to)
        if times[-1] > t[-1]:
            break
    return _through(t, corners, times, 2.0 * max(speeds) / limits.acceleration)


def _moves(t: Array, limits: Limits) -> Array:
    """Between two points half the range apart, with rests in between."""
    corners, times = [_middle(limits)], [_EASE]
    for k, rest in enumerate(itertools.cycle(_RESTS)):
        to = _middle(limits) + (0.5 if k % 2 else -0.5) * limits.reach
        moving = abs(to - corners[-1]) / limits.speed
        corners += [to, to]
        times += [times[-1] + moving, times[-1] + moving + rest]
        if times[-1] > t[-1]:
            break
    return _through(t, corners, times, limits.speed / limits.acceleration)


def _multisine(t: Array, highest: float, limits: Limits) -> Array:
    f = np.geomspace(0.1 * highest, highest, 12)
    phase = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, len(f))
    q = (np.sin(2.0 * np.pi * np.outer(t, f) + phase) / f) @ np.ones(len(f)) * _eased(t)
    dt = float(t[1] - t[0])
    v = np.gradient(q, dt)
    ends = (limits.reach, limits.speed, limits.acceleration)
    scale = min(x / np.abs(y).max() for x, y in zip(ends, (q, v, np.gradient(v, dt)), strict=True))
    return np.asarray(_middle(limits) + scale * q)


def _reversals(t: Array, presliding: float, limits: Limits) -> Array:
    """Slow waves with amplitudes from 3 to 30 times the presliding displacement."""
    w = 2.0 * np.pi * 0.25
    growth = _FIRST * 10.0 ** (t % _GROWTH / _GROWTH)
    amplitude = np.minimum(growth * presliding, _most(limits, w))
    return np.asarray(_middle(limits) + amplitude * np.sin(w * t))
