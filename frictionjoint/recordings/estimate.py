"""Friction parameters of one recording: one least-squares step from a known model.

The difference between the torque that the model requires along the recording and the torque that
acted is explained by small changes of the friction parameters. A weak prior keeps parameters that
the recording does not determine at their values in the known model. Errors are computed from blocks
of time, because neighbouring samples are not independent.

Position noise reaches friction through a nonlinear law and biases every recording in the same
direction, which no standard error shows. The bias is removed by simulation and extrapolation (Cook
and Stefanski 1994): the estimate is repeated with once and twice the noise variance added, and
extrapolated to none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, Index
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import LogError, ParameterError
from frictionjoint.evaluation.model import EvaluatedModel
from frictionjoint.evaluation.recording import Recording
from frictionjoint.evaluation.torque import torque_along
from frictionjoint.files import joint_friction
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.motion import grid_steps
from frictionjoint.identify.noise import clear_of
from frictionjoint.identify.rigid_body import before_friction
from frictionjoint.identify.segment import A_BALANCE
from frictionjoint.identify.weights import STICKING_ERROR
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.motion import friction_torque, presliding_distance
from frictionjoint.measured.derivatives import motion_band, on_a_grid, position_noise
from frictionjoint.measured.log import DRIVES, JointLog, split_at_gaps
from frictionjoint.measured.lowpass import LowPass, gentle
from frictionjoint.model_files import read_spec
from frictionjoint.mujoco_warnings import unheard
from frictionjoint.parameters import Friction
from frictionjoint.recordings.numbers import Number, changed, numbers_of
from frictionjoint.refine.posterior import Posterior, numbers_in
from frictionjoint.refine.vector import PRIOR_ERRORS, PRIOR_SIZE
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.carrier import install

# added noise over the measured one, and weight of the estimate: value at variance 0 of the parabola
# through the estimates at variances 1, 2 and 3. Two signs cancel what is linear in the added noise.
_ROOT = float(np.sqrt(2.0))
_EXTRAPOLATED = ((0.0, 3.0), (1.0, -1.5), (-1.0, -1.5), (_ROOT, 0.5), (-_ROOT, 0.5))
_OF_LEVEL = {e.name for e in CATALOGUE if e.entry == "scales the friction level"}


@dataclass(frozen=True)
class Known:
    """A known friction and its uncertainty.

    Attributes:
        model: MJCF of the joint with that friction, path or text. joint: name.
        posterior: of the numbers of its parameter file.
        bandwidth_hz: corner of the filter of the balance that it was fitted with; infinite: that of
            the motion.
        undetermined: names of the law's parameters whose values are assumed.
    """

    model: str | Path
    joint: str
    posterior: Posterior
    fixed: Mapping[str, Pose] | None = None
    bandwidth_hz: float = np.inf
    undetermined: frozenset[str] = frozenset()

    @property
    def numbers(self) -> list[Number]:
        """Parameters by which recordings are compared."""
        return numbers_of(self.posterior.content)

    @property
    def values(self) -> Array:
        """Values of the parameters, shape (p,)."""
        values = numbers_in(self.posterior.content)
        return np.array([float(np.mean(values[list(x.indices)])) for x in self.numbers])

    @property
    def stderr(self) -> Array:
        """Standard errors of the parameters, shape (p,)."""
        cov = self.posterior.cov
        A = np.array([np.eye(len(cov))[list(n.indices)].mean(axis=0) for n in self.numbers])
        variance: Array = np.einsum("ij,jk,ik->i", A, cov, A)
        return np.sqrt(np.maximum(0.0, variance))


class Estimates:
    """The parameters of a known friction estimated from one recording.

    Attributes:
        numbers: the p parameters. value: shape (p,).
        stderr: standard errors from blocks of time, shape (p,). independent: what they would be if
            samples were independent, shape (p,). dof: degrees of freedom of `stderr`.
        squares: sum of the squared residual, in units of its variance.
        informed: fraction of the information on each parameter that comes from the recording and
            not from the prior, 0 to 1, shape (p,).
        temperature, load, speed: means that may explain a difference between recordings, deg C, N m
            (N) of the torque's magnitude, rad/s (m/s); NaN if unknown.
        direction: mean direction of motion, -1 to 1; with motion in only one direction, friction
            cannot be distinguished from a bias.
    Raises:
        LogError: the log contains no measured drive, or no motion to compare.
    """

    def __init__(self, known: Known, log: JointLog) -> None:
        numbers = known.numbers
        if not numbers:
            raise ParameterError("the friction has no number to compare: all are zero or shapes")
        parts = [_Part(part) for part in split_at_gaps(log)]
        sizes = np.maximum(PRIOR_SIZE * np.abs(known.values), PRIOR_ERRORS * known.stderr)
        # the last parameter is a time offset of less than a sample between drive and position
        prior = np.append(sizes, np.median(np.diff(log.time)))
        trials = [
            (weight, [_linear(known, x, added, numbers) for x in parts])
            for added, weight in _EXTRAPOLATED
        ]
        measured = trials[0][1]
        if sum(len(x.residual) for x in measured) < 10 * len(numbers):
            raise LogError(f"{log.name}: too little motion with a known drive to compare")
        stribeck = np.array([x.name[:2] in ("Fs", "Vs") for x in numbers])
        held = np.zeros(len(numbers), dtype=bool)
        while True:
            prior[:-1][held] = sizes[held] = 1e-9 * np.abs(known.values[held])
            steps = [(weight, _solve(balances, prior)) for weight, balances in trials]
            value = known.values + np.sum([weight * x.step for weight, x in steps], axis=0)[:-1]
            influence = np.sum([weight * x.influence for weight, x in steps], axis=0)
            m = int(np.sum(np.any(influence != 0.0, axis=1)))
            dof = float(max(1, m - len(numbers)))
            stderr = np.sqrt(np.sum(influence[:, :-1] ** 2, axis=0) * m / dof) * ~held
            # a negative Fs - Fc or Vs stems from the error of the law at low speed and would bias
            # the others, so it is held at its known value
            impossible = stribeck & (value < -2.0 * stderr)
            if not impossible.any():
                break
            held = held | impossible
        self.log, self.numbers = log.name, tuple(numbers)
        self.value, self.stderr, self.dof = value, stderr, dof
        self.independent, self.squares = steps[0][1].independent[:-1], steps[0][1].squares
        # as for independent samples, an upper limit of the information in the recording
        self.informed = np.clip(1.0 - (self.independent / sizes) ** 2, 0.0, 1.0)
        v = np.concatenate([x.velocity for x in measured])
        self.speed = float(np.mean(np.abs(v)))
        self.direction = float(np.mean(v)) / self.speed if self.speed else 0.0
        self.load = float(np.mean(np.abs(np.concatenate([x.acted for x in measured]))))
        self.temperature = np.nan if log.temperature is None else float(np.mean(log.temperature))


class _Part:
    """A log without gaps.

    Attributes:
        log: as read. corner: of the filter of its motion, Hz. resolution: standard deviation of
            the noise of its position, rad (m). noise: drawn at each sample, shape (n,).
        block: duration of a block, s. blocks: number of them.
        acts: torque per unit of each number of an effect, found along the first motion, (m,).
    """

    def __init__(self, log: JointLog) -> None:
        if all(getattr(log, kind) is None for kind in DRIVES):
            what = "no measured drive, and no controller with known kp and supply"
            needs = "the comparison of recordings needs one of them."
            raise LogError(f"{log.name}: {what}: {needs}")
        _, position, dt = on_a_grid(log)
        self.log = log
        self.corner = motion_band(position, dt).whole
        self.resolution = position_noise(position, dt, self.corner)
        drawn = np.random.default_rng(0).standard_normal(len(position))
        self.noise = self.resolution * drawn
        seconds = float(log.time[-1] - log.time[0])
        # a second, or a twelfth of the log
        self.block = max(1e-9, min(1.0, seconds / 12.0))
        self.blocks = int(seconds / self.block) + 1
        self.acts: dict[Number, Array] = {}


class _Balance(NamedTuple):
    """Torque balance of a part at n samples.

    Attributes:
        by: derivatives of the residual by the p parameters and the time offset, shape (n, p + 1).
        residual: torque that the model requires less the torque that acted, shape (n,).
        sticks: from 0 in sliding to 1 where the joint sticks, shape (n,). alike: number of samples
            of the rest that a sample belongs to, which share one error; 1 in sliding.
        level: largest torque of the law, N m (N). block: of each sample. blocks: their number.
        acted, velocity: at each sample, shape (n,).
    """

    by: Array
    residual: Array
    sticks: Array
    alike: Array
    level: float
    block: Index
    blocks: int
    acted: Array
    velocity: Array


class _Step(NamedTuple):
    """Change of the parameters, each block's share in its error, `independent` and `squares`."""

    step: Array
    influence: Array
    independent: Array
    squares: float


