"""Servos to be tried, of two authors, in one form: what their user has, and the truth.

"mujoco": MuJoCo's own friction under a firmware (`tests/servo_plant.py`), a servo with a duty or a
torque. "second": hobby servos and legs by an integrator and friction laws of their own
(`lab/second_servos`), some with an effect of the joint next to that of the drive.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import Course

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
import second_servos
from servo_plant import COUNT, KNOWN, KT, PLANT, SUPPLY, moved, servo, sines, steps, swept

NOTHING = "nothing"
JOINT = "j"
# what is hidden: the effect's name and the number that is compared
KINDS: dict[str, tuple[str, str]] = second_servos.KINDS


@dataclass(frozen=True)
class Servo:
    """One servo under trial.

    Attributes:
        hidden: numbers of the drive that no file says. own: an effect of the joint, "" for none.
        mjcf: without friction. controller: as its user knows it. fitted, kept: logs.
        truth: the position of the servo itself at the samples of a log, shape (n,), rad, begun as
            a simulation of that log begins; the log is given by its name.
    """

    hidden: dict[str, float]
    own: str
    mjcf: str
    controller: Controller
    fitted: list[JointLog]
    kept: list[JointLog]
    truth: Callable[[str, Course], Array]


# range of the hidden number; a duty's gain is that of the motor, which no file says: servos with
# another gain put out a torque
_RANGES = {
    "delay": (0.02, 0.06),
    "limit": (0.3, 0.6),
    "deadband": (0.04, 0.1),
    "threshold": (0.25, 0.5),
    "rate": (1.5, 3.5),
    "factor": (0.6, 1.6),
}
# the test joints' motor with its supply as one gain, N m a unit of duty
_TORQUE = Controller(output="torque_nm", kp="log:kp", limit=KT * SUPPLY, count_rad=COUNT)


def in_mujoco(kind: str, rng: np.random.Generator) -> Servo:
    """A servo of `tests/servo_plant.py`, the middle one of three gains kept out."""
    loss, damping = rng.uniform(0.03, 0.15), rng.uniform(0.01, 0.1)
    friction = f'frictionloss="{loss:.4f}" damping="{damping:.4f}"'
    gains = sorted(rng.choice([0.6, 1.0, 1.7, 3.0, 5.0], 3, replace=False).tolist())
    hidden: dict[str, float] = {}
    if kind != NOTHING:
        hidden[kind] = float(rng.uniform(*_RANGES[kind]))
    if kind == "threshold":
        hidden["left"] = float(rng.uniform(0.2, 0.5))
    torque = kind == "factor" or (kind == NOTHING and rng.random() < 0.5)
    if torque:
        hidden["emf"] = 0.0
    logs = [
        servo(f"{m.__name__} {kp}", kp, m, hidden, friction=friction)
        for kp in gains
        for m in (steps, sines, swept)
    ]
    if torque:
        logs = [replace(x, metadata={"kp": KT * SUPPLY * x.metadata["kp"]}) for x in logs]
    middle = f" {gains[1]}"
    return Servo(
        hidden,
        "",
        PLANT.format(""),
        _TORQUE if torque else KNOWN,
        [x for x in logs if not x.name.endswith(middle)],
        [x for x in logs if x.name.endswith(middle)],
        lambda _, course: moved(course.target, gains[1], hidden, friction, course.run.start),
    )


def second(kind: str, rng: np.random.Generator) -> Servo:
    """A servo or leg of `lab/second_servos`, with what its user has kept out."""
    plant = second_servos.draw(kind, rng)
    logs = [
        JointLog(
            name=x.name,
            joint=JOINT,
            time=x.time,
            position=x.position,
            target=x.target,
            metadata=x.metadata,
        )
        for x in plant.recordings
    ]
    recordings = {x.name: x for x in plant.recordings}
    return Servo(
        plant.hidden,
        plant.own,
        plant.mjcf,
        Controller(**plant.controller),
        [x for x in logs if x.name not in plant.held_out],
        [x for x in logs if x.name in plant.held_out],
        lambda name, course: plant.position(recordings[name], course.run.start),
    )


HANDS: dict[str, Callable[[str, np.random.Generator], Servo]] = {
    "mujoco": in_mujoco,
    "second": second,
}
