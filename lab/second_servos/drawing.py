"""Draw a plant; draw again until its hidden effect shows in fitted and held-out logs alike."""

import math

import numpy as np

from .devices import Device, draw_leg, draw_servo
from .joint import Joint
from .kinds import KINDS, able, apply, hide
from .load import mjcf_of
from .own import GRAVITY_ERROR, add_own, draw_own, mass_factor
from .plant import Plant, Recording
from .simulate import motion
from .targets import COURSES, draw_target

REACH = 2.5  # rad, no joint goes further
TRIES = 200


def draw(kind: str, rng: np.random.Generator) -> Plant:
    """A plant of that kind; all that is random comes from `rng`."""
    if kind not in KINDS:
        raise ValueError(f"unknown kind {kind!r}; there are {', '.join(KINDS)}")
    for _ in range(TRIES):
        plant = _attempt(kind, rng)
        if plant is not None:
            return plant
    raise RuntimeError(f"no plant of kind {kind!r} in {TRIES} tries")


def _attempt(kind: str, rng: np.random.Generator) -> Plant | None:
    """One try; None where it moves too little, too far, restlessly or without the effect."""
    leg = kind == "factor" or rng.random() < 0.4
    device = draw_leg(rng) if leg else draw_servo(rng)
    own = draw_own(kind, leg, rng)
    honest = add_own(device.joint, own, rng)
    hidden = hide(kind, honest, rng)
    joint = apply(honest, hidden)
    if not able(joint):
        return None
    planned = _plan(device, rng)
    paths = []
    for _, target, kp in planned:
        path = _acceptable(joint, kp, target, 1 / device.log_hz)
        if path is None:
            return None
        paths.append(path)
    rivals = [honest] if hidden else []
    if own and own != GRAVITY_ERROR:
        rivals.append(apply(device.joint, hidden))
    seen = np.array([_changes(r, planned, paths, device) for r in rivals])
    held_out = _hold_out(device, [name for name, _, _ in planned], seen, rng)
    if held_out is None:
        return None
    recordings = [
        _record(device, name, target, kp, path)
        for (name, target, kp), path in zip(planned, paths, strict=True)
    ]
    mjcf = mjcf_of(device.arm, mass_factor(own, rng))
    return Plant(kind, hidden, own, mjcf, device.controller, recordings, held_out, joint)


def _plan(device: Device, rng: np.random.Generator) -> list[tuple[str, np.ndarray, float]]:
    """Name, target and gain of each log: every gain has every motion, or two of each motion."""
    several = len(device.gains) > 1
    number = {1: 4, 2: 4, 3: 3}[len(device.gains)] - int(rng.random() < 0.4)
    number = max(number, 2)
    brisk = str(rng.choice(("steps", "levels", "steps", "staircase")))
    others = [k for k in COURSES if k != brisk]
    kinds = [brisk, *(str(k) for k in rng.choice(others, number - 1, replace=False))]
    reach = float(rng.uniform(1.0, 1.9))
    count = device.joint.firmware.count if device.unit else 0.0  # servos take targets in counts
    planned = []
    for i, kp in enumerate(device.gains if several else device.gains * 2):
        for kind in kinds:
            lasts = rng.uniform(4, 8)
            t = np.arange(int(lasts * device.log_hz)) / device.log_hz
            target = draw_target(kind, rng, t, reach)
            if count:
                target = np.round(target / count) * count
            name = f"kp{i + 1}_{kind}" if several else f"{kind}_{i + 1}"
            planned.append((name, target, kp))
    return planned


def _acceptable(joint: Joint, kp: float, target: np.ndarray, period: float) -> np.ndarray | None:
    """The motion, if the joint rests when the log begins, moves, and stays within reach."""
    settling, path = motion(joint, kp, target, period)
    q = path[:, 0]
    tail = settling[-int(0.4 / period) :, 0]
    if np.ptp(tail) > 2e-5 or not np.all(np.isfinite(q)):
        return None
    if np.abs(q).max() > REACH or np.std(q) < max(0.05, 0.25 * np.std(target)):
        return None
    return q


def _changes(
    rival: Joint,
    planned: list[tuple[str, np.ndarray, float]],
    paths: list[np.ndarray],
    device: Device,
) -> list[float]:
    """Mean square by which each log moves otherwise without an effect, rad^2."""
    period = 1 / device.log_hz
    others = [motion(rival, kp, target, period)[1][:, 0] for _, target, kp in planned]
    return [float(np.mean((a - b) ** 2)) for a, b in zip(others, paths, strict=True)]


def _hold_out(
    device: Device, names: list[str], seen: np.ndarray, rng: np.random.Generator
) -> set[str] | None:
    """A gain or a kind of motion to keep out, such that each effect shows on both sides."""
    several = len(device.gains) > 1
    by_gain = several and rng.random() < 0.75
    parts = [_part(n, 0 if by_gain or not several else 1) for n in names]
    least = max(5 * device.joint.firmware.count, 0.003)
    for part in rng.permutation(sorted(set(parts))):
        out = np.array([p == part for p in parts])
        sides = [math.sqrt(row[side].mean()) for row in seen for side in (out, ~out)]
        if all(s >= least for s in sides):
            return {n for n, o in zip(names, out, strict=True) if o}
    return None


def _part(name: str, index: int) -> str:
    return name.split("_")[index]


def _record(
    device: Device, name: str, target: np.ndarray, kp: float, path: np.ndarray
) -> Recording:
    """What the log of that motion holds."""
    count = device.joint.firmware.count
    figures = {"kp": kp / (device.unit or 1.0)}
    time = np.arange(path.size) / device.log_hz
    return Recording(name, time, target, np.round(path / count) * count, figures)
