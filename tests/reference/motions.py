"""Random laws and random piecewise-linear motions that reach every mechanism."""

import numpy as np

from frictionjoint.parameters import FrictionParameters

# smallest values drawn where parameters.py allows anything above zero
LEAST_FC, LEAST_DELTA = 1e-6, 0.01


def random_parameters(rng: np.random.Generator) -> FrictionParameters:
    """Asymmetric law from all that parameters.py allows.

    Both variants, both virgins, n in 1..1000, delta in 0.01..10, Fc from Fs down to a millionth of
    it, 1 to 16 knots, curves that end at the least torque allowed or far above it, and levels,
    stiffnesses and Stribeck velocities over many decades.
    """
    Fs = 10 ** rng.uniform(-3, 3) * 10 ** rng.uniform(-0.5, 0.5, 2)
    share = np.where(rng.random(2) < 0.5, rng.random(2), LEAST_FC ** rng.random(2))
    Fc = Fs * np.clip(share, LEAST_FC, 1.0)
    m = int(rng.integers(1, 17))
    slopes = np.sort(10 ** rng.uniform(-1, 3, m))[::-1]
    dz = 10 ** rng.uniform(-1.5, 0, m)
    z, F = np.cumsum(dz), np.cumsum(dz * slopes)
    # rounding must not leave the last knot below the least torque allowed
    F *= Fs.sum() * rng.choice([1 + 1e-9, rng.uniform(1.01, 1.3), rng.uniform(1, 10)]) / F[-1]
    z *= 10 ** rng.uniform(-6, 0)
    Vs = 10 ** rng.uniform(-5, 1, 2)
    delta = np.where(
        rng.random(2) < 0.5, 10 - rng.uniform(0, 10 - LEAST_DELTA, 2), 10 ** rng.uniform(-2, 1, 2)
    )
    sigma2 = Fs * rng.uniform(0, 1, 2)
    return FrictionParameters(
        Fs_pos=Fs[0],
        Fs_neg=Fs[1],
        Fc_pos=Fc[0],
        Fc_neg=Fc[1],
        Vs_pos=Vs[0],
        Vs_neg=Vs[1],
        delta_pos=delta[0],
        delta_neg=delta[1],
        sigma2_pos=sigma2[0],
        sigma2_neg=sigma2[1],
        sigma1=float(Fs.mean() * rng.uniform(0, 0.5)),
        n=float(rng.choice([1, 2, 4, 1000, rng.uniform(1, 5), 10 ** rng.uniform(0, 3)])),
        knots=tuple((float(a), float(b)) for a, b in zip(z, F, strict=True)),
        variant=str(rng.choice(["ganseman1997", "lampaert2002"])),
        virgin=str(rng.choice(["literal", "masing"])),
    )


def random_motion(rng, parameters, samples: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """(time s, position rad): nested spirals, jumps over many loops, slides and pauses."""
    reach = parameters.knots[-1][0]
    turns = [0.0]
    while len(turns) < samples:
        centre, width = turns[-1], reach * 10 ** rng.uniform(-1.5, 0.3)
        spiral = width * 0.75 ** np.arange(rng.integers(2, 8)) * rng.uniform(0.5, 1)
        turns += list(centre + spiral * (-1.0) ** np.arange(len(spiral)))
        turns.append(turns[-1] + rng.choice([-1, 0, 1, 4]) * width)  # 0 is a pause
    position = np.array(turns[:samples])
    speed = 10 ** rng.uniform(-4, 0, samples - 1)
    step = np.abs(np.diff(position))
    return np.concatenate(([0.0], np.cumsum(np.where(step > 0, step, 1e-3) / speed))), position


def violent_motion(rng, samples: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """(time s, position rad): steps of 1e-12 to 1e3 rad in 1 us to 100 s, pauses between."""
    step = 10 ** rng.uniform(-12, 3, samples - 1) * rng.choice([-1, 1, 1], samples - 1)
    step *= rng.choice([0, 1, 1, 1], samples - 1)
    duration = 10 ** rng.uniform(-6, 2, samples - 1)
    return np.append(0.0, np.cumsum(duration)), np.append(0.0, np.cumsum(step))
