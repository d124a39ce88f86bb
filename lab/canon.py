"""The canon of friction experiments, every law of the package, two step sizes.

    python lab/canon.py              prints the table
    python lab/canon.py --write       writes lab/notes/canon.md and its picture

A mass of 1 kg on a slide joint: Fs 1.5 N, Fc 1 N, Vs 10 mm/s, 0.4 N s/m, 1e4 N/m before sliding.
Prescribed motions go through `friction_torque`, forces through MuJoCo with the law installed. Each
number has a criterion; a law that fails one is not wrong, it is a simpler law.
"""

import argparse
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np
from numpy.typing import NDArray
from paper import slider

import frictionjoint as fj
from frictionjoint.parameters import Friction
from frictionjoint.rivals import (
    ArmstrongParameters,
    DahlParameters,
    DahlStribeckParameters,
    ElastoplasticParameters,
    LuGreParameters,
    MaxwellSlipParameters,
    StaticParameters,
)

Array = NDArray[np.float64]
Number = float | tuple[float, ...]
ROOT = Path(__file__).resolve().parents[1]
FS, FC, VS, K = 1.5, 1.0, 1e-2, 1e4
LEVELS = {"Fs": FS, "Fc": FC, "Vs": VS, "sigma2": 0.4}
DAMPING = 0.2 * K**0.5  # a tenth of critical for 1 kg, where a law has presliding damping
KNOTS = ((1e-4, 1.0), (4e-4, 2.2), (1.2e-3, 3.2))
STEPS = (1e-3, 1e-4)


def integrated(variant: str) -> fj.FrictionParameters:
    """The law of 1997 or of 2002, nearly closing its loops."""
    return fj.FrictionParameters.symmetric(
        **LEVELS, sigma1=DAMPING, n=50.0, knots=KNOTS, variant=variant, virgin="masing"
    )


LAWS: dict[str, Friction] = {
    "static": StaticParameters.symmetric(**LEVELS, V0=1e-4),
    "armstrong": ArmstrongParameters.symmetric(**LEVELS, sigma0=K),
    "dahl": DahlParameters.symmetric(Fc=FC, sigma2=0.4, sigma0=K),
    "dahl_stribeck": DahlStribeckParameters.symmetric(**LEVELS, sigma0=K),
    "lugre": LuGreParameters.symmetric(**LEVELS, sigma0=K, sigma1=DAMPING),
    "elastoplastic": ElastoplasticParameters.symmetric(**LEVELS, sigma0=K, sigma1=DAMPING),
    "integrated 1997": integrated("ganseman1997"),
    "integrated 2002": integrated("lampaert2002"),
    "maxwell_slip": MaxwellSlipParameters.symmetric(
        **LEVELS, elements=((6e3, 0.25), (3e3, 0.35), (1e3, 0.4)), C=50.0
    ),
}


def drift(p: Friction, h: float) -> tuple[float, bool]:
    """um a cycle under 0.4 +- 0.3 N; under 0.1 um to pass."""
    t = h * np.arange(round(21.0 / h))
    run = slider.pull(p, 0.4 * np.minimum(1.0, t) + 0.3 * np.sin(2 * np.pi * t) * (t > 1.0), h)
    cycle = round(1.0 / h)
    per_cycle = 1e6 * float(run.position[-1] - run.position[-1 - 10 * cycle]) / 10
    return per_cycle, abs(per_cycle) < 0.1


def breakaway(p: Friction, h: float) -> tuple[float, bool]:
    """Breakaway at 20 N/s over that at 1 N/s; below 0.99 to pass: it falls with the rate."""
    slow, quick = (slider.breakaway(p, rate, h, FS, 5.0 * VS) for rate in (1.0, 20.0))
    return quick / slow, quick / slow < 0.99


