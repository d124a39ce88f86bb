"""A mass on a slide joint, pulled by a force of time: MuJoCo with friction installed."""

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

import frictionjoint as fj
from frictionjoint.parameters import Friction

Array = NDArray[np.float64]

_MJCF = """
<mujoco><option timestep="{h}" gravity="0 0 0"/><worldbody><body>
  <joint name="slide" type="slide" axis="1 0 0"/>
  <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
</body></worldbody></mujoco>"""


@dataclass(frozen=True)
class Run:
    """Arrays of shape (n,): s, N, m, m/s; at the ends of the steps."""

    time: Array
    force: Array
    position: Array
    velocity: Array


def slider(parameters: Friction, step: float) -> mujoco.MjModel:
    """1 kg with friction, stepped at `step` s."""
    spec = mujoco.MjSpec.from_string(_MJCF.format(h=step))
    fj.install(spec, {"slide": parameters})
    return spec.compile()


def pull(parameters: Friction, force: Array, step: float) -> Run:
    """Run 1 kg from rest under a force, N, given for every step of `step` s."""
    model = slider(parameters, step)
    data = mujoco.MjData(model)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.zeros(mujoco.mj_stateSize(model, full))
    with fj.attach(model):
        mujoco.mj_getState(model, data, start, full)
        states, _ = rollout.rollout(
            model,
            data,
            start,
            control=np.asarray(force)[:, None],
            control_spec=mujoco.mjtState.mjSTATE_QFRC_APPLIED,
        )
    time, position, velocity = states[0, :, :3].T
    return Run(time, np.asarray(force), position, velocity)


def breakaway(p: Friction, rate: float, step: float, Fs: float, fast: float) -> float:
    """Largest friction, N, that meets a force of `rate` N/s up to 2 Fs before the mass is fast."""
    force = rate * step * np.arange(1, round(2.0 * Fs / rate / step))
    run = pull(p, force, step)
    friction = force - np.diff(run.velocity, prepend=0.0) / step
    slides = run.velocity > fast
    return float(friction[: int(np.argmax(slides)) if slides.any() else None].max())
