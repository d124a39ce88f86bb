"""Figure 2: friction at constant velocity, with parameters of its own for each sign of v."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit

import frictionjoint as fj

from .claim import GREY, OURS, Claim, panels, table

Array = NDArray[np.float64]

# the KUKA joint's levels, made different for the two directions
TRUE = fj.FrictionParameters(
    Fs_pos=51.0,
    Fs_neg=44.0,
    Fc_pos=34.26,
    Fc_neg=30.0,
    Vs_pos=0.05,
    Vs_neg=0.03,
    delta_pos=2.0,
    delta_neg=1.2,
    sigma2_pos=10.78,
    sigma2_neg=14.0,
    sigma1=300.0,
    knots=((1e-4, 30.0), (3e-4, 66.0), (9e-4, 114.0)),
)
NAMES = ("Fs", "Fc", "Vs", "delta", "sigma2")
NOISE = 0.3  # N m


def steady_torque(p: fj.FrictionParameters, speed: float) -> float:
    """Torque, N m, once a joint has run at constant speed, rad/s, far beyond presliding."""
    way = 50.0 * p.knots[-1][0] * np.sign(speed)
    q = np.linspace(0.0, way, 41)
    return float(fj.friction_torque(p, q / speed, q)[-1])


def level(v: Array, Fs: float, Fc: float, Vs: float, delta: float, sigma2: float) -> Array:
    """Equation (6) and the viscous part, for v > 0."""
    return Fc + (Fs - Fc) * np.exp(-((v / Vs) ** delta)) + sigma2 * v


def measure(seed: int = 0) -> tuple[Array, Array]:
    """Speeds of both signs and noisy torques."""
    v = np.geomspace(2e-3, 1.0, 60)
    speeds = np.concatenate((-v[::-1], v))
    torque = np.array([steady_torque(TRUE, x) for x in speeds])
    return speeds, torque + np.random.default_rng(seed).normal(0.0, NOISE, len(speeds))


def recover(speeds: Array, torque: Array) -> dict[str, tuple[float, float]]:
    """Least squares of each sign's five parameters: value and standard error by name."""
    found = {}
    for side, part in (("pos", speeds > 0), ("neg", speeds < 0)):
        v, F = np.abs(speeds[part]), np.abs(torque[part])
        start = (F.max(), F.min(), 0.1, 1.0, 1.0)
        best, cov = curve_fit(level, v, F, start, bounds=(1e-3, [1e3, 1e3, 1.0, 10.0, 1e3]))
        for name, x, error in zip(NAMES, best, np.sqrt(np.diag(cov)), strict=True):
            found[f"{name}_{side}"] = (float(x), float(error))
    return found


def claim() -> Claim:
    """The curve, the points, and what a fit makes of them."""
    speeds, torque = measure()
    found = recover(speeds, torque)
    figure, (ax,) = panels()
    ax.plot(speeds, torque, ".", color=GREY, label=f"constant-velocity runs, noise {NOISE} N m")
    for sign, side in ((1, "pos"), (-1, "neg")):
        v = np.geomspace(1e-3, 1.0, 300)
        values = [found[f"{name}_{side}"][0] for name in NAMES]
        ax.plot(sign * v, sign * level(v, *values), color=OURS, label="fit" if sign > 0 else None)
    ax.set(xlabel="velocity, rad/s", ylabel="friction, N m", title="different for each sign")
    ax.legend(frameon=False, fontsize=8)
    numbers: dict[str, Any] = {
        name: {"true": getattr(TRUE, name), "fit": x, "stderr": e} for name, (x, e) in found.items()
    }
    off = max(abs(x - getattr(TRUE, k)) / e for k, (x, e) in found.items())
    rows = [
        [k, f"{r['true']:g}", f"{r['fit']:.4g}", f"{r['stderr']:.2g}"] for k, r in numbers.items()
    ]
    text = (
        "**The paper:** at constant velocity friction follows a Stribeck curve whose parameters "
        "differ with the sign of the velocity.\n\n**Here:** the law, run at 60 constant speeds "
        f"each way with {NOISE} N m of noise, gives that curve, and least squares on the points "
        f"give the ten parameters back, none further off than {off:.1f} standard errors.\n\n"
        + table(["parameter", "true", "fit", "standard error"], rows)
    )
    return Claim("constant_velocity", "Constant velocity (figure 2)", text, numbers, figure)
