"""The known weaknesses of the 1997 law, in numbers, and what stands against each."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import frictionjoint as fj
from frictionjoint.law.kernel import commit, row_size, start_row, step_row
from frictionjoint.law.memory import BOUND as LOSS_BOUND
from frictionjoint.law.memory import FH, FORGOTTEN

from .claim import GREY, OTHER, OURS, THIRD, Claim, panels, table
from .presliding import LAW as JOINT
from .traced import trace

Array = NDArray[np.float64]
EXPONENTS = (1, 2, 4, 10, 50)
SPEED = 0.01  # rad/s, for the jump of sigma1 dz/dt

# A cycle whose legs have levels of their own: up fast, half way down fast, the rest slowly
GAIN_LAW = fj.FrictionParameters.symmetric(Fs=1.0, Fc=0.02, Vs=1.0, knots=((3.0, 3.0),))
GAIN_LEGS = ((0.14, 10.0), (-0.07, 10.0), (-0.07, 1e-3))  # rad, rad/s


def jump_at_closing(n: float, variant: str = "ganseman1997") -> tuple[float, float]:
    """Jump of F, N m, where an inner loop closes: seen in the law, and by the formula.

    dF = -sigma1 v [((F1 - f0) / (S - f0))**n - ((F1 - f2) / (S - f2))**n] with F1 the torque at
    closing, f0 the outer and f2 the inner base; none in the 2002 form, whose r has no base.
    """
    p = replace(JOINT, n=n, sigma1=300.0, variant=variant, Fc_pos=51.0, Fc_neg=51.0)
    found = trace(p, [0.0, -3e-3, -3e-3 + 3.2e-4, -3e-3 + 2.4e-4, -3e-3 + 6e-4], SPEED, 4000)
    k = 12001 + int(np.argmax(np.diff(found.extrema[12001:]) < 0))
    damping = found.F - found.Fh
    S, F1, f0, f2 = p.Fs_pos, found.Fh[8000], found.Fb[k + 1], found.Fb[k]
    shares = [((F1 - f) / (S - f)) ** n for f in (f0, f2)]
    formula = 0.0 if variant == "lampaert2002" else -p.sigma1 * SPEED * (shares[0] - shares[1])
    return float(damping[k + 1] - damping[k]), float(formula)


def level_below_base(reset: bool) -> tuple[Array, Array]:
    """Time and Fh at 1 rad/s, where S = Fc, after a reversal at 0.8 Fs, above Fc.

    Without the reset the equations are stepped explicitly in time, 1 us a step, as they stand.
    """
    p = replace(JOINT, n=1.0)
    P, X = _started(p)
    q = np.array([0.0, 3e-3, 3e-3 - 3.3e-5])
    for dq in np.diff(q):
        step_row(P, 0, X, 0, dq, 1e3, np.sign(dq) * 1e-5)
        commit(P, 0, X, 0)
    t = np.arange(1, 801) * 1e-6
    Fh, base, at = [], float(X[FH]), 0.0
    z, Fd = np.array([(0.0, 0.0), *p.knots]).T
    last = (Fd[-1] - Fd[-2]) / (z[-1] - z[-2])
    for _ in t:
        if reset:
            step_row(P, 0, X, 0, 1e-6, 1e-6, 1.0)
            commit(P, 0, X, 0)
            Fh.append(float(X[FH]))
        else:
            torque = np.interp(abs(at), z, Fd) + max(0.0, abs(at) - z[-1]) * last
            at += 1e-6 * (1.0 - np.sign(at) * torque / (p.Fc_pos - base))
            Fh.append(base + np.sign(at) * torque)
    return t, np.array(Fh)


def cycle_work(n: float, variant: str = "ganseman1997") -> float:
    """Work of Fh over GAIN_LEGS once the state repeats, over the sum of the legs' |work|."""
    P, X = _started(replace(GAIN_LAW, n=n, variant=variant))
    parts = np.diff(np.append(0.0, np.geomspace(1e-6, 1.0, 600)))
    for cycle in range(40):
        works = []
        for leg, speed in GAIN_LEGS:
            work = 0.0
            for dq in leg * parts if cycle == 39 else [leg]:
                before = X[FH]
                step_row(P, 0, X, 0, dq, abs(dq) / speed, np.sign(dq) * speed)
                commit(P, 0, X, 0)
                work += 0.5 * (before + X[FH]) * dq
            works.append(work)
    return float(sum(works) / np.abs(works).sum())


def spiral_loss(depth: int) -> dict[str, float]:
    """A decaying oscillation of `depth` reversals and back out: memory given up, and its bound."""
    p = replace(JOINT, n=50.0, Fc_pos=51.0, Fc_neg=51.0)
    spiral = 2e-4 * 0.96 ** np.arange(depth) * (-1.0) ** np.arange(depth)
    q = np.concatenate(([0.0], spiral, -spiral[::-1]))
    P, X = _started(p)
    bound = 0.0
    for dq in np.diff(q):
        step_row(P, 0, X, 0, dq, 1.0, dq)
        commit(P, 0, X, 0)
        bound = max(bound, float(X[LOSS_BOUND]))
    return {"reversals": depth, "given_up": float(X[FORGOTTEN]), "bound_in_Fs": bound / p.Fs_pos}


