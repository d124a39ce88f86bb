"""The balance on a grid of motions, sample rates and encoders, with nothing hidden in it.

    python lab/balance_grid.py --cases 100 --seed 7 --out grid.jsonl

Cases are drawn from `tests/balance_grid`: exact inertia, with or without Coulomb and viscous
friction, torque noise, counts of an encoder. Each goes through the whole search. A row states

    residual    left in motion by the law that was taken, over what the noises of torque and
                position leave behind the filter
    inertia, jerk, snap, delay    coefficients over their standard errors
    added       what the search named, which is to be nothing
"""

import sys
import time
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.linalg import lstsq

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from searches import options, search_all

from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.signals import A
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.lowpass import LowPass, gentle
from tests.balance_grid import Case, Spec, make, specs
from tests.balance_grid.prepared import prepared

_SURE = 2.0
_WITHIN = 1.2


def searched(spec: Spec, seed: int) -> dict[str, Any]:
    """A row of the file."""
    warnings.simplefilter("ignore")
    case = make(spec, np.random.default_rng([seed, specs().index(spec)]))
    row: dict[str, Any] = {"case": spec.name, "motion": spec.motion, "friction": spec.friction}
    begin = time.process_time()
    try:
        found = _trace(case)
    except Exception as error:  # one case must not end the others: it is counted and shown
        return row | {"error": f"{type(error).__name__}: {error}"}
    names = [f.term.name for f in found.findings]
    row |= {"added": names, "cpu_s": time.process_time() - begin}
    return row | measures(case, found.prepared, found.final)


def _trace(case: Case) -> Trace:
    with TemporaryDirectory() as folder:
        return trace(prepared(case, Path(folder)))


def measures(case: Case, prepared: Prepared, base: Fit) -> dict[str, Any]:
    """Residual over the noise, and coefficients of what is not there over their errors."""
    moving = base.in_motion
    f = np.linspace(0.0, 0.5 * case.rate, 8192)
    passed = gentle(f / prepared.band.balance) ** 2
    corner = prepared.band.balance
    counts = [s.noise.left(corner)[1] for s in prepared.segments]
    noise = np.sqrt(case.noise**2 * np.mean(passed) + np.mean(counts))
    columns = np.concatenate([_motion(s)[s.kept] for s in prepared.segments])
    blocks = make_blocks(prepared, base).of_sample
    delay = base.layout.numbers(len(base.terms) - 1)
    tests = {
        "inertia": columns[:, 0],
        "jerk": columns[:, 1],
        "snap": columns[:, 2],
    }
    known = base.free_jacobian
    row = {name: _over_error(x, known, base, blocks) for name, x in tests.items()}
    others = np.delete(base.jacobian, np.r_[np.flatnonzero(base.bound), delay], axis=1)
    late = base.jacobian[:, delay.start]
    estimate = float(base.terms[-1].shape[0])
    error = _error(late, others, base, blocks)
    row["delay"] = (estimate - (0.5 / case.rate if case.held else 0.0)) / error if error else 0.0
    return row | {
        "residual": float(np.sqrt(np.mean(base.residual[moving] ** 2)) / noise),
        "moving": float(moving.mean()),
        "band_hz": prepared.band.balance,
    }


def _motion(segment: Any) -> np.ndarray:
    """Acceleration, jerk and snap behind the balance's filter, kept samples."""
    s = segment
    filtered = LowPass(len(s.drive), s.dt, s.bandwidth_hz, gentle, s.step)
    return np.column_stack([filtered(s.signals[:, A], k) for k in range(3)])


def _apart(x: np.ndarray, known: np.ndarray, fit: Fit) -> np.ndarray:
    w = fit.weight
    K = known * w[:, None]
    size = np.linalg.norm(K, axis=0)
    K = K[:, size > 0.0] / size[size > 0.0]
    return x * w - K @ lstsq(K, x * w, cond=1e-8)[0]


def _error(x: np.ndarray, known: np.ndarray, fit: Fit, blocks: np.ndarray) -> float:
    u = _apart(x, known, fit)
    power = float(u @ u)
    if power < 1e-12 * float((x * fit.weight) @ (x * fit.weight)):
        return 0.0
    scores = np.bincount(blocks, u * fit.residual * fit.weight)
    return float(np.sqrt(np.sum(scores**2)) / power)


def _over_error(x: np.ndarray, known: np.ndarray, fit: Fit, blocks: np.ndarray) -> float:
    error = _error(x, known, fit, blocks)
    u = _apart(x, known, fit)
    return float(u @ (fit.residual * fit.weight) / (u @ u) / error) if error else 0.0


def told(rows: list[dict[str, Any]]) -> str:
    """The table by motion."""
    lines = [f"{'motion':24s} cases  residual (median, most)   within 2 errors   nothing added"]
    done = [r for r in rows if "error" not in r]
    for motion in sorted({r["motion"] for r in done}):
        own = [r for r in done if r["motion"] == motion]
        # a case that never moves by more than its encoder tells has no error in motion
        ratio = [r["residual"] for r in own if r["moving"] > 0.0] or [np.nan]
        names = ("inertia", "jerk", "snap", "delay")
        near = np.mean([abs(r[n]) <= _SURE for r in own for n in names])
        none = sum(not r["added"] for r in own)
        lines.append(
            f"{motion:24s} {len(own):5d}  {np.median(ratio):8.2f} {np.max(ratio):8.2f}"
            f"         {100 * near:5.0f}%            {none} of {len(own)}"
        )
    within = np.mean([r["residual"] <= _WITHIN for r in done if r["moving"] > 0.0])
    lines.append(f"residual within {_WITHIN}: {100 * within:.0f}%")
    lines += [f"ended with an error: {r['case']}: {r['error']}" for r in rows if "error" in r]
    lines += [f"added: {r['case']}: {', '.join(r['added'])}" for r in done if r["added"]]
    return "\n".join(lines)


def main() -> None:
    """Draw cases, search them, print the table."""
    asked = options(__doc__, "cases", 100)
    chosen = np.random.default_rng(asked.seed).choice(len(specs()), asked.cases, replace=False)
    print(
        told(
            search_all(searched, ((specs()[i], asked.seed) for i in chosen), asked.jobs, asked.out)
        )
    )


if __name__ == "__main__":
    main()
