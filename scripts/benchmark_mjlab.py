"""What a joint's friction costs a step of mjlab, next to BAM's actuator.

    python scripts/benchmark_mjlab.py [--worlds 4096] [--device cuda:0] [--repeats 9]

In an environment with mjlab 1.6.0 and BAM (better-actuator-models). Chains of 1 and 6 XL330 servos
that hold links against gravity and follow targets of their own in every world, 2 ms, as mjlab runs
them: the actuator's command from torch, then a step, from a captured graph on a GPU. `bare` has
mjlab's PD controller and no friction, `ours` the same controller and the XL330 of the library of
motors with its effects, `BAM` its actuator M6 for the XL330, whose friction MuJoCo's solver clips.
All take turns; every figure is a median, the spread is the middle half.
"""

import argparse
import contextlib
import io
import math
import statistics
import time
from collections.abc import Callable

import mujoco
import numpy as np
import torch
import warp as wp
from bam.mjlab import BamActuatorCfg
from mjlab.actuator import IdealPdActuatorCfg
from mjlab.entity import EntityArticulationInfoCfg, EntityCfg
from mjlab.scene import Scene, SceneCfg
from mjlab.sim import MujocoCfg, Simulation, SimulationCfg

import frictionjoint as fj
from frictionjoint.motors.library import get_motor
from frictionjoint.simulate.mjlab import IdentifiedPdActuatorCfg

STEP, WARM_UP = 0.002, 50
# rad; N m/rad, N m s/rad
SWING, STIFFNESS, DAMPING = 0.5, 2.0, 0.05
ALL = (".*",)
ACTUATORS = {
    "bare": IdealPdActuatorCfg(target_names_expr=ALL, stiffness=STIFFNESS, damping=DAMPING),
    "ours": IdentifiedPdActuatorCfg(target_names_expr=ALL, stiffness=STIFFNESS, damping=DAMPING),
    "BAM": BamActuatorCfg(target_names_expr=ALL, motor_name="xl330", model="m6"),
}


def chain(joints: int, way: str) -> mujoco.MjSpec:
    """Light links in a row, one below the other."""
    bodies = "".join(
        f'<body pos="0 0 {-0.06 * bool(i)}"><joint name="j{i}" axis="0 1 0" armature="0.002"/>'
        '<geom type="capsule" fromto="0 0 0 0 0 -0.06" size="0.01" mass="0.03" contype="0" '
        'conaffinity="0"/>'
        for i in range(joints)
    )
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><worldbody>{bodies}{'</body>' * joints}</worldbody></mujoco>"
    )
    if way == "ours":
        servo = get_motor("xl330").friction
        names = [f"j{i}" for i in range(joints)]
        fj.install(
            spec,
            dict.fromkeys(names, servo.parameters),
            effects=dict.fromkeys(names, servo.effects),
        )
    return spec


def prepare(joints: int, way: str, worlds: int, device: str) -> Callable[[int], None]:
    """A call that runs steps and waits for them."""
    robot = EntityCfg(
        spec_fn=lambda: chain(joints, way),
        articulation=EntityArticulationInfoCfg(actuators=(ACTUATORS[way],)),
    )
    scene = Scene(SceneCfg(num_envs=worlds, terrain=None, entities={"robot": robot}), device)
    options = MujocoCfg(timestep=STEP, integrator="implicitfast")
    sim = Simulation(
        num_envs=worlds, cfg=SimulationCfg(mujoco=options), model=scene.compile(), device=device
    )
    scene.initialize(sim.mj_model, sim.model, sim.data)
    if way == "BAM":
        sim.expand_model_fields(("dof_frictionloss", "dof_damping"))
    sim.create_graph()
    sim.reset()
    scene.reset()
    phases = torch.arange(worlds * joints, device=device).reshape(worlds, joints)
    scene["robot"].set_joint_position_target(SWING * torch.sin(0.1 * phases))
    sim.forward()

    def run(steps: int) -> None:
        for _ in range(steps):
            scene.write_data_to_sim()
            sim.step()
            scene.update(dt=STEP)
        wp.synchronize()

    run(WARM_UP)
    if not math.isfinite(float(scene["robot"].data.joint_pos.sum())):
        raise SystemExit(f"{way}, {joints} joints: positions are no numbers after {WARM_UP} steps")
    return run


def measure(joints: int, worlds: int, device: str, steps: int, repeats: int) -> list[str]:
    """The cells of a row."""
    # kernels that are compiled and BAM's actuator say so on standard output
    with contextlib.redirect_stdout(io.StringIO()):
        runs = {way: prepare(joints, way, worlds, device) for way in ACTUATORS}
    taken: dict[str, list[float]] = {way: [] for way in runs}
    for _ in range(repeats):
        for way, run in runs.items():
            begin = time.perf_counter()
            run(steps)
            taken[way].append((time.perf_counter() - begin) / steps)
    bare, ours, bam = (np.array(taken[way]) for way in ("bare", "ours", "BAM"))
    cells = [f"{joints}", f"{worlds:,}", f"{1e3 * statistics.median(bare):.3g}"]
    for ratio in (ours / bare, bam / bare, ours / bam):
        middle, low, high = np.quantile(ratio, (0.5, 0.25, 0.75))
        cells.append(f"{middle:.2f} ({low:.2f} to {high:.2f})")
    return cells


def main() -> None:
    """Measure and print, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--worlds", type=int, nargs="+", default=[4096])
    parser.add_argument("--joints", type=int, nargs="+", default=[1, 6])
    parser.add_argument("--device", default="cuda:0" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--steps", type=int, default=100)
    arguments = parser.parse_args()
    print(f"Device: {wp.get_device(arguments.device).name}, warp {wp.__version__}.")
    print("Median (quartiles).\n")
    columns = ("joints", "worlds", "bare step, ms", "ours / bare", "BAM / bare", "ours / BAM")
    print(f"| {' | '.join(columns)} |")
    print("|---" * len(columns) + "|")
    for joints in arguments.joints:
        for worlds in arguments.worlds:
            row = measure(joints, worlds, arguments.device, arguments.steps, arguments.repeats)
            print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