def _solve(balances: Sequence[_Balance], prior: Array) -> _Step:
    """The least-squares step of one set of balances."""
    keys = "by", "residual", "sticks", "alike"
    J, r, sticks, alike = (np.concatenate([getattr(x, k) for x in balances]) for k in keys)
    slides, stuck = sticks < 0.05, sticks > 0.5
    least = (STICKING_ERROR * max(x.level for x in balances)) ** 2
    step: Array = np.zeros(len(prior))
    for _ in range(8):  # the residual variances, the weights and the step depend on each other
        squares = (r + J @ step) ** 2
        variance = float(np.mean(squares[slides] if slides.any() else squares)) + 1e-300
        missed = max(least, float(np.mean(squares[stuck])) - variance) if stuck.any() else least
        w = variance / (variance + missed * sticks * alike)
        precision = (J.T * w) @ J / variance + np.diag(prior**-2.0)
        step = np.asarray(np.linalg.solve(precision, -(J.T * w) @ r / variance), dtype=np.float64)
    scores = []
    for x in balances:
        score = np.zeros((x.blocks, len(prior)))
        own = variance / (variance + missed * x.sticks * x.alike) * (x.residual + x.by @ step)
        np.add.at(score, x.block, x.by * own[:, None])
        scores.append(score / variance)
    inverse = np.linalg.inv(precision)
    influence, independent = -np.concatenate(scores) @ inverse, np.sqrt(np.diag(inverse))
    return _Step(step, influence, independent, float(w @ squares) / variance)


