"""A reach trained in simulation and run on the joint: what each simulation's friction is worth.

    python lab/train_reach.py [--plants 3] [--seed 1] [--bound]

The joint is one of `lab/third_hand`: its friction, one of four laws, and its integrator share no
code with the package. Logs of it are identified; the model is trained on as it is, as plain MuJoCo
has it (`frictionjoint export --to native`, and with --lugre), and without friction; with --bound
also the joint itself, the most that training can do and most of the time. CMA-ES chooses the five
numbers of a compliant controller that reaches 20 to 100 mrad far and rests there, through an
encoder. Each result then runs other reaches, in its own simulation and on the joint.

The reward of a reach is the mean of exp(-(e / 1 mrad)^2) over its time, less what the torque
trembles. Needs pip install 'frictionjoint[train]'.
"""

import argparse
import contextlib
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from cmaes import CMA
from mujoco.batch import Batch
from numba import njit

sys.path.append(str(Path(__file__).resolve().parents[1]))  # lab.third_hand
import frictionjoint as fj
from frictionjoint.export.run import Target, export
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.free_runs import friction_spec
from lab.third_hand.files import write
from lab.third_hand.friction import slip_elements
from lab.third_hand.integrate import LOAD, STATES, derivative, runge_kutta
from lab.third_hand.joint import AMBIENT, Joint
from lab.third_hand.plant import make

ITSELF = "the joint itself"
JOINT, FITTED = "joint1", ("fit1", "fit2", "fit3")
STEP, TICK, FINE = 1e-3, 2e-3, 5e-5
# rad, of the encoder
COUNT = 2.0 * np.pi / 2**18
SECONDS, TRAINED, TESTED = 3.0, 3, 12
POPULATION, GENERATIONS = 16, 40
# the controller's numbers; its memory: last reading, velocity, integral, torque
NUMBERS, MEMORY = 5, 4
CLOSE, TREMBLING = 1e-3, 2.0

# position and velocity at each tick, shape (reaches, ticks, 2)
Reaches = np.ndarray
# mean reward of each controller on reaches: (numbers, shape (n, NUMBERS)) to shape (n,)
World = Callable[[np.ndarray, Reaches], np.ndarray]


def some_reaches(rng: np.random.Generator, count: int) -> Reaches:
    """Eased moves of 20 to 100 mrad at 100 to 500 mrad/s, with rests between them."""
    t = TICK * np.arange(round(SECONDS / TICK))
    found = np.zeros((count, len(t), 2))
    for reach in found:
        begin = 0.1
        while begin < SECONDS:
            way = rng.uniform(0.02, 0.1) * rng.choice([-1.0, 1.0])
            length = 1.9 * abs(way) / np.exp(rng.uniform(np.log(0.1), np.log(0.5)))
            s = np.clip((t - begin) / length, 0.0, 1.0)
            reach[:, 0] += way * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
            begin += length + rng.uniform(0.3, 0.8)
    found[:, :, 1] = np.gradient(found[:, :, 0], TICK, axis=1)
    return found


@dataclass(frozen=True)
class Scales:
    """What is known of a joint when a controller is written: sizes, and its gravity.

    Attributes:
        friction: N m. inertia: kg m^2. gravity, tilt: torque gravity sin(q + tilt), N m, rad.
    """

    friction: float
    inertia: float
    gravity: float
    tilt: float

    @property
    def row(self) -> np.ndarray:
        """For compiled code."""
        return np.array([self.friction, self.inertia, self.gravity, self.tilt])


@njit(cache=True)
def act(x, scales, memory, q, wanted, speed):
    """Torque of one tick, N m: compliant feedback, and what is fed forward against friction.

    x: logits of stiffness, damping and integral; torque fed forward by direction, and the speed
    at which it is whole.
    """
    friction, inertia = scales[0], scales[1]
    largest = 20.0 * friction  # N m/rad: half the friction at 25 mrad
    stiffness = largest / (1.0 + np.exp(-x[0]))
    damping = 2.0 * np.sqrt(largest * inertia) / (1.0 + np.exp(-x[1]))
    integral = 20.0 * largest / (1.0 + np.exp(-x[2]))
    q = np.round(q / COUNT) * COUNT
    memory[1] += 0.3 * ((q - memory[0]) / TICK - memory[1])
    memory[0] = q
    e = wanted - q
    memory[2] += integral * e * TICK
    torque = scales[2] * np.sin(q + scales[3]) + stiffness * e + memory[2]
    torque += damping * (speed - memory[1])
    torque += friction * x[3] * np.tanh(speed / (0.02 * np.exp(x[4])))
    return torque


@njit(cache=True)
def rewarded(scales, memory, q, wanted, torque):
    """Reward of a tick; the torque is remembered."""
    trembles = abs(torque - memory[3]) / scales[0]
    memory[3] = torque
    return np.exp(-(((wanted - q) / CLOSE) ** 2)) - TREMBLING * trembles


@njit(cache=True)
def act_all(x, scales, memory, q, reach, torque, reward):
    """`act` and `rewarded` of many joints, in place; reach: (n, 2)."""
    for i in range(len(q)):
        torque[i] = act(x[i], scales, memory[i], q[i], reach[i, 0], reach[i, 1])
        reward[i] += rewarded(scales, memory[i], q[i], reach[i, 0], torque[i])


