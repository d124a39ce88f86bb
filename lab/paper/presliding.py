"""Figure 7: presliding loops, and the three segments of Fd read off one of them."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

import frictionjoint as fj

from .claim import GREY, OTHER, OURS, Claim, panels, table
from .traced import trace

Array = NDArray[np.float64]

LAW = fj.FrictionParameters.symmetric(
    Fs=51.0, Fc=34.26, Vs=0.05, n=200.0, knots=((1e-4, 30.0), (3e-4, 66.0), (9e-4, 114.0))
)
AMPLITUDES = (0.5e-4, 1e-4, 2e-4, 3e-4)  # rad
NOISE = 0.2  # N m


def loop(amplitude: float) -> tuple[Array, Array]:
    """The third cycle between plus and minus the amplitude: position and Fh, closed."""
    # Masing's first loading: the loops are centred from the start
    found = trace(replace(LAW, virgin="masing"), [0.0, *[amplitude, -amplitude] * 3, amplitude])
    return found.position[-801:], found.Fh[-801:]


def area(amplitude: float) -> float:
    """Energy a cycle dissipates, J."""
    q, F = loop(amplitude)
    return float(np.sum(0.5 * (F[1:] + F[:-1]) * np.diff(q)))


def identify_segments(seed: int = 0) -> Array:
    """Three slopes and two bends of Fd from the rising and falling half of a noisy loop.

    Args: seed of the noise. Returns: K1, K2, K3 in N m/rad, z1, z2 in rad.
    """
    q, F = loop(AMPLITUDES[-1])
    F = F + np.random.default_rng(seed).normal(0.0, NOISE, len(F))
    z = np.abs(np.concatenate((q[:401] - q[0], q[401:] - q[400])))
    d = np.abs(np.concatenate((F[:401] - F[0], F[401:] - F[400])))

    def curve(x: Array) -> Array:
        K1, K2, K3, z1, z2 = x * scale
        return np.where(
            z < z1,
            K1 * z,
            np.where(z < z2, K1 * z1 + K2 * (z - z1), K1 * z1 + K2 * (z2 - z1) + K3 * (z - z2)),
        )

    scale = np.array([1e5, 1e5, 1e5, 1e-4, 1e-4])
    # the offset of the noise at the turning points stays free
    best = least_squares(
        lambda x: curve(x[:5]) + x[5] * (np.arange(len(z)) < 401) + x[6] - d,
        [2.0, 1.0, 0.5, 1.5, 4.0, 0.0, 0.0],
    )
    return np.asarray(best.x[:5] * scale)


def true_segments() -> Array:
    """What `identify_segments` should find."""
    z, F = np.array([(0.0, 0.0), *LAW.knots]).T
    return np.array([*(np.diff(F) / np.diff(z)), z[1], z[2]])


def claim() -> Claim:
    """Loops of four amplitudes, and Fd from the largest."""
    figure, axes = panels(2)
    for amplitude in AMPLITUDES:
        q, F = loop(amplitude)
        axes[0].plot(1e6 * q, F, lw=1.2)
    axes[0].set(xlabel="position, urad", ylabel="Fh, N m", title="presliding loops")
    found, true = identify_segments(), true_segments()
    for segments, style, label in (
        (true, dict(color=GREY, lw=4), "Fd"),
        (found, dict(color=OURS, lw=1.3), "read off a noisy loop"),
    ):
        K1, K2, K3, z1, z2 = segments
        z = np.array([0.0, z1, z2, 9e-4])
        F = np.cumsum([0.0, K1 * z1, K2 * (z2 - z1), K3 * (9e-4 - z2)])
        axes[1].plot(1e6 * z, F, label=label, **style)
    axes[1].axhline(2 * LAW.Fs_pos, color=OTHER, ls=":", lw=1)
    axes[1].set(xlabel="z, urad", ylabel="Fd, N m", title="three segments; dotted: 2 Fs")
    axes[1].legend(frameon=False, fontsize=8)
    areas = {f"{1e6 * a:g}": round(1e3 * area(a), 9) for a in AMPLITUDES}
    worst = float(np.max(np.abs(found / true - 1.0)))
    names = ("K1 N m/rad", "K2 N m/rad", "K3 N m/rad", "z1 rad", "z2 rad")
    numbers: dict[str, Any] = {
        "dissipated_mJ_by_amplitude_urad": areas,
        "segments": {k: {"true": t, "read": x} for k, t, x in zip(names, true, found, strict=True)},
        "worst_error_of_a_segment": worst,
    }
    rows = [[k, f"{t:.4g}", f"{x:.4g}"] for k, t, x in zip(names, true, found, strict=True)]
    text = (
        "**The paper:** measured presliding loops are described by a transition curve of three "
        "segments.\n\n**Here:** the loops of four amplitudes, "
        + ", ".join(f"{v:.2g} mJ at {k} urad" for k, v in areas.items())
        + " a cycle; below the first bend a loop has no area. The curve of the largest, with "
        f"{NOISE} N m of noise, gives the three segments back within {100 * worst:.2g}%.\n\n"
        + table(["segment", "true", "read off"], rows)
    )
    return Claim("presliding", "Presliding loops (figure 7)", text, numbers, figure)
