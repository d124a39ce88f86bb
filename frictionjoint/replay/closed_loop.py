"""Whole logs in closed loop: simulated from the target alone.

Controller, motor, friction and load are simulated. Of the measured motion only the initial state is
used, as in a user's simulation.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import BLOCK, COUNT, MEASURED, PERIOD
from frictionjoint.control.kernel_numbers import block_of, delay_of, supply_of
from frictionjoint.control.profile import held, held_over
from frictionjoint.effects.signals import TIME
from frictionjoint.errors import LogError
from frictionjoint.identify.bundle import Change, changed_controller
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.terms import changing_drive, drive_changes
from frictionjoint.identify.terms import delay_of as late_by
from frictionjoint.measured.derivatives import differentiate, first_velocity, followed
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.free_runs import Replay, inertia_error, motor_of, simulated_effects
from frictionjoint.replay.windows import LONGEST_STEP
from frictionjoint.simulate import one_joint
from frictionjoint.simulate.one_joint import JointModel, Load, Run, simulate

# positions at which a load is evaluated: three determine its mean and its first harmonic
_TURNS = (0.0, 2.0 * np.pi / 3.0, -2.0 * np.pi / 3.0)
# of a step, by which a number of steps may be off a whole one
_WHOLE = 1e-6


@dataclass(frozen=True)
class Course:
    """A log prepared for simulation."""

    name: str  # of the log
    time: Array  # as measured, shape (n,)
    position: Array  # as measured, shape (n,)
    target: Array  # of the log, shape (n,)
    run: Run  # for the controller as given
    motion: tuple[Array, Array]  # measured position and velocity at its steps
    delay: float  # of the controller, s
    # quantities that distinguish kinds of logs, by name: metadata of the log, its motion, its load
    figures: dict[str, float | str]
    # s between restarts from the measured motion, if the drive was measured: such a drive does not
    # return a joint to its path. None: a controller follows the target
    window_s: float | None = None
    counts: NDArray[np.bool_] | None = None  # whether a sample is compared, shape (n,); None: all

    def changed(self, changes: Sequence[Change]) -> Run:
        """The same run with a controller changed by effects of the drive."""
        if not changes:
            return self.run
        block, delay = changed_controller(changes, self.run.block, self.delay)
        step = self.run.step
        steps = self.time[0] + step * np.arange(len(self.run.target)) - delay
        # of a delay that is not given no tick is known, either: the mean over all that it may be
        over = step if delay == self.delay else max(step, float(block[PERIOD]))
        target = held_over(self.time, self.target, steps - 0.5 * (over - step), over)
        return replace(self.run, block=block, target=target)

    def at_samples(self, position: Array) -> Array:
        """Simulated positions at the times of the log, shape (n,)."""
        steps = self.time[0] + self.run.step * np.arange(len(position))
        return np.interp(self.time, steps, position)


@dataclass(frozen=True)
class ClosedLoop:
    """Errors of simulated positions, one array per log, rad (m), with the simulated positions."""

    courses: tuple[Course, ...]
    simulated: tuple[Array, ...]

    @property
    def errors(self) -> tuple[Array, ...]:
        """Simulated minus measured."""
        pairs = zip(self.courses, self.simulated, strict=True)
        return tuple(x - course.position for course, x in pairs)

    @property
    def mae(self) -> float:
        """Mean absolute error over all samples."""
        return float(np.mean(np.abs(np.concatenate(self.errors))))

    @property
    def rms(self) -> float:
        """Root of the mean square over all samples."""
        return root_mean_square(np.concatenate(self.errors))

    @property
    def replay(self) -> Replay:
        """The logs as free runs, each from its measured first sample."""
        errors = tuple(np.concatenate([[np.nan], e[1:]]) for e in self.errors)
        return Replay(errors, max(float(np.ptp(course.position)) for course in self.courses))


def courses_of(
    logs: Sequence[JointLog], bodies: Sequence[RigidBody], controller: Controller
) -> tuple[Course, ...]:
    """Logs, with a body each, prepared for simulation; LogError: a log has no target, or lacks
    metadata that the controller needs."""
    found = []
    for log, body in zip(logs, bodies, strict=True):
        if log.target is None:
            raise LogError(f"{log.name}: no target to follow, add target_rad")
        block, delay = block_of(controller, log), delay_of(controller)
        supply = supply_of(controller, log)
        found.append(_course(log, body, log.target, supply, block, delay, bodies.index(body)))
    return tuple(found)


def driven_courses(
    logs: Sequence[JointLog], bodies: Sequence[RigidBody], prepared: Prepared, window_s: float
) -> tuple[Course, ...]:
    """Logs, with a body each, prepared for simulation by their measured drive, with `window_s` s
    between restarts from the measured motion; `prepared` has the samples that count."""
    block, found = np.zeros(BLOCK), []
    block[MEASURED] = 1.0
    for log, body, segment in zip(logs, bodies, prepared.segments, strict=True):
        drive, supply = getattr(log, prepared.drive), np.ones_like(log.time)
        course = _course(log, body, drive, supply, block, 0.0, bodies.index(body))
        since = log.time - log.time[0]
        inside = np.interp(since, segment.signals[:, TIME], segment.mask.astype(float)) == 1.0
        window = (since / window_s).astype(int)
        whole = np.bincount(window, ~inside) == 0.0
        found.append(replace(course, window_s=window_s, counts=whole[window]))
    return tuple(found)


def _course(
    log: JointLog,
    body: RigidBody,
    target: Array,
    supply: Array,
    block: Array,
    delay: float,
    load: int,
) -> Course:
    """A log with its target, or a measured drive in its place, and its supply, shape (n,) each."""
    h = _step(log.duration, float(block[PERIOD]))
    steps = max(1, math.ceil(log.duration / h - _WHOLE))
    time = log.time[0] + h * np.arange(steps + 1)
    smooth = followed(log)
    others: dict[str, tuple[Array, Array, Array]] = {}
    for name, position in log.other_positions.items():
        if name in body.joint_names:
            track = differentiate(replace(log, position=position))
            triple = (track.position, track.velocity, track.acceleration)
            q, v, a = (np.interp(time, track.time, x) for x in triple)
            others[name] = q, v, a
    velocity = np.interp(time, smooth.time, smooth.velocity)
    on = np.ones(len(time), dtype=bool)
    if log.torque_enabled is not None:
        on = held(log.time, log.torque_enabled.astype(float), time) > 0.5
    start = first_velocity(log.time, log.position, block[COUNT])
    return Course(
        name=log.name,
        time=log.time,
        position=log.position,
        target=target,
        run=Run(
            step=h,
            target=(
                np.interp(time + 0.5 * h, log.time, target)
                if block[MEASURED]
                else held_over(log.time, target, time - delay, h)
            ),
            supply=held(log.time, supply, time),
            on=on,
            start=(float(log.position[0]), start),
            load=load_of(body, velocity, others),
            block=block,
            temperature=(
                None if log.temperature is None else np.interp(time, log.time, log.temperature)
            ),
        ),
        motion=(np.interp(time, smooth.time, smooth.position), velocity),
        delay=delay,
        figures={**log.metadata, "motion": log.motion, "load": float(load)},
    )


def _step(duration: float, period: float) -> float:
    """Longest step, s, that divides the sample time of the log and the controller's tick, if known.

    For a controller faster than the log, the step is a multiple of the tick.
    """
    if period == 0.0:
        return duration / max(1, math.ceil(duration / LONGEST_STEP - _WHOLE))
    if period > LONGEST_STEP:
        return period / math.ceil(period / LONGEST_STEP - _WHOLE)
    return period * math.floor(LONGEST_STEP / period + _WHOLE)


def load_of(
    body: RigidBody, velocity: Array, others: Mapping[str, tuple[Array, Array, Array]]
) -> Load:
    """Load of a joint at each step with a velocity, shape (n,), along the motion of other joints,
    their positions, velocities and accelerations by name; the same at all steps without them."""
    # every fourth step, and interpolated: the motion of other joints is smooth
    at = np.arange(0, len(velocity), 4)
    coarse = {name: (q[at], v[at], a[at]) for name, (q, v, a) in others.items()}
    v = velocity[at] if others else np.zeros(1)
    none, one = np.zeros(len(v)), np.ones(len(v))
    j = body.joint_id
    stiffness = float(np.ravel(body.model.jnt_stiffness[j])[0])
    rest = float(body.model.qpos_spring[body.model.jnt_qposadr[j]])
    found = np.zeros((one_joint.ROWS, len(v)))
    turns = _TURNS if not body.slide else (0.0,)
    torques = [body.torque(np.full(len(v), q), v, none, coarse) for q in turns]
    found[one_joint.INERTIA] = body.torque(none, v, one, coarse).load - torques[0].load
    loads = [x.load - stiffness * (q - rest) for x, q in zip(torques, turns, strict=True)]
    if body.slide:
        found[one_joint.REST] = loads[0]
    else:
        rows = one_joint.REST, one_joint.COS, one_joint.SIN
        found[list(rows)] = _harmonic(loads)
        found[one_joint.GX : one_joint.GX + 3] = _harmonic([x.gx for x in torques])
        found[one_joint.GY : one_joint.GY + 3] = _harmonic([x.gy for x in torques])
    if len(v) > 1:
        found = np.array([np.interp(np.arange(len(velocity)), at, row) for row in found])
    return Load(found, body.armature, stiffness, rest)


def _harmonic(x: list[Array]) -> Array:
    """Mean, cosine and sine of a quantity known at `_TURNS`, shape (3, n)."""
    cosine = sum(2.0 / 3.0 * math.cos(q) * y for q, y in zip(_TURNS, x, strict=True))
    sine = sum(2.0 / 3.0 * math.sin(q) * y for q, y in zip(_TURNS, x, strict=True))
    return np.array([(x[0] + x[1] + x[2]) / 3.0, cosine, sine])


def joint_model(fitted: Fit) -> JointModel:
    """A fitted model in the form that a simulation runs."""
    motor = motor_of(fitted)
    return JointModel(
        law_parameters(fitted),
        simulated_effects(fitted),
        motor.gain if motor else 1.0,
        motor.back_emf if motor else 0.0,
        inertia_error(fitted),
        max(0.0, late_by(fitted.terms)),
    )


def closed_loop(courses: Sequence[Course], fitted: Fit) -> ClosedLoop:
    """Simulate whole logs with a fitted model."""
    model, changes = joint_model(fitted), drive_changes(fitted.terms)
    found = [c.at_samples(simulate(model, c.changed(changes))) for c in courses]
    return ClosedLoop(tuple(courses), tuple(found))


def found_controller(controller: Controller, fitted: Fit, scaled: bool) -> Controller:
    """The controller with the values found by a fit, also of an unknown kp if it is `scaled`: the
    logs determine the torque of the drive."""
    found: dict[str, Any] = {}
    for term in changing_drive(fitted.terms):
        found |= term.figures(replace(controller, **found))
    if scaled and fitted.over_kp:
        # what was found of an output over kp is of the whole output now
        for name in ("limit", "drop_above"):
            if name in found and (name == "limit" or found["drop_of"] == "output"):
                found[name] *= float(fitted.gain)
        found["kp"] = float(fitted.gain) / controller.gain_unit
    return replace(controller, **found)


@dataclass(frozen=True)
class LoopErrors:
    """Errors of whole logs in closed loop, fitted and held out."""

    fit: ClosedLoop | None
    held_out: ClosedLoop | None

    @property
    def mae(self) -> Rms:
        """Mean absolute position errors, rad (m)."""
        return Rms(*(None if x is None else x.mae for x in (self.fit, self.held_out)))

    @property
    def rms(self) -> Rms:
        """Roots of the mean square."""
        return Rms(*(None if x is None else x.rms for x in (self.fit, self.held_out)))

    def figures(self) -> dict[str, Rms]:
        """Both errors by their keys in report.json."""
        return {"closed_loop_mae": self.mae, "closed_loop_rms": self.rms}

    @property
    def replays(self) -> "tuple[Replay, Replay | None]":
        """Fitted and held-out logs as free runs, one run per log."""
        assert self.fit is not None
        return self.fit.replay, self.held_out.replay if self.held_out else None


@dataclass(frozen=True)
class Loops:
    """Fitted and held-out logs prepared for simulation."""

    fit: tuple[Course, ...]
    held_out: tuple[Course, ...]

    @classmethod
    def of(
        cls, pairs: Sequence[tuple[Sequence[JointLog], Sequence[RigidBody]]], controller: Controller
    ) -> "Loops | None":
        """From logs and their bodies; None if a log has no target."""
        if any(log.target is None for logs, _ in pairs for log in logs):
            return None
        return cls(*(courses_of(logs, bodies, controller) for logs, bodies in pairs))

    def errors(self, fits: Sequence[Fit]) -> tuple[LoopErrors, ...]:
        """Errors of each model."""
        return tuple(
            LoopErrors(*(closed_loop(c, f) if c else None for c in (self.fit, self.held_out)))
            for f in fits
        )