def simulated(model: mujoco.MjModel, scales: Scales, friction: bool) -> World:
    """A world of MuJoCo's: all controllers on all reaches side by side."""

    def world(numbers: np.ndarray, reaches: Reaches) -> np.ndarray:
        n, k, ticks = len(numbers), len(reaches), reaches.shape[1]
        with fj.attach(model) if friction else contextlib.nullcontext():
            batch = Batch(model, n * k)
            ctrl, qpos = batch.bind("ctrl"), batch.bind("qpos")
            x, memory = np.repeat(numbers, k, axis=0), np.zeros((n * k, MEMORY))
            memory[:, 3] = scales.gravity * np.sin(scales.tilt)
            wanted = np.tile(reaches, (n, 1, 1))
            torque, reward = np.zeros(n * k), np.zeros(n * k)
            for tick in range(ticks):
                q = np.ascontiguousarray(qpos[:, 0])
                row = np.ascontiguousarray(wanted[:, tick])
                act_all(x, scales.row, memory, q, row, torque, reward)
                ctrl[:, 0] = torque
                batch.step(nstep=round(TICK / STEP))
        return np.nan_to_num(reward.reshape(n, k).mean(axis=1) / ticks, nan=-1e3)

    return world


@njit(cache=True)
def run(joint, elements, x, scales, reach):
    """Mean reward of one controller on the joint itself."""
    y, k, seen = np.zeros(STATES), np.zeros((4, STATES)), np.zeros(7)
    held = np.zeros(elements.shape[0] + 1)
    y[6] = AMBIENT
    memory = np.zeros(MEMORY)
    memory[3] = scales[2] * np.sin(scales[3])
    load = total = 0.0
    for tick in range(len(reach)):
        wanted, speed = reach[tick, 0], reach[tick, 1]
        torque = act(x, scales, memory, y[0], wanted, speed)
        total += rewarded(scales, memory, y[0], wanted, torque)
        for _ in range(int(TICK / FINE + 0.5)):
            derivative(joint, elements, held, 0.0, y, torque, y[0], load, k[0], seen)
            load = seen[LOAD]
            runge_kutta(joint, elements, held, 0.0, y, torque, load, FINE, k, seen)
        if not abs(y[0]) < 1e3:
            return -1e3
    return total / len(reach)


def real(joint: Joint, scales: Scales) -> World:
    """The joint itself."""
    elements = slip_elements(joint.coulomb, joint.stiffness)

    def world(numbers: np.ndarray, reaches: Reaches) -> np.ndarray:
        return np.array(
            [np.mean([run(joint, elements, x, scales.row, r) for r in reaches]) for x in numbers]
        )

    return world


def worlds_of(joint: Joint, folder: Path) -> dict[str, World]:
    """Where the controller of a joint can be trained, from the logs in its folder."""
    scales = Scales(joint.coulomb, joint.inertia, joint.gravity, joint.tilt)
    logs = [read_log(folder / f"{name}.csv", JOINT) for name in FITTED]
    found = fit(prepare(logs, RigidBody(folder / "model.xml", JOINT)))
    bare = mujoco.MjSpec.from_file(str(folder / "model.xml"))
    bare.option.timestep = STEP
    spec = bare.copy()
    friction_spec(spec, JOINT, found)
    spec.compile()
    identified = folder / "identified.xml"
    identified.write_text(spec.to_xml())

    def native(lugre: bool) -> World:
        text = export(identified, Target.NATIVE, folder / "native.xml", lugre=lugre).text
        return simulated(mujoco.MjModel.from_xml_string(text), scales, False)

    return {
        "no friction": simulated(bare.compile(), scales, False),
        "native": native(False),
        "native, LuGre": native(True),
        "ours": simulated(fj.load_model(identified), scales, True),
        ITSELF: real(joint, scales),
    }


def trained(world: World, seed: int) -> np.ndarray:
    """Numbers of the controller that CMA-ES finds in a world, shape (NUMBERS,)."""
    rng = np.random.default_rng(seed)
    search = CMA(mean=np.zeros(NUMBERS), sigma=1.0, population_size=POPULATION, seed=seed)
    for _ in range(GENERATIONS):
        asked = np.array([search.ask() for _ in range(POPULATION)])
        rewards = world(asked, some_reaches(rng, TRAINED))
        search.tell([(x, -r) for x, r in zip(asked, rewards, strict=True)])
    return np.asarray(search.mean)


def main() -> None:
    """Train, run, print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plants", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bound", action="store_true", help="train on the joint itself, too")
    asked = parser.parse_args()
    found: dict[str, list[tuple[float, float]]] = {}
    print("| joint | trained in | reward there | on the joint | gap |")
    print("|---|---|---|---|---|")

    def told(*cells: str, rewards: np.ndarray) -> None:
        there, here = rewards
        print(
            f"| {' | '.join(cells)} | {there:.3f} | {here:.3f} | {there - here:.3f} |", flush=True
        )

    for number in range(asked.plants):
        plant = make(asked.seed, number, ())
        reaches = some_reaches(np.random.default_rng([asked.seed, number]), TESTED)
        with tempfile.TemporaryDirectory() as folder:
            write(plant, Path(folder))
            worlds = worlds_of(plant.joint, Path(folder))
        for name, world in worlds.items():
            if name == ITSELF and not asked.bound:
                continue
            best = trained(world, number)[None]
            pair = tuple(float(w(best, reaches)[0]) for w in (world, worlds[ITSELF]))
            found.setdefault(name, []).append(pair)
            told(str(number), name, rewards=np.array(pair))
    for name, pairs in found.items():
        told("mean", name, rewards=np.mean(pairs, axis=0))


if __name__ == "__main__":
    main()
