"""A controller at 1 kHz that cancels the KUKA joint's friction by the exported header.

    python examples/cancel_stick_slip.py [--out picture.png]

The loop is that of the paper, proportional with 1000 N m/rad, with a velocity feedback of
50 N m s/rad next to it and the inertia times the wanted acceleration in all runs. It sees the
encoder, 16.3 urad a count, and a velocity filtered from that over 10 ms. Friction that is fed
forward comes from the header of `frictionjoint export --to c`, driven along the wanted motion or
along the measured one; for comparison there is none, or the textbook's Coulomb and viscous torque.

Two motions: one way at 0.1 rad/s, and a slow sine with reversals. Three joints, since no identified
model is the joint: the very law the header was made from, one with a fifth more friction and a
Stribeck velocity a third smaller, and MuJoCo's own LuGre friction (`dcmotor`). Errors after 2 s;
stuck is the part of the time at rest while a motion faster than 0.02 rad/s is wanted.
"""

import argparse
import contextlib
import dataclasses
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from c_header import Header

import frictionjoint as fj
from frictionjoint.export.c import header
from frictionjoint.simulate.carrier import read_friction
from frictionjoint.simulate.stick_slip import JOINT, kuka_model

KP, KD, LIMIT, INERTIA = 1000.0, 50.0, 393.0, 23.8
H, DURATION, START, SETTLED = 1e-3, 12.0, 1.0, 2.0
COUNT, FILTER = 16.3e-6, 0.1  # rad; part of the way to the newest velocity in a step
MOVING, STUCK = 0.02, 0.001  # rad/s
Forward = Callable[[int, float, float], float]


@dataclass(frozen=True)
class Wanted:
    """A motion: s, rad, rad/s, rad/s^2, shape (n,)."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def one_way() -> Wanted:
    """From rest to 0.1 rad/s within a second, and on."""
    t = H * np.arange(round(DURATION / H))
    s = np.clip(t / START, 0.0, 1.0)
    v = 0.1 * s * s * (3.0 - 2.0 * s)
    return Wanted(t, H * np.cumsum(v), v, np.gradient(v, t))


def sine() -> Wanted:
    """0.15 rad at 0.1 Hz, from a turning point."""
    t = H * np.arange(round(2.0 * DURATION / H))
    w = 0.2 * np.pi
    q = 0.15 * (1.0 - np.cos(w * t))
    return Wanted(t, q, 0.15 * w * np.sin(w * t), 0.15 * w * w * np.cos(w * t))


def law() -> fj.FrictionParameters:
    """What was identified."""
    return read_friction(fj.load_model(kuka_model()))[JOINT].parameters


def other_numbers() -> fj.FrictionParameters:
    """A fifth more friction, which falls sooner."""
    p = law()
    more = {name: 1.2 * getattr(p, name) for name in ("Fs_pos", "Fs_neg", "Fc_pos", "Fc_neg")}
    faster = {name: 0.67 * getattr(p, name) for name in ("Vs_pos", "Vs_neg")}
    return dataclasses.replace(p, **more, **faster, knots=tuple((z, 1.2 * F) for z, F in p.knots))


def plant(friction: fj.FrictionParameters | None) -> mujoco.MjModel:
    """The joint with this friction, or with MuJoCo's own LuGre, and no other actuator."""
    spec = mujoco.MjSpec.from_file(str(kuka_model()))
    for unwanted in [*spec.numerics, *spec.actuators, *spec.sensors]:
        spec.delete(unwanted)
    spec.nuserdata = 0
    if friction:
        fj.install(spec, {JOINT: friction})
    else:
        p = law()
        damping = np.zeros_like(spec.joint(JOINT).damping)
        np.ravel(damping)[0] = p.sigma2_pos
        spec.joint(JOINT).damping = damping
        lugre = f"{p.stiffness} {p.sigma1} {p.Fc_pos} {p.Fs_pos} {p.Vs_pos}"
        motor = (
            f'<actuator><dcmotor joint="{JOINT}" input="none" motorconst="1e-6" resistance="1" '
            f'lugre="{lugre}"/></actuator></mujoco>'
        )
        spec = mujoco.MjSpec.from_string(spec.to_xml().replace("</mujoco>", motor))
    model = spec.compile()
    model.opt.timestep = H
    return model


