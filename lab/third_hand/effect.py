"""How much torque each hidden effect moves, and which other names would explain the same torque.

Worked out from the simulated truth: the torque of the balance with the effect less that without,
along the same motion.
"""

import numpy as np
from numba import njit

from .friction import level, viscosity
from .hidden import ALL, CATALOGUE, NAMES
from .integrate import external
from .joint import Joint, without

Record = dict[str, np.ndarray]  # columns of the integrator at the log's instants


@njit(cache=True)
def curves(joint, t, q, v, load, temperature, age):
    """Level, viscosity and external torque at each sample, shape (samples, 3)."""
    out = np.empty((t.size, 3))
    for i in range(t.size):
        out[i, 0] = level(joint, t[i], q[i], v[i], load[i], temperature[i], age[i])
        out[i, 1] = viscosity(joint, t[i], v[i], temperature[i])
        out[i, 2] = external(joint, t[i], q[i], v[i])
    return out


def along(joint: Joint, r: Record) -> np.ndarray:
    """`curves` along a record."""
    columns = ("time", "position", "velocity", "load", "temperature", "age")
    return curves(joint, *(r[c] for c in columns))


def sliding_at(r: Record, other: np.ndarray, level_now: np.ndarray) -> np.ndarray:
    """Sliding torque were the level `other`: scaled where it slides, else at most the level."""
    slides = abs(r["sliding"]) >= 0.95 * level_now
    return np.where(
        slides, r["sliding"] * other / level_now, r["sliding"].clip(-abs(other), abs(other))
    )


def needed(joint: Joint, true: Joint, r: Record) -> np.ndarray:
    """Torque on the motor's side that this joint needs along the recorded motion, N m."""
    s, rate, outside = along(joint, r).T
    if joint.lag > 0.0:
        s = s + r["level"] - along(true, r)[:, 0]  # the lag itself is not the difference wanted
    torque = sliding_at(r, s, r["level"]) + rate * r["velocity"] + outside
    if joint.link > 0.0:
        torque += joint.inertia * (1 - joint.link) * r["acceleration"] + r["coupling"]
    else:
        gravity = joint.gravity * np.sin(r["position"] + joint.tilt)
        torque += joint.inertia * (1 + joint.inertia_error) * r["acceleration"] + gravity
    return torque / (1 + joint.gain)


def moved(kind: str, joint: Joint, r: Record) -> np.ndarray:
    """Torque that the effect of this kind adds to the log, N m."""
    if kind == "measurement-delay":
        return r["asked"] - r["asked_early"]
    if kind == "eccentric-encoder":
        return joint.inertia * r["encoder_acceleration"]
    if kind == "drive-saturation":
        return r["asked"] - r["asked"].clip(-joint.torque_limit, joint.torque_limit)
    if kind == "ageing":
        return r["friction"] * (1 - 1 / r["aged"])
    if kind == "stick-slip-contact":
        acts = needed(without(joint, ALL[kind].fields), joint, r)
        return r["asked"] - acts
    rigid = {"backlash": ("link", "gap"), "joint-elasticity": ("link", "gap")}
    fields = rigid.get(kind, ALL[kind].fields)
    return needed(joint, joint, r) - needed(without(joint, fields), joint, r)


def base(joint: Joint, r: Record) -> np.ndarray:
    """Regressors that a friction law takes with its own parameters: each direction its own."""
    v = r["velocity"]
    slow = np.exp(-((abs(v) / joint.stribeck_velocity) ** joint.stribeck_shape))
    up = 0.5 + 0.5 * np.tanh(v / (0.1 * joint.stribeck_velocity))
    columns = [side * x for side in (up, 1 - up) for x in (np.ones_like(v), v, slow)]
    return np.array(columns).T


def alternatives(joint: Joint, r: Record) -> dict[str, np.ndarray]:
    """Regressors of catalogue effects that are linear in their size, without those of `base`."""
    q, v, a = r["position"], r["velocity"], r["acceleration"]
    load = joint.gravity * np.sin(q + joint.tilt) + joint.inertia * a
    side = np.tanh(v / (0.1 * joint.stribeck_velocity))
    return {
        "torque-bias": np.c_[np.ones_like(q)],
        "gravity-error": np.c_[np.cos(q), np.sin(q)],
        "spring": np.c_[np.ones_like(q), q],
        "inertia-error": np.c_[a],
        "load-dependent": np.c_[abs(load) * side],
        "nonlinear-viscous": np.c_[v * abs(v), side * abs(v) ** 0.5],
        "temperature-dependent": np.c_[r["logged_temperature"] * side, r["logged_temperature"] * v],
    }


def left(torque: np.ndarray, *regressors: np.ndarray) -> np.ndarray:
    """What of it no combination of the regressors takes away."""
    x = np.hstack(regressors)
    x = x / abs(x).max(axis=0).clip(1e-12)
    return torque - x @ np.linalg.lstsq(x, torque, rcond=None)[0]


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def stacked(records: list[Record]) -> Record:
    """The logs one after the other."""
    return {name: np.concatenate([r[name] for r in records]) for name in records[0]}


def shares(kinds: tuple[str, ...], joint: Joint, r: Record, noise: float) -> dict[str, dict]:
    """For each kind the rms of its torque, of what the base law leaves of it, and both as ratios.

    also: other catalogue names that take what the base law leaves, down to the noise.
    """
    friction, told = rms(r["friction"]), {}
    for kind in kinds:
        torque = moved(kind, joint, r)
        rest = left(torque, base(joint, r))
        also = []
        if kind in CATALOGUE and kind != "direction-asymmetry":
            for name, x in alternatives(joint, r).items():
                unexplained = rms(left(torque, base(joint, r), x))
                close = unexplained <= min(noise, 0.1 * rms(rest))
                if name != NAMES.get(kind, kind) and close:
                    also.append(name)
        told[kind] = {
            "rms": rms(torque),
            "over_noise": rms(torque) / noise,
            "over_friction": rms(torque) / friction,
            "left_by_base_over_noise": rms(rest) / noise,
            "also": also,
        }
    return told
