"""What friction costs a simulation step: bare, ours and MuJoCo's own, side by side in one run.

    python scripts/benchmark_simulation.py [--repeats 41]

Chains of 1, 7 and 30 hinges, implicitfast at 1 ms, in sliding and in presliding with loops on the
stacks. Every figure is the median over repeats that take turns, as a ratio to the bare step of the
same turn; the spread is the middle half, and the last number is the ratio of the least times, which
a busy machine disturbs least. Steps and attaches are counted in computing time. Then a batch of
1,024 chains on 1 and 2 threads, and the first attach, cold and from numba's cache.
"""

import argparse
import contextlib
import os
import subprocess
import sys
import tempfile
import time

import mujoco
import numpy as np

import frictionjoint as fj

try:
    from mujoco.batch import Batch
except ImportError:
    raise SystemExit(
        f"MuJoCo {mujoco.__version__} has no Batch: pip install 'mujoco>=3.17'"
    ) from None

STEPS, AGAIN = 500, 20
WARM_UP = 200
WHOLE = mujoco.mjtState.mjSTATE_INTEGRATION
FS, FC, STIFFNESS = 1.5, 1.0, 300.0
OURS = fj.FrictionParameters.symmetric(
    Fs=FS,
    Fc=FC,
    Vs=0.05,
    sigma2=0.1,
    n=2.0,
    knots=((FS / STIFFNESS, FS), (4 * FS / STIFFNESS, 3.0)),
)
LUGRE = f"{STIFFNESS} 5 {FC} {FS} 0.05"
WAYS = ("bare", "ours", "frictionloss", "dcmotor LuGre")


def chain(joints: int, way: str) -> mujoco.MjModel:
    """Links in a row about the vertical, each 0.01 kg m^2 or more, a motor a joint."""
    loss = f' frictionloss="{FC}"' if way == "frictionloss" else ""
    bodies = "".join(
        f'<body pos="{0.1 * bool(i)} 0 0"><joint name="j{i}" axis="0 0 1" armature="0.5"{loss}/>'
        '<geom size="0.03" mass="0.3" contype="0" conaffinity="0"/>'
        for i in range(joints)
    )
    motors = "".join(f'<motor joint="j{i}"/>' for i in range(joints))
    if way == "dcmotor LuGre":
        motors += "".join(
            f'<dcmotor joint="j{i}" input="none" motorconst="1e-6" resistance="1" lugre="{LUGRE}"/>'
            for i in range(joints)
        )
    spec = mujoco.MjSpec.from_string(
        '<mujoco><option integrator="implicitfast" timestep="0.001" gravity="0 0 0"/><worldbody>'
        f"{bodies}{'</body>' * joints}</worldbody><actuator>{motors}</actuator></mujoco>"
    )
    if way == "ours":
        fj.install(spec, {f"j{i}": OURS for i in range(joints)})
    return spec.compile()


def prepare(model: mujoco.MjModel, joints: int, motion: str, way: str) -> mujoco.MjData:
    """Sliding at speed, or stuck with shrinking reversals behind it."""
    data = mujoco.MjData(model)
    if motion == "sliding":
        data.qvel[:] = 2.0
        # what friction takes; without friction nothing, or the speed would grow without end
        data.ctrl[:joints] = 0.0 if way == "bare" else FC
    else:
        for k in range(WARM_UP * 4):
            data.ctrl[:joints] = 0.8 * np.exp(-k / 400) * np.sin(k / 20)
            mujoco.mj_step(model, data)
    for _ in range(WARM_UP):
        mujoco.mj_step(model, data)
    return data


def one_step(joints: int, motion: str, repeats: int) -> dict[str, tuple[float, ...]]:
    """Microseconds of a step (bare) or ratios to it: median, quartiles, and that of least times."""
    taken: dict[str, list[float]] = {way: [] for way in WAYS}
    models = {way: chain(joints, way) for way in WAYS}
    states, starts = {}, {}
    for way, model in models.items():
        with fj.attach(model) if way == "ours" else contextlib.nullcontext():
            states[way] = prepare(model, joints, motion, way)
        starts[way] = np.empty(mujoco.mj_stateSize(model, WHOLE))
        mujoco.mj_getState(model, states[way], starts[way], WHOLE)
    for _ in range(repeats):
        for way, model in models.items():
            data = states[way]
            # left to itself a long chain whirls ever faster, until MuJoCo resets it
            mujoco.mj_setState(model, data, starts[way], WHOLE)
            with fj.attach(model) if way == "ours" else contextlib.nullcontext():
                mujoco.mj_step(model, data, AGAIN)
                begin = time.thread_time()
                mujoco.mj_step(model, data, STEPS)
                taken[way].append((time.thread_time() - begin) / STEPS * 1e6)
    bare = np.array(taken["bare"])
    found = {"bare": (float(np.median(bare)),)}
    for way in WAYS[1:]:
        own = np.array(taken[way])
        found[way] = (*np.quantile(own / bare, (0.5, 0.25, 0.75)), own.min() / bare.min())
    return found


def batch_rate(threads: int, simulations: int = 1024, steps: int = 100) -> float:
    """Simulated steps per second of a batch of 7-hinge chains with friction."""
    model = chain(7, "ours")
    with fj.attach(model):
        batch = Batch(model, simulations, nthread=threads)
        batch.bind("ctrl")[:] = 0.5
        batch.step(nstep=20)
        best = np.inf
        for _ in range(5):
            begin = time.perf_counter()
            batch.step(nstep=steps)
            best = min(best, time.perf_counter() - begin)
    return simulations * steps / best


ATTACH = """
import time, mujoco, frictionjoint as fj
from frictionjoint.simulate.stick_slip import kuka_model
model = fj.load_model(kuka_model())
begin = time.process_time()
with fj.attach(model):
    mujoco.mj_step(model, mujoco.MjData(model))
print(time.process_time() - begin)
"""


def first_attach() -> tuple[float, float]:
    """Seconds of computing to the first step: numba's cache empty, and filled."""
    with tempfile.TemporaryDirectory() as cache:
        env = os.environ | {"NUMBA_CACHE_DIR": cache}
        run = [sys.executable, "-c", ATTACH]
        cold, warm = (
            float(subprocess.run(run, env=env, check=True, capture_output=True, text=True).stdout)
            for _ in range(2)
        )
    return cold, warm


def main() -> None:
    """Measure and print, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=41)
    repeats = parser.parse_args().repeats
    print(
        f"MuJoCo {mujoco.__version__}, {os.cpu_count()} CPUs. Ratios to bare: median (quartiles), "
        "of least times.\n"
    )
    print("| hinges | motion | bare, us | ours | frictionloss | dcmotor LuGre |")
    print("|---|---|---|---|---|---|")
    for joints in (1, 7, 30):
        for motion in ("sliding", "presliding"):
            found = one_step(joints, motion, repeats)
            cells = [f"{found['bare'][0]:.2f}"]
            ratios = list(found.values())[1:]
            cells += [f"{m:.2f} ({a:.2f} to {b:.2f}), {x:.2f}" for m, a, b, x in ratios]
            print(f"| {joints} | {motion} | {' | '.join(cells)} |", flush=True)
    one, two = batch_rate(1), batch_rate(2)
    print(
        f"\n1,024 chains of 7 hinges: {one:.3g} steps a second on one thread, {two:.3g} on two "
        f"({two / one:.2f} times)."
    )
    cold, warm = first_attach()
    print(
        f"First attach and step: {cold:.2f} s of computing cold, {warm:.2f} s from numba's cache."
    )


if __name__ == "__main__":
    main()
