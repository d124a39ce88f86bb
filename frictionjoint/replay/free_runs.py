"""Replay: MuJoCo simulations restarted from measured states and driven by the measured torque.

Every half second of the log the joint is set to its measured state, with the friction memory that
the law has after the measured motion so far, and runs freely until the next restart. Other joints
of an arm follow their measured motion. A voltage-driven joint is driven by the measured voltage;
where the log says that its motor is off, no motor acts.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.motor_saturation import EFFECT as SATURATION
from frictionjoint.effects.signals import TEMP, A, Q, V
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.terms import EffectTerm, changed_drive
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.mujoco_warnings import became_unstable, unheard
from frictionjoint.replay.prescribed_motion import Free, Prescribed
from frictionjoint.simulate.assumption_text import ASSUMED, remove_assumed
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.block import ROW as ROW_SLOT
from frictionjoint.simulate.carrier import install, resolve
from frictionjoint.simulate.mechanism import deflection
from frictionjoint.simulate.motor import Motor, add_motor

WINDOW_S = 0.5
# Fine enough for presliding at usual stiffness; a log sampled finer than this sets the step.
_LONGEST_STEP = 1e-3


@dataclass(frozen=True)
class Replay:
    """Free runs of a model.

    Attributes:
        errors: position error, m or rad, one array per log, NaN where nothing was simulated,
            infinite in runs that became unstable.
        travel: largest measured travel of a log, m or rad.
    """

    errors: tuple[Array, ...]
    travel: float

    @property
    def rms(self) -> float | None:
        """Over all logs; None if there is no run."""
        e = np.concatenate(self.errors) if self.errors else np.zeros(0)
        e = e[~np.isnan(e)]
        return root_mean_square(e) if e.size else None

    @property
    def runs(self) -> Array:
        """Mean square error of each free run, limited to the square of the travel, shape (k,)."""
        found = []
        for e in self.errors:
            inside = ~np.isnan(e)
            run = np.cumsum(~inside)[inside]
            if run.size:
                count = np.bincount(run)
                squares = np.bincount(run, np.minimum(e[inside] ** 2, self.travel**2))
                found.append(squares[count > 0] / count[count > 0])
        return np.concatenate([*found, np.zeros(0)])

    @property
    def diverges(self) -> bool:
        """Whether the runs leave the measured motion by more than its whole travel."""
        return self.rms is not None and self.rms > self.travel

    @property
    def stated(self) -> float | None:
        """The rms for the report; None if the runs diverge, because it has no meaning then."""
        return None if self.diverges else self.rms


def replay_rms(fit: Replay, held_out: Replay | None) -> Rms:
    """rms for the report, of fitted and held-out logs."""
    return Rms(fit.stated, held_out.stated if held_out else None)


def simulated_effects(fitted: Fit) -> list[SimulatedEffect]:
    """The fit's effects in the form in which a model contains them.

    An inertia error becomes armature, back-EMF becomes part of the motor. A saturation stays an
    effect: the callback subtracts it from the actuator force.
    """
    found = []
    for i, term in enumerate(fitted.terms):
        if isinstance(term, EffectTerm) and not (
            term.effect.opposes_voltage or term.effect.is_inertia or term.effect.drive
        ):
            values = tuple(float(x) for x in fitted.term_coefficients(i))
            found.append(SimulatedEffect(term.effect, term.shape, values))
    return found


def motor_of(fitted: Fit) -> Motor | None:
    """The motor of a fit to voltages or currents; None if the torque was measured.

    It includes its saturation, for runs in which its torque is applied directly.
    """
    if fitted.drive == "torque":
        return None
    emf = saturation = 0.0
    for i, term in enumerate(fitted.terms):
        if term.opposes_voltage:
            emf = float(fitted.term_coefficients(i)[0])
        elif isinstance(term, EffectTerm) and term.effect is SATURATION:
            saturation = float(fitted.term_coefficients(i)[0])
    return Motor(fitted.gain, emf, fitted.drive, saturation)


def friction_spec(spec: mujoco.MjSpec, joint: str, fitted: Fit) -> None:
    """Put a fitted model into a spec: law, effects, armature, and the motor of a voltage-driven
    joint.

    Native friction of the joint is removed.
    """
    target = spec.joint(joint)
    target.frictionloss = 0.0
    target.damping = np.zeros_like(target.damping)
    for i, term in enumerate(fitted.terms):
        if isinstance(term, EffectTerm) and term.effect.is_inertia:
            # never below nothing: the rest of a negative error is beyond what armature can say
            extra = float(fitted.term_coefficients(i)[0])
            target.armature = max(0.0, float(target.armature) + extra)
    motor = motor_of(fitted)
    # the torque of a controller whose kp was found needs no motor, as that of a known one
    if motor and not fitted.over_kp:
        add_motor(spec, joint, motor)
    install(spec, {joint: law_parameters(fitted)}, {joint: simulated_effects(fitted)})
    _say_what_is_assumed(spec, joint, fitted)


def _say_what_is_assumed(spec: mujoco.MjSpec, joint: str, fitted: Fit) -> None:
    """Write the assumptions into the model as text; the text of an earlier fit is replaced."""
    remove_assumed(spec, joint)
    if fitted.shape.assumed or fitted.shape.damping:
        what = "stiffness" if fitted.shape.assumed else "damping"
        text = spec.add_text()
        text.name, text.data = f"{ASSUMED}{joint}", f"the {what} before sliding is assumed"


def replayed_whole(
    prepared: Prepared, body: RigidBody | Sequence[RigidBody], fitted: Fit
) -> Array | None:
    """Mean square error of each free run, if the simulation contains the whole fit; m^2 or rad^2,
    (k,).

    Returns:
        None if the simulation does not contain the whole fit, see `simulated_whole`. A replay does
            not represent the delay of a log either.
    """
    armature = (body if isinstance(body, RigidBody) else body[0]).armature
    late = any(isinstance(term, EffectTerm) and term.delay for term in fitted.terms)
    if late or not simulated_whole(fitted, armature):
        return None
    return replay(prepared, body, fitted).runs


def simulated_whole(fitted: Fit, armature: float, in_closed_loop: bool = False) -> bool:
    """Whether a simulation that starts from measured motion can represent the whole fit.

    No log shows on which side of a gap a link is at the start of a run. Behind a spring, the state
    of the link follows from the earlier motion. A negative armature cannot be simulated.

    Args:
        armature: of the MJCF.
        in_closed_loop: whether `one_joint` runs the simulation, which knows the temperature of the
            log and has no link behind the joint.
    """
    for i, term in enumerate(fitted.terms):
        if not isinstance(term, EffectTerm):
            continue
        less = term.effect.is_inertia and fitted.term_coefficients(i)[0] < -armature
        warmer = TEMP in term.effect.needs and not in_closed_loop
        behind = term.effect.acts == "mechanism" and (term.effect.leaps or in_closed_loop)
        if less or warmer or behind:
            return False
    return True


def replay(prepared: Prepared, body: RigidBody | Sequence[RigidBody], fitted: Fit) -> Replay:
    """Simulate the windows of all logs.

    Args:
        body: that the logs were prepared with, or one per log.
    """
    bodies = [body] * len(prepared) if isinstance(body, RigidBody) else body
    found: list[Array] = []
    for one, some in itertools.groupby(
        zip(bodies, prepared.segments, strict=True), key=lambda pair: pair[0]
    ):
        found += _of_body(one, [segment for _, segment in some], fitted)
    return Replay(tuple(found), max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments))


def _of_body(body: RigidBody, segments: list[Segment], fitted: Fit) -> list[Array]:
    """Errors of the logs that belong to one MJCF."""
    # with what effects of the drive have made of it
    segments = [changed_drive(s, fitted.terms) for s in segments]
    spec = body.spec()
    friction_spec(spec, body.joint, fitted)
    model = spec.compile()
    body.hold(model)
    off = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.opt.disableflags |= int(off)
    motor = motor_of(fitted)
    with attach(model), unheard():
        return [_one_log(model, body, s, motor) for s in segments]


def _one_log(
    model: mujoco.MjModel, body: RigidBody, segment: Segment, motor: Motor | None
) -> Array:
    data = mujoco.MjData(model)
    substeps = max(1, int(np.ceil(segment.dt / _LONGEST_STEP)))
    model.opt.timestep = segment.dt / substeps
    q, v = segment.signals[:, Q], segment.signals[:, V]
    joints = [body.joint_id]
    qpos, dof = int(model.jnt_qposadr[body.joint_id]), int(model.jnt_dofadr[body.joint_id])
    ours = _row(model, body.joint)
    link = deflection(model, body.joint)
    free = Free(model, data, joints if link < 0 else [*joints, link])
    others = Prescribed.of(model, data, segment)
    memory = _memories(model, data, segment, qpos, dof, ours, link)
    errors = np.full(len(q), np.nan)
    length = max(2, round(WINDOW_S / segment.dt))
    for begin in range(0, len(q) - length, length):
        window = slice(begin, begin + length)
        if not segment.mask[window].all():
            continue
        data.time = begin * segment.dt
        data.qpos[qpos], data.qvel[dof] = q[begin], v[begin]
        data.userdata[ours], ahead = memory[begin // length]
        if link >= 0:
            data.qpos[model.jnt_qposadr[link]], data.qvel[model.jnt_dofadr[link]] = ahead
        for k in range(begin, begin + length - 1):
            if others:
                others.put(k)
            for i in range(substeps):
                part = i / substeps
                now = (1 - part) * segment.drive[k] + part * segment.drive[k + 1]
                if motor:
                    now = motor.torque(now, data.qvel[dof]) if segment.driven[k] else 0.0
                if others:
                    free.step(now)
                    data.time += free.dt
                else:
                    data.qfrc_applied[dof] = now
                    mujoco.mj_step(model, data)
            errors[k + 1] = data.qpos[qpos] - q[k + 1]
        if became_unstable(data):
            errors[begin + 1 : begin + length] = np.inf
            mujoco.mj_resetData(model, data)
    return errors


def _row(model: mujoco.MjModel, joint: str) -> slice:
    block = resolve(model)[joint]
    start = int(model.numeric_data[block + ROW_SLOT])
    return slice(start, model.nuserdata)


def _memories(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    segment: Segment,
    qpos: int,
    dof: int,
    ours: slice,
    link: int,
) -> list[tuple[Array, tuple[float, float]]]:
    """State rows at the restarts, from the callback driven along the measured motion.

    Each comes with position and velocity of the joint `link` behind an elastic one, which is driven
    along as well.
    """
    rows = []
    # samples, not steps of a simulation: a gap of several time steps would start the memory afresh
    step, model.opt.timestep = model.opt.timestep, segment.dt
    behind = Free(model, data, [link]) if link >= 0 else None
    length = max(2, round(WINDOW_S / segment.dt))
    for k in range(len(segment.signals)):
        data.time = k * segment.dt
        data.qpos[qpos] = segment.signals[k, Q]
        data.qvel[dof] = segment.signals[k, V]
        if k == 0:
            mujoco.mj_forward(model, data)
        else:
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
        ahead = (0.0, 0.0)
        if link >= 0:
            to, rate = model.jnt_qposadr[link], model.jnt_dofadr[link]
            ahead = float(data.qpos[to]), float(data.qvel[rate])
        if k % length == 0:
            rows.append((data.userdata[ours].copy(), ahead))
        if behind:
            data.qacc[dof] = segment.signals[k, A]
            behind.step(0.0)
    model.opt.timestep = step
    return rows
