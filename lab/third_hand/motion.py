"""Reference motions in five styles, within limits of reach, speed and acceleration."""

from dataclasses import dataclass

import numpy as np

STYLES = ("multisine", "point-to-point", "triangle", "chirp", "staircase")
RESTING = ("point-to-point", "staircase")
SHAKING = ("multisine", "chirp")


@dataclass(frozen=True)
class Limits:
    """Of the reference: rad, rad/s, rad/s^2, Hz."""

    reach: float
    speed: float
    acceleration: float
    frequency: float


def reference(rng: np.random.Generator, style: str, seconds: float, rate: float, limits: Limits):
    """Position, velocity and acceleration at each tick, shape (ticks, 3)."""
    t = np.arange(int((seconds + 0.5) * rate)) / rate  # its end, where it stops, is not reached
    make = dict(zip(STYLES, (multisine, point_to_point, triangle, chirp, staircase), strict=True))
    q = make[style](rng, t, limits)
    v = np.gradient(q, t)
    return np.ascontiguousarray(np.c_[q, v, np.gradient(v, t)])


def multisine(rng, t, limits):
    n = rng.integers(6, 11)
    f = np.geomspace(0.1, limits.frequency, n) * rng.uniform(0.9, 1.1, n)
    size = rng.uniform(0.5, 1.0, n) * f ** -rng.uniform(1.0, 1.4)
    phase = rng.uniform(0, 2 * np.pi, n)
    q = np.sin(2 * np.pi * np.outer(t, f) + phase) @ size
    q = q * from_rest(t)
    v = np.gradient(q, t)
    most = [abs(q).max() / limits.reach, abs(v).max() / limits.speed]
    most.append(abs(np.gradient(v, t)).max() / limits.acceleration)
    return q / max(most)


def chirp(rng, t, limits):
    low, end = rng.uniform(0.08, 0.2), t[-1]
    f = low * (limits.frequency / low) ** (t / end)
    w = 2 * np.pi * f
    size = np.array([np.full_like(w, limits.reach), limits.speed / w, limits.acceleration / w**2])
    size = (size**-4.0).sum(axis=0) ** -0.25  # the smallest of the three, smoothly
    phase = 2 * np.pi * np.cumsum(f) * (t[1] - t[0])
    return 0.9 * size * np.sin(phase) * from_rest(t)


def triangle(rng, t, limits):
    n = rng.integers(3, 6)
    speeds = limits.speed * np.geomspace(0.03, 0.9, n) * rng.uniform(0.8, 1.1, n)
    when, where, sign = [0.0], [0.0], 1.0
    for k, speed in enumerate(rng.permutation(speeds)):
        end = t[-1] * (k + 1) / n
        # the slow ones turn nearer, about where they begin
        reach = min(limits.reach * rng.uniform(0.4, 1.0), speed * (end - when[-1]) / 3)
        centre = np.clip(where[-1], reach - limits.reach, limits.reach - reach)
        while when[-1] < end:
            target = centre + sign * reach
            seconds = abs(target - where[-1]) / speed
            if when[-1] + seconds > end:  # the next speed begins before this corner
                seconds = max(end - when[-1], 0.05)
                target = where[-1] + np.sign(target - where[-1]) * speed * seconds
            else:
                sign = -sign
            when.append(when[-1] + seconds)
            where.append(target)
    corner = max(rng.uniform(0.02, 0.12), 2 * limits.speed / limits.acceleration)
    return smooth(np.interp(t, when, where), t, corner, 0.02)


def point_to_point(rng, t, limits):
    when, where = [0.0], [rng.uniform(-1, 1) * limits.reach]
    while when[-1] < t[-1]:
        rest = rng.uniform(0.1, 0.5) if rng.random() < 0.6 else rng.uniform(0.5, 2.0)
        when.append(when[-1] + rest)
        where.append(where[-1])
        target = rng.uniform(-1, 1) * limits.reach
        speed = limits.speed * rng.uniform(0.15, 1.0)
        when.append(when[-1] + max(abs(target - where[-1]) / speed, 0.05))
        where.append(target)
    # a mean over v/a turns the ramp into a trapezoid of velocity
    return smooth(np.interp(t, when, where), t, limits.speed / limits.acceleration, 0.02)


def staircase(rng, t, limits):
    height = limits.reach * rng.uniform(0.3, 0.9)
    fastest = max(1.9 * height / limits.speed, (5.8 * height / limits.acceleration) ** 0.5)
    seconds = fastest * rng.uniform(1.0, 2.0)
    q, where, sign, now = np.full_like(t, -limits.reach), -limits.reach, 1.0, 0.0
    while now < t[-1]:
        now += rng.uniform(0.2, 1.2)
        if abs(where + sign * height) > limits.reach:
            sign = -sign
        s = np.clip((t - now) / seconds, 0.0, 1.0)
        q += sign * height * s**3 * (10 - 15 * s + 6 * s**2)  # least jerk
        where, now = where + sign * height, now + seconds
    return q


def from_rest(t):
    return np.sin(np.pi / 2 * np.minimum(t, 1.0)) ** 2


def smooth(q, t, *widths):
    """Running means over these widths, in seconds, the first and last value held outside."""
    for width in widths:
        n = max(int(width / (t[1] - t[0])) | 1, 1)
        total = np.cumsum(np.r_[0.0, np.pad(q, n // 2, "edge")])
        q = (total[n:] - total[:-n]) / n
    return q
