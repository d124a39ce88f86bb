"""Courses of the target: seven kinds of motion, each within centre +- amplitude, rad."""

from collections.abc import Callable

import numpy as np

Course = Callable[[np.random.Generator, np.ndarray], np.ndarray]


def steps(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Jumps between two levels, or between random ones."""
    hold = rng.uniform(0.6, 1.4)
    index = (t / hold).astype(int)
    if rng.random() < 0.5:
        return np.where(index % 2 == 0, -1.0, 1.0) * rng.uniform(0.7, 1.0)
    levels = rng.uniform(0.3, 1.0, index.max() + 1) * (-1.0) ** np.arange(index.max() + 1)
    return levels[index]


def staircase(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Small steps up, then down."""
    hold = rng.uniform(0.25, 0.6)
    stairs = int(rng.integers(4, 8))
    index = (t / hold).astype(int) % (2 * stairs)
    return -1 + 2 * np.minimum(index, 2 * stairs - index) / stairs


def sines(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Sum of two to four sines, 0.15 to 1.8 Hz."""
    total = np.zeros_like(t)
    for frequency in np.exp(rng.uniform(np.log(0.15), np.log(1.8), int(rng.integers(2, 5)))):
        total += np.sin(2 * np.pi * frequency * t + rng.uniform(0, 2 * np.pi)) / frequency**0.5
    return total / np.abs(total).max()


def chirp(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """A sine that gets faster, its amplitude smaller."""
    low, high = rng.uniform(0.1, 0.3), rng.uniform(1.5, 3.5)
    growth = np.log(high / low) / t[-1]
    phase = 2 * np.pi * low * (np.exp(growth * t) - 1) / growth
    return np.sin(phase) * np.exp(-rng.uniform(0.2, 0.5) * growth * t)


def triangle(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Constant speed to and fro, slow or fast."""
    frequency = np.exp(rng.uniform(np.log(0.2), np.log(1.2)))
    return 2 * np.abs(2 * ((frequency * t + rng.uniform(0, 1)) % 1.0) - 1) - 1


def levels(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Random levels through a first-order filter."""
    hold, lag = rng.uniform(0.3, 0.8), rng.uniform(0.03, 0.2)
    index = (t / hold).astype(int)
    raw = rng.uniform(-1, 1, index.max() + 1)[index]
    keep = np.exp(-(t[1] - t[0]) / lag)
    out = np.empty_like(raw)
    out[0] = raw[0]
    for k in range(1, raw.size):
        out[k] = raw[k] + keep * (out[k - 1] - raw[k])
    return out


def moves(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Minimum-jerk moves to random places with rests between."""
    out = np.zeros_like(t)
    place, begin = rng.uniform(-1, 1), 0.0
    while begin < t[-1]:
        goal = rng.uniform(0.2, 1.0) * (-1 if place > 0 else 1)
        lasts = rng.uniform(0.4, 1.2)
        s = np.clip((t - begin) / lasts, 0, 1)
        part = place + (goal - place) * (10 * s**3 - 15 * s**4 + 6 * s**5)
        out = np.where(t >= begin, part, out)
        place, begin = goal, begin + lasts + rng.uniform(0.2, 0.8)
    return out


COURSES: dict[str, Course] = {
    f.__name__: f for f in (steps, staircase, sines, chirp, triangle, levels, moves)
}


def draw_target(kind: str, rng: np.random.Generator, t: np.ndarray, reach: float) -> np.ndarray:
    """A target of that kind within +-`reach`, rad, after a short rest at its first value."""
    rest = rng.uniform(0.1, 0.4)
    centre = rng.uniform(-0.35, 0.35) * reach
    amplitude = rng.uniform(0.5, 1.0) * (reach - abs(centre))
    course = centre + amplitude * COURSES[kind](rng, t)
    begin = int(rest / (t[1] - t[0]))
    return np.concatenate((np.full(begin, course[0]), course[: t.size - begin]))