def _linear(known: Known, part: _Part, added: float, numbers: Sequence[Number]) -> _Balance:
    """The torque balance of a part, with `added` times its noise added to its position."""
    log = part.log
    if added:
        log = replace(log, position=log.position + added * part.noise)
    recording = Recording.of({known.joint: log}, part.corner, grid_steps(part.corner))
    content, constraint = known.posterior.content, known.posterior.constraint
    own = joint_friction(content)
    # differentiated twice, position noise grows with frequency; the band of the fit keeps it out
    corner = min(known.bandwidth_hz, recording.filter.corner_hz)
    balance = LowPass(len(recording.time), recording.step, corner, gentle)

    def needed(friction: JointFriction | None) -> tuple[Array, Array]:
        model = known.model if friction is None else _with_friction(known, friction)
        m = EvaluatedModel(model, recording, known.fixed)
        with unheard():
            along = torque_along(m, recording, len(recording.time))
        given = along.given[known.joint]
        acted = recording.filtered[known.joint]
        if m.controls[known.joint] is not None:
            acted = recording.filter(given)
        return balance(recording.filter(along.needed[known.joint])), balance(acted)

    base, acted = needed(None)
    q, velocity, acceleration = recording.motion[known.joint]
    lead, V0 = constraint or (0.0, 0.0)

    def torque_of(law: Friction) -> Array:
        if constraint:
            return constraint.torque(law, velocity, acceleration)
        return friction_torque(law, recording.time, q)

    law = torque_of(own.parameters)
    if constraint:
        base += balance(law - friction_torque(own.parameters, recording.time, q))
    columns = []
    for number, value in zip(numbers, known.values, strict=True):
        by = 0.02 * value
        try:
            other = changed(content, number, by)
        except ParameterError:
            by = -by
            other = changed(content, number, by)
        if number.of_law:
            moved = torque_of(other.parameters)
            columns.append(balance(moved - law) / by)
        else:
            # noise of the position changes the friction level, and hardly how other effects act
            if number not in part.acts or number.name.partition(" ")[0] in _OF_LEVEL:
                part.acts[number] = (needed(other)[0] - base) / by
            columns.append(part.acts[number])
    columns.append(-np.gradient(acted, recording.step))
    every = max(1, int(1.0 / (A_BALANCE * corner * recording.step)))
    clear = clear_of(~recording.known[known.joint], corner, recording.step)
    kept = np.flatnonzero(clear)[::every]
    # in presliding, and at velocities that the encoder does not resolve, the position hardly
    # determines the torque and the law's error is largest; the filter of the motion spreads it
    fastest = 2.0 * np.pi * part.corner
    slowest = V0 + part.resolution * fastest * (1.0 + lead * fastest)
    sticks = np.abs(velocity + lead * acceleration) < slowest
    sticks |= _from_reversal(q) <= presliding_distance(own.parameters, 0.99)
    fraction = np.clip(balance(sticks.astype(np.float64)), 0.0, 1.0)
    block = (recording.time[kept] / part.block).astype(int)
    J, residual = np.column_stack(columns)[kept], (base - acted)[kept]
    level = float(np.max(np.abs(law)))
    share = fraction[kept]
    samples = share, _alike(share > 0.05), level, block, part.blocks, acted[kept], velocity[kept]
    return _Balance(J, residual, *samples)


def _alike(sticks: NDArray[np.bool_]) -> Array:
    """Number of samples of the rest that a sample belongs to, 1 for one in sliding, shape (n,)."""
    lengths = np.diff(np.flatnonzero(np.diff(sticks, prepend=~sticks[:1], append=~sticks[-1:])))
    return np.where(sticks, np.repeat(lengths, lengths), 1.0)


def _from_reversal(q: Array) -> Array:
    """Distance from the last reversal of a position, rad (m), shape (n,)."""
    step = np.diff(q, prepend=q[0])
    path, turned = np.cumsum(np.abs(step)), np.flatnonzero(step[1:] * step[:-1] <= 0.0) + 1
    last = np.concatenate([[0], turned])[np.searchsorted(turned, np.arange(len(q)), side="right")]
    return np.asarray(path - path[last])


def _with_friction(known: Known, friction: JointFriction) -> str:
    """The known model with another friction at its joint."""
    model, _ = before_friction(known.model, [known.joint])
    spec: mujoco.MjSpec = read_spec(model)
    install(spec, {known.joint: friction.parameters}, {known.joint: friction.effects})
    assert known.joint in blocks(spec.compile())
    return str(spec.to_xml())
