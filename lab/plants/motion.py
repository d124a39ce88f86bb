"""Target trajectories of the logs, one value per control period."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .spec import Motion

_SINE_ROWS = 24


def target(motion: Motion, dt: float) -> NDArray:
    """Target position in rad at 0, dt, 2 dt, ...; starts at 0 and eases in."""
    t = np.arange(0.0, motion.duration, dt)
    rng = np.random.default_rng(motion.seed)
    shape = _SHAPES[motion.kind](t, motion, rng)
    start = max(0.5, 2.0 * (abs(motion.center) + 0.5 * motion.amplitude) / motion.speed)
    return np.asarray((motion.center + shape) * _ease(t / start))


def _ease(s: NDArray) -> NDArray:
    """Fifth-order polynomial from 0 to 1 with zero speed and acceleration at both ends."""
    s = np.clip(s, 0.0, 1.0)
    return np.asarray(s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


def _through(t: NDArray, points: NDArray, moves: NDArray, rests: NDArray) -> NDArray:
    """Eased moves between points, each followed by a rest."""
    q, now = np.full_like(t, points[0]), 0.0
    for a, b, move, rest in zip(points[:-1], points[1:], moves, rests, strict=True):
        part = t >= now
        q[part] = a + (b - a) * _ease((t[part] - now) / max(move, 1e-9))
        now += move + rest
    return q


def _points(motion: Motion, rng: np.random.Generator, move: float) -> tuple[NDArray, NDArray]:
    n = int(motion.duration / max(move, 0.05)) + 2
    points = motion.amplitude * rng.uniform(-1.0, 1.0, n + 1)
    points[0] = 0.0
    return points, np.abs(np.diff(points))


def _steps(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    points, far = _points(m, rng, 0.4)
    return _through(t, points, 1.9 * far / m.speed + 0.03, rng.uniform(0.3, 0.9, far.size))


def _pick(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    points, far = _points(m, rng, 0.5)
    ends = np.where(np.arange(points.size) % 2 == 0, 1.0, -1.0) * np.abs(points)
    far = np.abs(np.diff(ends))
    return _through(t, ends, 1.9 * far / m.speed + 0.1, rng.uniform(0.1, 0.6, far.size))


def _dwell(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    points, _ = _points(m, rng, 0.4)
    points = m.amplitude * 0.5 * (np.arange(points.size) % 3 - 1.0)
    far = np.abs(np.diff(points))
    return _through(t, points, 1.9 * far / m.speed + 0.05, 10.0 ** rng.uniform(-1.3, 0.5, far.size))


def _ramps(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    """Back and forth at constant speeds from m.speed / 30 to m.speed, log-uniform."""
    q, now, at, sign = np.zeros_like(t), 0.0, 0.0, 1.0
    while now < m.duration:
        speed = m.speed * 30.0 ** -rng.uniform(0.0, 1.0)
        to = sign * m.amplitude * rng.uniform(0.4, 1.0)
        span = min(abs(to - at) / speed, 0.2 * m.duration)
        part = t >= now
        q[part] = at + np.clip(t[part] - now, 0.0, span) * speed * np.sign(to - at)
        at += speed * span * np.sign(to - at)
        now, sign = now + span, -sign
    return q


def _sines(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    """Two sines; the top speed is m.speed or the amplitude m.amplitude, whichever binds first."""
    w1 = m.speed / m.amplitude * rng.uniform(0.35, 0.5)
    w2 = w1 * rng.uniform(2.1, 3.7)
    a2 = rng.uniform(0.15, 0.3)
    return np.asarray(m.amplitude * ((1.0 - a2) * np.sin(w1 * t) + a2 * np.sin(w2 * t)))


def _multisine(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    base = 2.0 * np.pi / rng.uniform(8.0, 12.0)
    order = np.arange(1, _SINE_ROWS + 1)
    phase = rng.uniform(0.0, 2.0 * np.pi, order.size)
    q = np.sum(np.sin(base * t[:, None] * order + phase) / order**1.2, axis=1)
    q -= q.mean()
    scale = min(m.amplitude / np.abs(q).max(), m.speed / np.abs(np.gradient(q, t)).max())
    return np.asarray(q * scale)


def _stick_slip(t: NDArray, m: Motion, rng: np.random.Generator) -> NDArray:
    """Slow constant speed with turns, for a soft controller."""
    slow = m.speed * rng.uniform(0.02, 0.06)
    period = 4.0 * min(m.amplitude / slow, 0.3 * m.duration)
    return np.asarray(slow * (0.25 * period - np.abs((t + 0.25 * period) % period - 0.5 * period)))


_SHAPES = {
    "steps": _steps,
    "ramps": _ramps,
    "sines": _sines,
    "multisine": _multisine,
    "pick-and-place": _pick,
    "stick-slip": _stick_slip,
    "dwell": _dwell,
}
