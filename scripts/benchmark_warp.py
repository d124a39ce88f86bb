"""What friction costs a step of mujoco_warp, for many worlds at once.

    python scripts/benchmark_warp.py [--worlds 1 1024 16384] [--device cuda:0] [--repeats 9]

Chains of 1 and 7 hinges, implicitfast at 1 ms, each world with its own motor torque from nothing
to twice the breakaway torque, so that at any time some worlds stick and others slide. Bare steps
and steps with friction take turns; every figure is a median, the spread is the middle half. On a
GPU the steps are replayed from a captured graph, on the CPU they are called one by one.
"""

import argparse
import functools
import gc
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

import frictionjoint as fj
from frictionjoint.simulate.warp import attach_warp

WARM_UP = 20
FS, FC, STIFFNESS = 1.5, 1.0, 300.0  # N m, N m/rad


Run = Callable[[], None]


@dataclass
class Replay:
    """A captured graph, and the call it was captured from: a graph keeps none of its arrays."""

    graph: wp.Graph
    call: Run
    steps: int

    def __call__(self) -> None:
        for _ in range(self.steps):
            wp.capture_launch(self.graph)
        wp.synchronize()


def repeated(device: wp.Device, call: Run, steps: int) -> Run:
    """`steps` calls in one, that waits for them; replayed from a graph where there is a GPU."""
    call()
    if not device.is_cuda:

        def plain() -> None:
            for _ in range(steps):
                call()

        return plain
    # what is collected while a graph is captured would be freed at every replay
    gc.collect()
    gc.disable()
    with wp.ScopedCapture() as capture:
        call()
    gc.enable()
    replay = Replay(capture.graph, call, steps)
    replay()
    return replay


def chain(joints: int, way: str) -> mujoco.MjModel:
    """Links in a row about the vertical, a motor each; with friction if `way` is "ours"."""
    bodies = "".join(
        f'<body pos="{0.1 * bool(i)} 0 0"><joint name="j{i}" axis="0 0 1" armature="0.5"/>'
        '<geom size="0.03" mass="0.3" contype="0" conaffinity="0"/>'
        for i in range(joints)
    )
    motors = "".join(f'<motor joint="j{i}"/>' for i in range(joints))
    spec = mujoco.MjSpec.from_string(
        '<mujoco><option integrator="implicitfast" timestep="0.001" gravity="0 0 0"/><worldbody>'
        f"{bodies}{'</body>' * joints}</worldbody><actuator>{motors}</actuator></mujoco>"
    )
    if way == "ours":
        knots = ((FS / STIFFNESS, FS), (4 * FS / STIFFNESS, 3.0))
        law = fj.FrictionParameters.symmetric(Fs=FS, Fc=FC, Vs=0.05, sigma2=0.1, n=2.0, knots=knots)
        fj.install(spec, {f"j{i}": law for i in range(joints)})
    return spec.compile()


def prepare(joints: int, worlds: int, steps: int) -> dict[str, Run]:
    """Bare steps, steps with friction, and the friction of a step alone."""
    runs = {}
    for way in ("bare", "ours"):
        mjm = chain(joints, way)
        m, d = mjw.put_model(mjm), mjw.make_data(mjm, nworld=worlds)
        d.ctrl.assign(np.repeat(np.linspace(0.0, 2.0 * FS, worlds)[:, None], joints, axis=1))
        if way == "ours":
            attach_warp(m, d, mjm)
        for _ in range(WARM_UP):
            mjw.step(m, d)
        runs[way] = repeated(d.qpos.device, functools.partial(mjw.step, m, d), steps)
    alone = functools.partial(m.callback.passive, m, d)
    runs["friction"] = repeated(d.qpos.device, alone, steps)
    return runs


def measure(joints: int, worlds: int, steps: int, repeats: int) -> list[str]:
    """The cells of a row."""
    runs = prepare(joints, worlds, steps)
    taken: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(repeats):
        for name, run in runs.items():
            begin = time.perf_counter()
            run()
            taken[name].append((time.perf_counter() - begin) / steps)
    bare, ours, alone = (statistics.median(t) for t in taken.values())
    ratios = np.array(taken["ours"]) / np.array(taken["bare"])
    middle, low, high = np.quantile(ratios, (0.5, 0.25, 0.75))
    return [
        f"{joints}",
        f"{worlds:,}",
        f"{1e3 * bare:.3g}",
        f"{middle:.2f} ({low:.2f} to {high:.2f})",
        f"{1e3 * alone:.3g}",
        f"{worlds / ours:.3g}",
    ]


def main() -> None:
    """Measure and print, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 1024, 16384])
    parser.add_argument("--device", default=None, help="as warp names it; its default otherwise")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--steps", type=int, default=20)
    arguments = parser.parse_args()
    wp.config.log_level = wp.LOG_WARNING
    with wp.ScopedDevice(arguments.device) as device:
        replayed = "a captured graph" if device.is_cuda else "single calls"
        print(f"Device: {device.name}, mujoco_warp {mjw.__version__}, warp {wp.__version__},")
        print(f"steps from {replayed}. Ratios to bare: median (quartiles).\n")
        columns = ("hinges", "worlds", "bare step, ms", "ours", "friction alone, ms")
        print(f"| {' | '.join(columns)} | steps of a world in a second |")
        print("|---" * (len(columns) + 1) + "|")
        for joints in (1, 7):
            for worlds in arguments.worlds:
                row = measure(joints, worlds, arguments.steps, arguments.repeats)
                print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
