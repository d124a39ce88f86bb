"""Motions as formulas: each draws its numbers and gives a function of time.

The function takes instants (s) and gives position, velocity and acceleration there, so that a
velocity's change of sign lies where the formula has it, not where a sample does.
"""

from collections.abc import Callable

import numpy as np

Motion = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def sines(frequency: np.ndarray, amplitude: np.ndarray, phase: np.ndarray) -> Motion:
    w = 2 * np.pi * frequency

    def at(t):
        angle = np.outer(t, w) + phase
        s, c = np.sin(angle), np.cos(angle)
        return s @ amplitude, c @ (amplitude * w), s @ (-amplitude * w**2)

    return at


def six_sines(rng: np.random.Generator, seconds: float) -> Motion:
    """Up to 6 Hz, each with about the same velocity."""
    f = np.geomspace(0.1, 6.0, 6) * rng.uniform(0.9, 1.0, 6)
    return sines(f, 0.1 / f * rng.uniform(0.5, 1.0, 6), rng.uniform(0, 2 * np.pi, 6))


def one_sine(hertz: float) -> Callable[[np.random.Generator, float], Motion]:
    def draw(rng, seconds):
        f = np.array([hertz * rng.uniform(0.9, 1.0)])
        return sines(f, rng.uniform(0.1, 0.4, 1) / f**0.7, rng.uniform(0, 2 * np.pi, 1))

    return draw


def chirp(rng: np.random.Generator, seconds: float) -> Motion:
    """From 0.1 to 10 Hz, the amplitude falling as one over the frequency."""
    low, high = 0.1, rng.uniform(8.0, 10.0)
    size, phase = rng.uniform(0.02, 0.1), rng.uniform(0, 2 * np.pi)
    rise = (high - low) / seconds

    def at(t):
        f = low + rise * t
        angle = phase + 2 * np.pi * (low * t + 0.5 * rise * t**2)
        s, c = np.sin(angle), np.cos(angle)
        v = size * (2 * np.pi * c - rise / f**2 * s)
        a = size * ((2 * rise**2 / f**3 - 4 * np.pi**2 * f) * s - 2 * np.pi * rise / f * c)
        return size * s / f, v, a

    return at


def plateaus(corner: np.ndarray, speed: np.ndarray, width: float, start: float = 0.0) -> Motion:
    """Constant speeds; at each corner half a cosine of this width leads from one to the next.

    corner: middles of the changes, at least `width` apart, shape (n,); speed: shape (n + 1,).
    """
    begin = np.r_[-np.inf, corner - width / 2]
    before, after = speed[:-1], speed[1:]
    # positions where each change begins
    first = start + speed[0] * (corner[0] - width / 2)
    between = speed[1:-1] * (np.diff(corner) - width)
    moved = np.cumsum(0.5 * (before + after)[:-1] * width + between)
    where = first + np.r_[0.0, moved]

    def at(t):
        k = np.searchsorted(begin, t, side="right") - 2  # the last change begun, -1 if none
        j = k.clip(0)
        s = t - (corner[j] - width / 2)
        inside = s < width
        mean, half = 0.5 * (before + after)[j], 0.5 * (before - after)[j]
        angle = np.pi * np.minimum(s, width) / width
        q = where[j] + mean * np.minimum(s, width) + half * width / np.pi * np.sin(angle)
        q = q + after[j] * (s - width).clip(0)
        v = mean + half * np.cos(angle)
        a = np.where(inside, -half * np.pi / width * np.sin(angle), 0.0)
        early = k < 0
        q, v = np.where(early, start + speed[0] * t, q), np.where(early, speed[0], v)
        return q, v, np.where(early, 0.0, a)

    return at


def triangle(width: float) -> Callable[[np.random.Generator, float], Motion]:
    """Triangle waves at four speeds from 0.05 to 2 rad/s, their corners rounded over `width`."""

    def draw(rng, seconds):
        speeds = rng.permutation(np.geomspace(0.05, 2.0, 4)) * rng.uniform(0.8, 1.0, 4)
        corners, signed, sign = [], [], 1.0
        for k, speed in enumerate(speeds):
            begin, length = k * seconds / 4, seconds / 4
            ways = max(round(length / max(0.6 / speed, 3 * width)), 3)
            corners.extend(begin + (np.arange(ways) + 1) * length / ways)
            signed.extend(sign * speed * (-1.0) ** np.arange(ways))
            sign = sign * (-1.0) ** ways
        return plateaus(np.array(corners[:-1]), np.array(signed), width)

    return draw


def ramps(rng: np.random.Generator, seconds: float) -> Motion:
    """Constant speeds, up and down and between them rest, changed over 50 ms."""
    n = 10
    corners = (np.arange(n) + rng.uniform(0.3, 0.7, n)) * seconds / n
    up = np.geomspace(0.02, 1.5, n // 2) * rng.uniform(0.8, 1.0, n // 2)
    speed = np.zeros(n + 1)
    speed[1::2] = rng.permutation(up) * rng.permutation([1, -1, 1, -1, 1])
    return plateaus(corners, speed, 0.05)


def one_speed(rng: np.random.Generator, seconds: float) -> Motion:
    """One constant speed up, the same down, turned over 50 ms."""
    speed = rng.uniform(0.1, 1.0)
    return plateaus(np.array([seconds / 2]), np.array([speed, -speed]), 0.05)


def steps(rng: np.random.Generator, seconds: float) -> Motion:
    """Rests joined by steps of least jerk, 0.15 to 0.5 s long."""
    n = int(seconds / 1.0)
    begin = np.arange(n) + rng.uniform(0.1, 0.4, n)
    length = rng.uniform(0.15, 0.5, n)
    height = np.diff(rng.uniform(-0.5, 0.5, n + 1))

    def at(t):
        s = ((t[:, None] - begin) / length).clip(0.0, 1.0)
        q = s**3 * (10 - 15 * s + 6 * s**2)
        v = 30 * s**2 * (1 - s) ** 2 / length
        a = 60 * s * (1 - s) * (1 - 2 * s) / length**2
        return q @ height, v @ height, a @ height

    return at


MOTIONS: dict[str, Callable[[np.random.Generator, float], Motion]] = {
    "six-sines": six_sines,
    "sine-0.1-hz": one_sine(0.1),
    "sine-1-hz": one_sine(1.0),
    "sine-3-hz": one_sine(3.0),
    "sine-10-hz": one_sine(10.0),
    "chirp": chirp,
    "triangle-sharp": triangle(0.005),
    "triangle-rounded": triangle(0.1),
    "steps": steps,
    "ramps": ramps,
    "one-speed": one_speed,
}