def lag(p: Friction, h: float) -> tuple[tuple[float, ...], bool]:
    """Width, N, of the torque-speed loop at 1, 10 and 25 rad/s, v = Vs (1.5 + cos wt); growing, at
    the last 5 mN and twice the first, to pass."""
    widths = []
    for w in (1.0, 10.0, 25.0):
        t = np.arange(0.0, 6 * np.pi / w, h)
        q = VS * (np.sin(w * t) / w + 1.5 * t)
        last = t > 4 * np.pi / w
        F = fj.friction_torque(p, t, q)[last]
        v = (np.diff(q, prepend=q[0]) / h)[last]  # the mean speed that the torque belongs to
        half, x = len(v) // 2, VS * np.linspace(0.7, 2.3, 100)
        down = np.interp(x, v[:half][::-1], F[:half][::-1])
        widths.append(float(np.abs(np.interp(x, v[half:], F[half:]) - down).max()))
    grows = widths[0] < widths[1] < widths[2]
    return tuple(widths), grows and widths[-1] > max(5e-3, 2.0 * widths[0])


def memory(p: Friction, h: float) -> tuple[float, bool]:
    """How far the inner loop of 500, 200, 500 um fails to close, in Fs; under 0.01 to pass, and
    the loop loses 1 to 80% of 2 Fs times its width: a spring and a switch remember nothing."""
    corners = 1e-6 * np.array([0.0, 500.0, 200.0, 500.0])
    t, q = _path(corners, 1e-4, h)
    F = fj.friction_torque(p, t, q)
    first = int(np.argmax(q))
    gap = abs(float(F[-1] - F[first])) / FS
    lost = float(np.sum(0.5 * (F[first + 1 :] + F[first:-1]) * np.diff(q[first:])))
    return gap, gap < 0.01 and 0.01 < lost / (2.0 * FS * 300e-6) < 0.8


def steady(p: Friction, h: float) -> tuple[float, bool]:
    """Largest error of the torque in steady sliding at 0.5 to 10 Vs, over Fc; under 1e-3."""
    errors = []
    for v in VS * np.array([0.5, 1.0, 2.0, 10.0]):
        t = np.arange(0.0, 0.02 / v, h)
        curve = FC + (FS - FC) * np.exp(-((v / VS) ** 2)) + 0.4 * v
        errors.append(abs(float(fj.friction_torque(p, t, v * t)[-1]) - curve) / FC)
    return max(errors), max(errors) < 1e-3