def _started(p: fj.FrictionParameters) -> tuple[Array, Array]:
    P = p.pack()
    X = np.zeros(row_size(P, 0))
    start_row(P, 0, X, 0)
    return P, X


def numbers() -> dict[str, Any]:
    """Each weakness in numbers."""
    unprotected, protected = (level_below_base(reset)[1] for reset in (False, True))
    return {
        "jump_at_closing_Nm": {
            str(n): dict(zip(("seen", "formula"), jump_at_closing(n), strict=True))
            for n in EXPONENTS
        },
        "jump_at_closing_lampaert2002_Nm": max(
            abs(jump_at_closing(n, "lampaert2002")[0]) for n in EXPONENTS
        ),
        "level_below_base": {
            "Fh_without_reset_Nm": float(unprotected[-1]),
            "largest_Fh_with_reset_Nm": float(protected.max()),
            "last_Fh_with_reset_Nm": float(protected[-1]),
            "Fc_Nm": JOINT.Fc_pos,
        },
        "cycle_work_share": {
            variant: {str(n): cycle_work(n, variant) for n in EXPONENTS}
            for variant in ("ganseman1997", "lampaert2002")
        },
        "stacks": [spiral_loss(depth) for depth in (10, 20, 40, 80, 160)],
    }


def claim() -> Claim:
    """Four plots in a row."""
    found = numbers()
    figure, axes = panels(4, 2.9)
    jumps = found["jump_at_closing_Nm"]
    axes[0].semilogx(
        EXPONENTS, [-j["formula"] for j in jumps.values()], color=GREY, label="formula"
    )
    axes[0].semilogx(EXPONENTS, [-j["seen"] for j in jumps.values()], "o", color=OURS, label="law")
    axes[0].set(xlabel="n", ylabel="drop of F, N m", title="a loop closes, 0.01 rad/s")
    axes[0].legend(frameon=False, fontsize=8)
    for reset, color, label in ((False, OTHER, "equations alone"), (True, OURS, "with the reset")):
        t, Fh = level_below_base(reset)
        axes[1].plot(1e6 * t, Fh, color=color, label=label)
    axes[1].set(ylim=(0, 150), xlabel="time, us", ylabel="Fh, N m", title="S falls below Fb")
    axes[1].legend(frameon=False, fontsize=8)
    work = found["cycle_work_share"]
    for variant, color in (("ganseman1997", OURS), ("lampaert2002", OTHER)):
        axes[2].semilogx(EXPONENTS, list(work[variant].values()), "o-", color=color, label=variant)
    axes[2].axhline(0.0, color=GREY, lw=1)
    axes[2].set(xlabel="n", ylabel="work / exchanged", title="a cycle of fast and slow legs")
    axes[2].legend(frameon=False, fontsize=8)
    depths = [s["reversals"] for s in found["stacks"]]
    axes[3].plot(depths, [s["bound_in_Fs"] for s in found["stacks"]], "o-", color=THIRD)
    axes[3].set(xlabel="reversals", ylabel="bound, Fs", title="memory given up")
    below = found["level_below_base"]
    rows = [
        [
            str(n),
            f"{jumps[str(n)]['seen']:.3g}",
            f"{jumps[str(n)]['formula']:.3g}",
            f"{100 * work['ganseman1997'][str(n)]:.1f}%",
            f"{100 * work['lampaert2002'][str(n)]:.1f}%",
        ]
        for n in EXPONENTS
    ]
    text = (
        "* **Jump at a closing.** Fb changes while S does not, so dz/dt jumps, and with sigma1 the "
        "torque. The law keeps the jump, because it is the published law: it is bounded by "
        "sigma1 |v|, follows the formula below and vanishes as n grows. In the 2002 form it is "
        f"at most {found['jump_at_closing_lampaert2002_Nm']:.2g} N m, the step of a sample.\n"
        "* **S(v) below Fb.** When the speed rises inside presliding, S can fall below the base; "
        "then r turns negative and the equations as they stand run away, to "
        f"{below['Fh_without_reset_Nm']:.3g} N m within 0.8 ms. The reset fires on Fh >= 0.999 S, "
        "not on dz/dt = 0, and puts the base behind the motion: Fh never exceeds "
        f"{below['largest_Fh_with_reset_Nm']:.4g} N m and relaxes towards Fc, "
        f"{below['last_Fh_with_reset_Nm']:.4g} N m at the same time.\n"
        "* **Energy.** With r >= 0 and Fh < 0 the 1997 form moves plastically *against* the "
        "friction it predicts. At a constant level no cycle was found to gain from that, but "
        "where the legs of a cycle have different levels one can: up 0.14 fast, down 0.07 fast "
        "and 0.07 slowly (Fc / Fs = 0.02, one segment) returns more work than it takes at n = 1. "
        "In the 2002 form Fh r >= 0 always, plastic motion only dissipates, and no cycle gains; "
        'whoever needs passivity for certain takes `variant="lampaert2002"` or a larger n.\n'
        "* **Stacks without end.** A decaying oscillation nests reversals without limit; the "
        "stacks hold a fixed number and say how much Fh may be off for what they gave up.\n\n"
        + table(["n", "jump, N m", "formula", "work of the cycle, 1997", "2002"], rows)
    )
    return Claim("weaknesses", "Known weaknesses", text, found, figure)