def track(model: mujoco.MjModel, wanted: Wanted, forward: Forward, ours: bool) -> np.ndarray:
    """Position and velocity under the controller, shape (n, 2)."""
    data = mujoco.MjData(model)
    data.qpos[0] = last = wanted.position[0]
    found, v = np.empty((len(wanted.time), 2)), 0.0
    with fj.attach(model) if ours else contextlib.nullcontext():
        for k in range(len(found)):
            found[k] = data.qpos[0], data.qvel[0]
            q = COUNT * round(data.qpos[0] / COUNT)
            v += FILTER * ((q - last) / H - v)
            last = q
            torque = (
                KP * (wanted.position[k] - q)
                + KD * (wanted.velocity[k] - v)
                + INERTIA * wanted.acceleration[k]
                + forward(k, q, v)
            )
            data.qfrc_applied[0] = np.clip(torque, -LIMIT, LIMIT)
            mujoco.mj_step(model, data)
    return found


def forwards(made: Header, w: Wanted) -> dict[str, Forward]:
    """Torque to feed forward at step k, given measured position and velocity, by name."""
    p, state = law(), np.zeros(made.room)
    along = made.torque(0, w.time, w.position, w.velocity)
    # time runs from one step on: a state of zeros starts where it is called first
    return {
        "nothing": lambda k, q, v: 0.0,
        "Coulomb and viscous": lambda k, q, v: float(
            np.sign(w.velocity[k]) * p.Fc_pos + p.sigma2_pos * w.velocity[k]
        ),
        "header, wanted motion": lambda k, q, v: float(along[k]),
        "header, measured motion": lambda k, q, v: float(
            made.torque(0, w.time[k : k + 1] + H, [q], [v], state=state)[0]
        ),
    }


def main() -> None:
    """Print the table, draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="PNG of the tracking errors")
    out = parser.parse_args().out
    motions = {"one way": one_way(), "sine": sine()}
    joints = {"the same law": law(), "other numbers": other_numbers(), "MuJoCo's LuGre": None}
    errors: dict[tuple[str, str, str], np.ndarray] = {}
    print("| joint | motion | fed forward | rms, mrad | largest, mrad | stuck |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        text = header(read_friction(fj.load_model(kuka_model())), "friction.h")
        made = Header(text, Path(folder))
        for joint, friction in joints.items():
            model = plant(friction)
            for motion, w in motions.items():
                for name, forward in forwards(made, w).items():
                    found = track(model, w, forward, friction is not None)
                    error = errors[joint, motion, name] = 1e3 * (found[:, 0] - w.position)
                    late = w.time > SETTLED
                    rms, largest = np.sqrt(np.mean(error[late] ** 2)), np.abs(error[late]).max()
                    moving = late & (np.abs(w.velocity) > MOVING)
                    stuck = np.mean(np.abs(found[moving, 1]) < STUCK)
                    print(
                        f"| {joint} | {motion} | {name} | {rms:.3g} | {largest:.3g} | {stuck:.0%} |"
                    )
    if out:
        draw(out, motions, errors)


def draw(out: Path, motions: dict[str, Wanted], errors: dict[tuple[str, str, str], np.ndarray]):
    """Tracking errors over time, a motion a row, a joint a column."""
    from matplotlib.figure import Figure

    joints = list(dict.fromkeys(joint for joint, *_ in errors))
    figure = Figure(figsize=(11, 5), layout="constrained")
    axes = figure.subplots(len(motions), len(joints), sharex="row", sharey="row")
    for (joint, motion, name), error in errors.items():
        plot = axes[list(motions).index(motion)][joints.index(joint)]
        plot.plot(motions[motion].time, error, label=name, lw=1.2)
        plot.set_title(f"{joint}, {motion}", fontsize=9)
    for row in axes:
        row[0].set_ylabel("error, mrad")
    axes[0][0].legend(frameon=False, fontsize=8)
    out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
