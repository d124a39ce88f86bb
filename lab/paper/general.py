"""The general claims: breakaway varying with rate, lag, smooth transition, memory.

The first two are the experiments of Canudas de Wit et al. (1995) on the law of the whisker
experiment.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray
from scipy.optimize import brentq

import frictionjoint as fj
from frictionjoint.parameters import Friction

from . import slider
from .claim import OTHER, OURS, THIRD, Claim, panels
from .presliding import LAW as JOINT
from .traced import Traced, trace
from .whisker import LAW, Fc, Fs, Vs

Array = NDArray[np.float64]

RATES = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # N/s
FREQUENCIES = (1.0, 10.0, 25.0)  # rad/s
# one stiff segment: the lag of the law is (S + Fs) / (n Fd'), so a soft last segment makes it long
SLIDER = replace(LAW, n=1, knots=((3e-5, 3.0),))
SOFT = replace(LAW, n=1)


def breakaway(p: Friction, rate: float) -> float:
    """Largest friction, N, that meets a force of `rate` N/s before the mass slides at 10 Vs."""
    return slider.breakaway(p, rate, 1e-4, Fs, 10.0 * Vs)


def lag_loop(p: Friction, w: float, samples: int = 4000) -> tuple[Array, Array]:
    """Speed and friction over the last cycle of v = 1e-3 (cos wt + 1.5) m/s."""
    t = np.linspace(0.0, 3 * 2 * np.pi / w, 3 * samples + 1)
    F = fj.friction_torque(p, t, 1e-3 * (np.sin(w * t) / w + 1.5 * t))
    v = 1e-3 * (np.cos(w * t) + 1.5)
    return v[-samples:], F[-samples:]


def lag_width(p: Friction, w: float) -> float:
    """Largest difference between friction speeding up and slowing down, in Fs - Fc."""
    v, F = lag_loop(p, w)
    half = len(v) // 2
    x = np.linspace(0.7e-3, 2.3e-3, 100)
    down, up = (v[:half], F[:half]), (v[half:], F[half:])
    falling = np.interp(x, down[0][::-1], down[1][::-1])
    return float(np.abs(np.interp(x, *up) - falling).max() / (Fs - Fc))


def largest_step(p: fj.FrictionParameters, samples: int) -> float:
    """Largest change of Fh, in Fs, between samples of a start from rest into sliding."""
    p = replace(p, sigma1=0.0, sigma2_pos=0.0, sigma2_neg=0.0)
    t = np.linspace(0.0, 0.2, samples + 1)
    return float(np.abs(np.diff(fj.friction_torque(p, t, 0.05 * t**2))).max() / Fs)


def memory() -> tuple[Traced, Traced, float]:
    """Two rises from one torque, the last reversal; the extremum before it differs.

    Returns: the two rises, with positions from the reversal on, and the lower of the two maxima.
    """
    p = replace(JOINT, n=200.0)
    slide, rise = -3e-3, 1.6e-4
    tops = (slide + 3.0e-4, slide + 4.2e-4)
    bottom = 10.0  # N m

    def fall(top: float, way: float) -> float:
        return float(trace(p, [0.0, slide, top, top - way]).Fh[-1]) - bottom

    rises, maxima = [], []
    for top in tops:
        turn = top - brentq(lambda way, top=top: fall(top, way), 1e-6, 2e-4, xtol=1e-18)
        run = trace(p, [0.0, slide, top, turn, turn + rise])
        rises.append(Traced(*(x[-401:] for x in vars(run).values())))
        maxima.append(float(run.Fh[800]))
    return rises[0], rises[1], min(maxima)


def memory_numbers() -> dict[str, float]:
    """How far the two rises agree, and by how much they part."""
    a, b, top = memory()
    apart = np.abs(a.Fh - b.Fh)
    return {
        "lower_maximum_Nm": top,
        "largest_difference_below_it_Nm": float(apart[np.maximum(a.Fh, b.Fh) < top].max()),
        "difference_at_the_end_Nm": float(apart[-1]),
    }


def numbers() -> dict[str, Any]:
    """All of them."""
    return {
        "breakaway_N_by_rate_N_per_s": {f"{r:g}": breakaway(SLIDER, r) for r in RATES},
        "lag_width_in_Fs_minus_Fc_by_rad_per_s": {
            f"{w:g}": lag_width(SLIDER, w) for w in FREQUENCIES
        },
        "largest_step_in_Fs_by_samples": {
            str(m): largest_step(SLIDER, m) for m in (1000, 10000, 100000)
        },
        "memory": memory_numbers(),
    }


def claim() -> Claim:
    """Four plots in a row."""
    found = numbers()
    figure, axes = panels(4, 2.9)
    force = found["breakaway_N_by_rate_N_per_s"]
    axes[0].semilogx(RATES, list(force.values()), "o-", color=OURS)
    axes[0].set(xlabel="force rate, N/s", ylabel="breakaway force, N", title="breakaway")
    for w, color in zip(FREQUENCIES, (OURS, OTHER, THIRD), strict=True):
        v, F = lag_loop(SLIDER, w)
        axes[1].plot(1e3 * v, F, color=color, lw=1.2, label=f"{w:g} rad/s")
    axes[1].set(xlabel="velocity, mm/s", ylabel="friction, N", title="lag")
    axes[1].legend(frameon=False, fontsize=8)
    _draw_transition(axes[2])
    a, b, top = memory()
    for run, color in ((a, OURS), (b, OTHER)):
        axes[3].plot(1e6 * (run.position - run.position[0]), run.Fh, color=color, lw=1.2)
    axes[3].axhline(top, color="0.55", ls=":", lw=1)
    axes[3].set(xlabel="from the reversal, urad", ylabel="Fh, N m", title="memory")
    width = found["lag_width_in_Fs_minus_Fc_by_rad_per_s"]
    step = found["largest_step_in_Fs_by_samples"]
    soft = lag_width(SOFT, 1.0)
    m = found["memory"]
    text = (
        "**The paper:** the model shows a breakaway force that varies with the rate of the force, "
        "frictional lag, a smooth transition between presliding and sliding, and hysteresis with "
        "*local* memory, which later papers and this package call nonlocal: the torque depends on "
        "extrema further back than the last one.\n\n**Here:** breakaway "
        f"falls from {force['1']:.3f} N at 1 N/s to {force['50']:.3f} N at 50 N/s. Under "
        "v = 1e-3 (cos wt + 1.5) m/s, friction speeding up exceeds friction slowing down by up to "
        f"{width['1']:.2g}, {width['10']:.2g} and {width['25']:.2g} (Fs - Fc) at 1, 10 and 25 "
        "rad/s; both with one stiff segment, because the lag of this law is not free: it is "
        f"(S + Fs) / (n Fd'), and the whisker's soft last segment makes {soft:.2g} of it at 1 "
        "rad/s already. From rest into sliding the largest step of Fh between samples falls with "
        f"the sampling, {step['1000']:.2g}, {step['10000']:.2g}, {step['100000']:.2g} Fs at 1e3, "
        "1e4, 1e5 samples: there is no switch. Two rises from the same reversal agree to "
        f"{m['largest_difference_below_it_Nm']:.1g} N m up to the lower of the maxima before it "
        f"and are {m['difference_at_the_end_Nm']:.2g} N m apart behind it."
    )
    return Claim("general", "General claims", text, found, figure)


def _draw_transition(ax: Axes) -> None:
    t = np.linspace(0.0, 0.2, 4001)
    q = 0.05 * t**2
    for n, color in ((1, OURS), (4, OTHER), (50, THIRD)):
        F = fj.friction_torque(replace(LAW, n=n), t, q)
        ax.semilogx(1e6 * q[1:], F[1:], color=color, lw=1.2, label=f"n = {n}")
    ax.set(xlabel="position, um", ylabel="friction, N", title="transition")
    ax.legend(frameon=False, fontsize=8)
