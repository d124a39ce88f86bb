"""Random laws and random piecewise-linear motions that reach every mechanism."""

import numpy as np

from frictionjoint.parameters import FrictionParameters


def random_parameters(rng: np.random.Generator) -> FrictionParameters:
    """Asymmetric law: both variants, both virgins, n in 1..50."""
    Fs = 10 ** rng.uniform(-1, 2) * rng.uniform(0.7, 1.4, 2)
    Fc = Fs * rng.uniform(0.3, 1.0, 2)
    m = int(rng.integers(1, 6))
    slopes = np.sort(10 ** rng.uniform(0, 2, m))[::-1]
    dz = rng.uniform(0.2, 1.0, m)
    z, F = np.cumsum(dz), np.cumsum(dz * slopes)
    F *= Fs.sum() * rng.uniform(1.01, 1.3) / F[-1]
    z *= 10 ** rng.uniform(-5, -2)
    Vs = 10 ** rng.uniform(-3, -1, 2)
    delta, sigma2 = rng.uniform(0.5, 3, 2), Fs * rng.uniform(0, 1, 2)
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
        n=float(rng.choice([1, 2, rng.uniform(1, 5), rng.uniform(5, 50)])),
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
