"""How right the numerics are: against an event-driven reference and against continuous time."""

import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))

from reference.continuous import continuous_torque
from reference.integrated_solver import reference_torque
from reference.motions import random_motion, random_parameters, violent_motion

import frictionjoint as fj

from .claim import GREY, OTHER, OURS, THIRD, Claim, panels, table

STEPS = (250, 500, 1000, 2000, 4000, 8000)
EXPONENTS = (1.0, 2.0, 6.0, 50.0)
MOTIONS = 1000


def errors(n: float, variant: str) -> list[float]:
    """Largest error, in Fs, of a smooth motion sampled in STEPS steps: slides both ways, 2 s."""
    p = fj.FrictionParameters.symmetric(
        Fs=5.0,
        Fc=3.0,
        Vs=0.01,
        n=n,
        knots=((1e-5, 4.0), (3e-5, 8.0), (1e-4, 12.0)),
        variant=variant,
    )
    samples = np.linspace(0.0, 2.0, STEPS[0] + 1)
    wanted = continuous_torque(p, lambda t: 8.4e-3 * np.cos(7.0 * t), samples)
    found = []
    for m in STEPS:
        t = np.linspace(0.0, 2.0, m + 1)
        torque = fj.friction_torque(p, t, 1.2e-3 * np.sin(7.0 * t))[:: m // STEPS[0]]
        found.append(float(np.abs(torque - wanted).max() / p.Fs_pos))
    return found


def compare(violent: bool) -> dict[str, Any]:
    """Worst error, in Fs, over random laws and motions; `violent`: steps of 1e-12 to 1e3 rad."""
    events, worst = Counter(), 0.0
    for i in range(MOTIONS):
        rng = np.random.default_rng([0, i])
        p = random_parameters(rng)
        if violent:
            # the terms in v would dwarf Fh at 1e9 rad/s
            p = replace(p, sigma1=0.0, sigma2_pos=0.0, sigma2_neg=0.0)
        time, position = violent_motion(rng) if violent else random_motion(rng, p)
        wanted, met = reference_torque(p, time, position)
        events += met
        error = np.abs(fj.friction_torque(p, time, position) - wanted).max()
        worst = max(worst, float(error) / max(p.Fs_pos, p.Fs_neg))
    return {"motions": MOTIONS, "worst": worst, "events": dict(events)}


def claim() -> Claim:
    """Order of convergence, and the worst of many random motions."""
    numbers: dict[str, Any] = {
        "loops": compare(violent=False),
        "violent": compare(violent=True),
        "error_in_Fs_by_steps": {
            variant: {
                f"{n:g}": dict(zip(map(str, STEPS), errors(n, variant), strict=True))
                for n in EXPONENTS
            }
            for variant in ("ganseman1997", "lampaert2002")
        },
    }
    figure, axes = panels(2)
    for ax, (variant, curves) in zip(axes, numbers["error_in_Fs_by_steps"].items(), strict=True):
        for (n, curve), color in zip(curves.items(), (OURS, OTHER, THIRD, "#e7298a"), strict=True):
            ax.loglog(STEPS, list(curve.values()), "o-", color=color, lw=1.2, label=f"n = {n}")
        ax.loglog(
            STEPS, 2e3 * np.array(STEPS, dtype=float) ** -2, "--", color=GREY, label="order 2"
        )
        ax.set_xticks(STEPS, [str(m) for m in STEPS], minor=False)
        ax.set_xticks([], minor=True)
        ax.set(xlabel="steps in 2 s", ylabel="largest error of Fh, Fs", title=variant)
        ax.legend(frameon=False, fontsize=8)
    rows = [
        [
            kind,
            str(r["motions"]),
            f"{r['worst']:.1e} Fs",
            *(str(r["events"][k]) for k in ("reversal", "closing", "reset")),
        ]
        for kind, r in (
            ("nested loops, slides, pauses", numbers["loops"]),
            ("steps of 1e-12 to 1e3 rad", numbers["violent"]),
        )
    ]
    text = (
        "Along a motion that is linear between samples the law is solved exactly, step size or "
        "not: an independent event-driven solver (`tests/reference`) agrees on random laws from "
        "the whole allowed range (n to 1000, delta from 0.01 to 10, Fc down to a millionth of Fs, "
        "1 to 16 knots, both variants, both first loadings).\n\n"
        + table(["motions", "number", "worst error", "reversals", "closings", "resets"], rows)
        + "\nA smooth motion is not linear between samples and its level not constant. Against "
        "the law in continuous time (scipy) the error of sampling it falls in second order.\n"
    )
    return Claim("accuracy", "How right the numerics are", text, numbers, figure)