def stick_slip(p: Friction, h: float) -> tuple[float, bool]:
    """Fraction of time below 0.1 mm/s when drawn at 1 mm/s through 50 N/m; 0.2 to 0.999 to pass."""
    _, v = _controlled(p, h, 6000.0 * 1e-2, lambda t, q, v, i: 50.0 * (1e-3 * t - q))
    share = float(np.mean(np.abs(v[len(v) // 2 :]) < 1e-4))
    slips = float(v.max()) > 5e-3
    return share, slips and 0.2 < share < 0.999


def hunting(p: Friction, h: float) -> tuple[float, bool]:
    """Crossings of the target by a PID loop in 60 s; two to pass, as machines with stiction do."""
    q, _ = _controlled(
        p, h, 60.0, lambda t, q, v, i: 100.0 * (0.01 - q) - 10.0 * v + 400.0 * i, target=0.01
    )
    late = q[len(q) // 3 :] - 0.01
    crossings = int(np.sum(np.diff(np.sign(late)) != 0))
    return float(crossings), 2 <= crossings < 1000


def energy(p: Friction, h: float) -> tuple[float, bool]:
    """Work of a presliding cycle, 80 um at 1 Hz, against 1e5 samples, relative; under 0.1%."""

    def work(step: float) -> float:
        t = np.arange(0.0, 3.0 + step / 2, step)
        q = 8e-5 * np.sin(2 * np.pi * t)
        F = fj.friction_torque(p, t, q)
        last = t >= 2.0 - step / 2
        return float(np.sum(0.5 * (F[last][1:] + F[last][:-1]) * np.diff(q[last])))

    exact = work(1e-5)
    if exact < 1e-3 * K * 64e-10:
        return float("nan"), False
    error = abs(work(h) / exact - 1.0)
    return error, error < 1e-3


def _path(corners: Array, speed: float, h: float) -> tuple[Array, Array]:
    at = np.append(0.0, np.cumsum(np.abs(np.diff(corners)) / speed))
    t = np.unique(np.concatenate([np.arange(0.0, at[-1], h), at]).round(9))
    return t, np.interp(t, at, corners)


def _controlled(
    p: Friction,
    h: float,
    seconds: float,
    control: Callable[[float, float, float, float], float],
    target: float = 0.0,
) -> tuple[Array, Array]:
    """Position and velocity under a force of (t, q, v, integral of the error), every ms."""
    model = slider.slider(p, h)
    data = mujoco.MjData(model)
    per, n = round(1e-3 / h), round(seconds / 1e-3)
    q, v, integral = np.empty(n), np.empty(n), 0.0
    with fj.attach(model):
        for k in range(n):
            q[k], v[k] = data.qpos[0], data.qvel[0]
            integral += 1e-3 * (target - q[k])
            data.qfrc_applied[0] = control(1e-3 * k, q[k], v[k], integral)
            mujoco.mj_step(model, data, per)
    return q, v


EXPERIMENTS: dict[str, Callable[[Friction, float], tuple[Number, bool]]] = {
    "drift": drift,
    "breakaway and rate": breakaway,
    "lag": lag,
    "memory": memory,
    "steady sliding": steady,
    "stick-slip": stick_slip,
    "hunting": hunting,
    "energy": energy,
}
HEAD = """# The canon: laws by experiments

Every law of the package in the experiments that friction laws are judged by. Written by
`python lab/canon.py --write`. A mass of 1 kg, Fs 1.5 N, Fc 1 N, Vs 10 mm/s, 0.4 N s/m, 1e4 N/m
before sliding; each cell holds the number at steps of 1 ms and 0.1 ms, bold where it passes at
both. A law that fails an experiment is not wrong, it is a simpler law. `nan`: no energy is lost.

"""


def table() -> tuple[str, dict[str, dict[str, list[tuple[Number, bool]]]]]:
    """The results as Markdown, and by law and experiment."""
    found = {
        name: {e: [run(p, h) for h in STEPS] for e, run in EXPERIMENTS.items()}
        for name, p in LAWS.items()
    }
    lines = [f"* **{e}**: {' '.join(run.__doc__.split())}" for e, run in EXPERIMENTS.items()]  # type: ignore[union-attr]
    lines += [
        "",
        "| law | " + " | ".join(EXPERIMENTS) + " |",
        "|---" * (len(EXPERIMENTS) + 1) + "|",
    ]
    for name, row in found.items():
        cells = []
        for cell in row.values():
            text = ", ".join(_shown(value) for value, _ in cell)
            cells.append(f"**{text}**" if all(ok for _, ok in cell) else text)
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n", found


def _shown(value: Number) -> str:
    return "/".join(f"{x:.3g}" for x in (value if isinstance(value, tuple) else (value,)))


def picture(path: Path) -> None:
    """Presliding loops and the drift of each law."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    t, q = _path(1e-5 * np.array([0.0, 12.0, -6.0, 9.0, 0.0, 9.0, 12.0]), 1e-4, 1e-3)
    for name, p in LAWS.items():
        left.plot(1e6 * q, fj.friction_torque(p, t, q), label=name, lw=1)
        time = 1e-3 * np.arange(10_000)
        load = 0.4 * np.minimum(1.0, time) + 0.3 * np.sin(2 * np.pi * time) * (time > 1.0)
        right.plot(time, 1e6 * slider.pull(p, load, 1e-3).position, lw=1)
    left.set(xlabel="position, um", ylabel="friction, N", title="Presliding with inner loops")
    right.set(xlabel="time, s", ylabel="position, um", title="0.4 +- 0.3 N", ylim=(-20, 400))
    left.legend(fontsize=7)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true")
    write = parser.parse_args().write
    text, _ = table()
    print(text)
    if write:
        picture(ROOT / "lab/notes/img/canon.png")
        body = text + "\n![Presliding loops, and drift](img/canon.png)\n"
        (ROOT / "lab/notes/canon.md").write_text(HEAD + body)


if __name__ == "__main__":
    main()
