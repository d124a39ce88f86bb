"""Friction parameters of one recording: one least-squares step from a known model.

The difference between the torque that the model requires along the recording and the torque that
acted is explained by small changes of the friction parameters. A weak prior keeps parameters that
the recording does not determine at their values in the known model. Errors are computed from blocks
of time, because neighbouring samples are not independent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import LogError, ParameterError
from frictionjoint.evaluation.model import EvaluatedModel
from frictionjoint.evaluation.recording import Recording
from frictionjoint.evaluation.torque import torque_along
from frictionjoint.files import joint_friction
from frictionjoint.identify.earlier_friction import before_friction
from frictionjoint.identify.held import Pose
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.motion import friction_torque
from frictionjoint.measured.gaps import split_at_gaps
from frictionjoint.measured.log import JointLog
from frictionjoint.model_files import read_spec
from frictionjoint.mujoco_warnings import unheard
from frictionjoint.recordings.numbers import Number, changed, numbers_of, values_of
from frictionjoint.simulate.carrier import blocks, install

# step of a numerical derivative, as a fraction of the parameter
_STEP = 0.02
# standard deviation of the prior, the larger of two: as a fraction of the parameter, and as a
# multiple of the standard error in the known model
_PRIOR, _ERRORS = 0.5, 10.0
# blocks of time for the errors: least number, and longest duration, s
_BLOCKS, _BLOCK_S = 12, 1.0
# samples in the least squares per period of the filter's corner frequency
_PER_PERIOD = 4.0


@dataclass(frozen=True)
class Estimates:
    """Friction parameters estimated from one recording.

    Attributes:
        numbers: the p parameters. value: shape (p,).
        stderr: standard errors from blocks of time, shape (p,).
        informed: fraction of the information on each parameter that comes from the recording and
            not from the prior, 0 to 1, shape (p,).
        temperature, load, speed: means that may explain a difference between recordings, deg C, N m
            (N) of the torque's magnitude, rad/s (m/s); NaN if unknown.
        direction: mean direction of motion, -1 to 1; with motion in only one direction, friction
            cannot be distinguished from a bias.
    """

    log: str
    numbers: tuple[Number, ...]
    value: Array
    stderr: Array
    informed: Array
    temperature: float
    load: float
    speed: float
    direction: float


@dataclass(frozen=True)
class Known:
    """A known friction and its uncertainty.

    Attributes:
        model: MJCF of the joint with that friction, path or text. joint: name.
        content: of its parameter file.
        cov: covariance of the file's numbers, shape (m, m).
    """

    model: str | Path
    joint: str
    content: Mapping[str, Any]
    cov: Array
    fixed: Mapping[str, Pose] | None = None

    @property
    def numbers(self) -> list[Number]:
        """Parameters by which recordings are compared."""
        return numbers_of(self.content)

    @property
    def values(self) -> Array:
        """Values of the parameters, shape (p,)."""
        return values_of(self.content, self.numbers)

    @property
    def stderr(self) -> Array:
        """Standard errors of the parameters, shape (p,)."""
        rows = [np.eye(len(self.cov))[list(n.indices)].mean(axis=0) for n in self.numbers]
        A = np.array(rows)
        variance: Array = np.einsum("ij,jk,ik->i", A, self.cov, A)
        return np.sqrt(np.maximum(0.0, variance))


def estimate(known: Known, log: JointLog) -> Estimates:
    """Estimate the parameters of a known friction from one recording.

    Raises:
        LogError: the log contains no measured drive, or no motion to compare.
    """
    numbers = known.numbers
    if not numbers:
        raise ParameterError("the friction has no number to compare: all are zero or shapes")
    prior = np.maximum(_PRIOR * np.abs(known.values), _ERRORS * known.stderr)
    rows, residuals, blocks_of, loads, speeds = [], [], [], [], []
    for part in split_at_gaps(log):
        J, r, seconds, load, v = _linear(known, part, numbers)
        rows.append(J)
        residuals.append(r)
        blocks_of.append((seconds // _block(seconds)).astype(int) + 1000 * len(rows))
        loads.append(load)
        speeds.append(v)
    J, r, block = np.concatenate(rows), np.concatenate(residuals), np.concatenate(blocks_of)
    if len(r) < 10 * len(numbers):
        raise LogError(f"{log.name}: too little motion with a known drive to compare")
    step, cov, informed = _solve(J, r, block, prior)
    v = np.concatenate(speeds)
    speed = float(np.mean(np.abs(v)))
    temperature = np.nan if log.temperature is None else float(np.mean(log.temperature))
    return Estimates(
        log=log.name,
        numbers=tuple(numbers),
        value=known.values + step,
        stderr=np.sqrt(np.diag(cov)),
        informed=informed,
        temperature=temperature,
        load=float(np.mean(np.abs(np.concatenate(loads)))),
        speed=speed,
        direction=float(np.mean(v)) / speed if speed else 0.0,
    )


def _block(seconds: Array) -> float:
    return max(1e-9, min(_BLOCK_S, float(seconds[-1] - seconds[0]) / _BLOCKS))


def _solve(J: Array, r: Array, block: Array, prior: Array) -> tuple[Array, Array, Array]:
    """Change of the parameters, its covariance, and `informed`, see `Estimates`."""
    p = len(prior)
    step: Array = np.zeros(p)
    variance = float(np.mean(r**2))
    for _ in range(3):  # the residual variance and the step depend on each other
        precision = J.T @ J / variance + np.diag(prior**-2.0)
        step = np.asarray(np.linalg.solve(precision, -J.T @ r / variance), dtype=np.float64)
        variance = float(np.mean((r + J @ step) ** 2)) + 1e-300
    left = r + J @ step
    scores = np.array([J[block == b].T @ left[block == b] for b in np.unique(block)]) / variance
    inverse = np.linalg.inv(precision)
    m = len(scores)
    meat = scores.T @ scores * m / max(1, m - p)
    cov = inverse @ meat @ inverse
    # as for independent samples, an upper limit of the information in the recording
    informed = 1.0 - np.diag(inverse) / prior**2
    return step, cov, np.clip(informed, 0.0, 1.0)


def _linear(
    known: Known, log: JointLog, numbers: Sequence[Number]
) -> tuple[Array, Array, Array, Array, Array]:
    """Derivatives of the residual by the parameters, residual, its times, torque and velocity."""
    if all(getattr(log, kind) is None for kind in ("torque", "voltage", "current")):
        raise LogError(f"{log.name}: no measured drive, which recordings are compared by")
    recording = Recording.of({known.joint: log})
    content = known.content
    own = joint_friction(dict(content))

    def needed(friction: JointFriction | None) -> tuple[Array, Array]:
        model = known.model if friction is None else _with_friction(known, friction)
        m = EvaluatedModel(model, [known.joint], list(recording.led), recording.kinds, known.fixed)
        with unheard():
            along = torque_along(m, recording, len(recording.time))
        given = along.given[known.joint]
        acted = recording.filtered[known.joint]
        if m.controls[known.joint] is not None:
            acted = recording.filter(given)
        return recording.filter(along.needed[known.joint]), acted

    base, acted = needed(None)
    q, velocity = recording.motion[known.joint][:2]
    law = friction_torque(own.parameters, recording.time, q)
    columns = []
    for number, value in zip(numbers, known.values, strict=True):
        by = _STEP * value
        try:
            other = changed(content, number, by)
        except ParameterError:
            by = -by
            other = changed(content, number, by)
        if number.of_law:
            moved = friction_torque(other.parameters, recording.time, q)
            columns.append(recording.filter(moved - law) / by)
        else:
            columns.append((needed(other)[0] - base) / by)
    every = max(1, int(1.0 / (_PER_PERIOD * recording.smooth.corner_hz * recording.step)))
    kept = np.flatnonzero(recording.known[known.joint])[::every]
    J = np.column_stack(columns)[kept]
    return J, (base - acted)[kept], recording.time[kept], acted[kept], velocity[kept]


def _with_friction(known: Known, friction: JointFriction) -> str:
    """The known model with another friction at its joint."""
    model, _ = before_friction(known.model, [known.joint])
    spec: mujoco.MjSpec = read_spec(model)
    install(spec, {known.joint: friction.parameters}, {known.joint: friction.effects})
    compiled = spec.compile()
    assert known.joint in blocks(compiled)
    text: str = spec.to_xml()
    return text
