"""Figures 5 and 6: a reversal starts a new curve, and a closed loop leaves no trace."""

from dataclasses import replace
from typing import Any

import numpy as np

from .claim import OTHER, OURS, Claim, panels
from .presliding import LAW
from .traced import Traced, trace

OUT, BACK, ON = 1.6e-4, 0.2e-4, 2.0e-4  # rad: forward, back, forward again


def looped(n: float) -> tuple[Traced, Traced]:
    """The motion with an inner loop, and the same motion without it."""
    p = replace(LAW, n=n)
    return trace(p, [0.0, OUT, BACK, ON]), trace(p, [0.0, OUT, ON])


def trace_left(n: float) -> float:
    """Largest difference of Fh behind the closed loop from the motion without it, in Fs."""
    with_loop, without = looped(n)
    x = np.linspace(1.01 * OUT, ON, 200)
    last = with_loop.position[801:], with_loop.Fh[801:]
    difference = np.interp(x, *last) - np.interp(x, without.position[401:], without.Fh[401:])
    return float(np.abs(difference).max() / LAW.Fs_pos)


def numbers() -> dict[str, Any]:
    """What a reversal and a closing do to Fh, its slope, and the stacks."""
    with_loop, _ = looped(50.0)
    fh, q = with_loop.Fh, with_loop.position
    slope = np.diff(fh) / np.diff(q)
    return {
        "jump_of_Fh_at_reversal_Nm": float(abs(fh[401] - fh[400])),
        "step_of_Fh_elsewhere_Nm": float(np.abs(np.diff(fh)).max()),
        "stiffness_before_reversal_Nm_per_rad": float(slope[399]),
        "stiffness_after_reversal_Nm_per_rad": float(slope[400]),
        "first_slope_of_Fd_Nm_per_rad": LAW.stiffness,
        "extrema_inside_the_loop": int(with_loop.extrema[900]),
        "extrema_after_closing": int(with_loop.extrema[-1]),
        "trace_left_in_Fs": {str(n): trace_left(n) for n in (1, 2, 4, 10, 50, 200)},
    }


def claim() -> Claim:
    """The loop and the torque behind it."""
    found = numbers()
    figure, axes = panels(2)
    for ax, n in zip(axes, (50.0, 1.0), strict=True):
        with_loop, without = looped(n)
        ax.plot(1e6 * without.position, without.Fh, color=OTHER, lw=3, alpha=0.5, label="no loop")
        ax.plot(1e6 * with_loop.position, with_loop.Fh, color=OURS, lw=1.2, label="with a loop")
        ax.set(xlabel="position, urad", ylabel="Fh, N m", title=f"n = {n:g}")
        ax.legend(frameon=False, fontsize=8)
    left = found["trace_left_in_Fs"]
    text = (
        "**The paper:** at a reversal Fh becomes a new extremum and a curve starts there; when a "
        "curve meets the extremum again the loop closes, both extrema are forgotten, and the "
        "motion goes on as if the loop had never been.\n\n**Here:** Fh is continuous at the "
        f"reversal, and its slope jumps to {found['stiffness_after_reversal_Nm_per_rad']:.4g} "
        "N m/rad, the first slope of Fd. Inside the loop the stacks hold "
        f"{found['extrema_inside_the_loop']} extrema, after it {found['extrema_after_closing']}, "
        "the two limits. At n = 50 Fh behind "
        f"the loop differs from the motion without one by {left['50']:.1g} Fs; at n = 1 by "
        f"{left['1']:.2g} Fs, because there the curve comes back to its old torque only beyond the "
        "old position (see the whisker experiment)."
    )
    return Claim("reversal", "Reversal and closing (figures 5 and 6)", text, found, figure)
