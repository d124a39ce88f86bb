"""Stick-slip of the KUKA IR 361's first joint under a proportional position controller.

As in the 1997 paper: stiffness of the loop 1000 N m/rad, target moving at 0.1 rad/s. The joint
sticks until the controller's torque breaks it away, slips, and sticks again.
"""

import contextlib
import io
import itertools
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import load_model, read_friction
from frictionjoint.simulate.native_friction import set_first

JOINT = "joint1"
SPEED = 0.1


@dataclass(frozen=True)
class StickSlip:
    """A run: arrays of shape (n,), and what was read off them.

    Attributes:
        time: s. position, target: rad. velocity: rad/s.
        slip_distances: rad, one a slip that both begins and ends inside the run.
        stick_times: s, one a pause between two slips.
    """

    time: Array
    position: Array
    velocity: Array
    target: Array
    slip_distances: Array
    stick_times: Array

    def summary(self) -> str:
        """Slip distance per cycle and stick time between slips, in a sentence."""
        if not len(self.slip_distances):
            return "no stick-slip: the joint never came back to rest"
        # the first slip starts from rest, not from a cycle
        slips = self.slip_distances[1:] if len(self.slip_distances) > 1 else self.slip_distances
        text = f"{len(self.slip_distances)} slips, {slips.mean():.3f} rad per cycle"
        if len(self.stick_times):
            text += f", {self.stick_times.mean():.3f} s at rest between them"
        return f"{text}."


def kuka_model() -> Path:
    """The MJCF that ships with the package."""
    name = "kuka_ir361_joint1.xml"
    # next to the package in a source tree, inside it once installed
    here = Path(str(files("frictionjoint"))).parent / "models" / name
    return here if here.is_file() else Path(str(files("frictionjoint") / "models" / name))


def native_model(path: Path) -> mujoco.MjModel:
    """The same joint with MuJoCo's own friction: frictionloss = Fc, damping = sigma2."""
    friction = read_friction(load_model(path))[JOINT].parameters.to_dict()
    spec = mujoco.MjSpec.from_file(str(path))
    joint = spec.joint(JOINT)
    joint.frictionloss = friction["Fc_pos"]
    set_first(joint, "damping", friction["sigma2_pos"])
    for numeric in list(spec.numerics):
        spec.delete(numeric)
    return spec.compile()


def stick_slip(path: Path, duration: float = 12.0, native: bool = False) -> StickSlip:
    """Run the joint for `duration` s; `native` with MuJoCo's own frictionloss instead of ours."""
    model = native_model(path) if native else load_model(path)
    data = mujoco.MjData(model)
    out = np.empty((4, round(duration / model.opt.timestep)))
    with contextlib.nullcontext() if native else attach(model):
        for k in range(out.shape[1]):
            data.ctrl[0] = SPEED * data.time
            mujoco.mj_step(model, data)
            out[:, k] = data.time, data.qpos[0], data.qvel[0], data.ctrl[0]
    time, position, velocity, target = out
    # sticking: slower than a hundredth of the target's speed
    stuck = np.abs(velocity) < 0.01 * SPEED
    starts = np.flatnonzero(stuck[:-1] & ~stuck[1:]) + 1
    ends = np.flatnonzero(~stuck[:-1] & stuck[1:]) + 1
    slips = [(a, ends[ends > a][0]) for a in starts if np.any(ends > a)]
    # presliding creep and ringing about a stop are no slips: they move a hundredth of one
    reach = np.array([position[b] - position[a] for a, b in slips])
    largest = reach.max(initial=0.0)
    slips = [s for s, x in zip(slips, reach, strict=True) if x > 0.1 * largest]
    distances = np.array([position[b] - position[a] for a, b in slips])
    pauses = np.array([time[b] - time[a] for (_, a), (b, _) in itertools.pairwise(slips)])
    return StickSlip(time, position, velocity, target, distances, pauses)


def draw(ours: StickSlip, native: StickSlip) -> str:
    """Position over time with ours and with native friction, as SVG text."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 5.2), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [2, 1]})
    axes[0].plot(ours.time, ours.target, color="0.6", lw=1, label="target, 0.1 rad/s")
    shown = (native, "#d95f02", 1.4, "frictionloss"), (ours, "#1b9e77", 1.8, "frictionjoint")
    for run, color, width, label in shown:
        axes[0].plot(run.time, run.position, color=color, lw=width, label=label)
        axes[1].plot(run.time, run.velocity, color=color, lw=1.2)
    axes[0].set_ylabel("position, rad")
    axes[0].legend(frameon=False)
    axes[1].set_ylabel("velocity, rad/s")
    axes[1].set_xlabel("time, s")
    axes[0].set_title("KUKA IR 361, joint 1: 1000 N m/rad, target moving at 0.1 rad/s", fontsize=11)
    text = io.StringIO()
    figure.savefig(text, format="svg")
    return text.getvalue()
