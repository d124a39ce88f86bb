"""Replay: MuJoCo simulations restarted from measured states and driven by the measured torque."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.effects.motor import SATURATION
from frictionjoint.effects.signals import TEMP, TIME, Q
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.fixed_joints import lock, take_pose
from frictionjoint.identify.result import law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rms import Rms
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.terms import EffectTerm, Term, changed_drive, delay_of
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.mujoco_warnings import unheard
from frictionjoint.replay.windows import Windows
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.block import ASSUMED, remove_assumed
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.mechanism import deflection
from frictionjoint.simulate.motor import Motor, add_motor


@dataclass(frozen=True)
class Replay:
    """Free runs of a model."""

    # of position, m or rad, per log; NaN where nothing was simulated, infinite in unstable runs
    errors: tuple[Array, ...]
    travel: float  # largest measured travel of a log, m or rad

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
    return [
        SimulatedEffect(term.effect, term.shape, tuple(fitted.term_coefficients(i).tolist()))
        for i, term in enumerate(fitted.terms)
        if isinstance(term, EffectTerm)
        and not (term.effect.opposes_voltage or term.effect.is_inertia or term.effect.drive)
    ]


def friction_of(fitted: Fit) -> JointFriction:
    """Law and effects of a fit, in the form in which a model contains them."""
    return JointFriction(law_parameters(fitted), tuple(simulated_effects(fitted)))


def motor_of(fitted: Fit) -> Motor | None:
    """The motor of a fit to voltages or currents; None if the torque was measured.

    It includes its saturation, for runs in which its torque is applied directly.
    """
    if fitted.drive == "torque":
        return None
    emf = saturation = 0.0
    for i, term in enumerate(fitted.terms):
        if term.effect.opposes_voltage:
            emf = float(fitted.term_coefficients(i)[0])
        elif isinstance(term, EffectTerm) and term.effect is SATURATION:
            saturation = float(fitted.term_coefficients(i)[0])
    return Motor(fitted.gain, emf, fitted.drive, saturation)


def inertia_error(fitted: Fit) -> float:
    """Inertia at the joint that the model lacks, kg m^2 (kg)."""
    at = [i for i, term in enumerate(fitted.terms) if term.effect.is_inertia]
    return sum(float(fitted.term_coefficients(i)[0]) for i in at)


def friction_spec(spec: mujoco.MjSpec, joint: str, fitted: Fit) -> None:
    """Put a fitted model into a spec: law, effects, armature, and the motor of a voltage-driven
    joint. Native friction of the joint is removed."""
    target = spec.joint(joint)
    target.frictionloss = 0.0
    target.damping = np.zeros_like(target.damping)
    # never below nothing: the rest of a negative error is beyond what armature can say
    target.armature = max(0.0, float(target.armature) + inertia_error(fitted))
    motor = motor_of(fitted)
    # the torque of a controller whose kp was found needs no motor, as that of a known one
    if motor and not fitted.over_kp:
        add_motor(spec, joint, motor)
    install(spec, {joint: law_parameters(fitted)}, {joint: simulated_effects(fitted)})
    _say_what_is_assumed(spec, joint, fitted)


def _say_what_is_assumed(spec: mujoco.MjSpec, joint: str, fitted: Fit) -> None:
    """Write the assumptions into the model as text; the text of an earlier fit is replaced."""
    remove_assumed(spec, joint)
    shape = fitted.shape
    parts = {
        "the Coulomb friction without load": fitted.level_assumed,
        "the stiffness before sliding": shape.stiffness_assumed,
        "the beginning of the presliding curve": shape.steep_start and not shape.stiffness_assumed,
        "the breakaway friction": shape.breakaway_assumed,
    }
    assumed = [what for what, is_assumed in parts.items() if is_assumed]
    if assumed:
        text = spec.add_text()
        text.name = f"{ASSUMED}{joint}"
        text.data = f"assumed: {', '.join(assumed)}"


def replayed_whole(
    prepared: Prepared, body: RigidBody | Sequence[RigidBody], fitted: Fit
) -> Array | None:
    """Mean square error of each free run, m^2 or rad^2, (k,); None if the simulation does not
    contain the whole fit, see `simulated_whole`."""
    armature = (body if isinstance(body, RigidBody) else body[0]).armature
    if not simulated_whole(fitted, armature):
        return None
    return replay(prepared, body, fitted).runs


def simulated_whole(fitted: Fit, armature: float, in_closed_loop: bool = False) -> bool:
    """Whether a simulation that starts from measured motion can represent the whole fit.

    No log shows on which side of a gap a link is at the start of a run. Behind a spring, the state
    of the link follows from the earlier motion. A negative armature cannot be simulated.

    Args:
        armature: of the MJCF.
        in_closed_loop: whether `one_joint` runs the simulation, whose motor weakens as it warms and
            which has no link behind the joint.
    """
    for i, term in enumerate(fitted.terms):
        if not isinstance(term, EffectTerm):
            continue
        less = term.effect.is_inertia and fitted.term_coefficients(i)[0] < -armature
        weaker = term.effect.on_motor and TEMP in term.effect.needs and not in_closed_loop
        behind = term.effect.acts == "mechanism" and (term.effect.leaps or in_closed_loop)
        if less or weaker or behind:
            return False
    return True


def replay(prepared: Prepared, body: RigidBody | Sequence[RigidBody], fitted: Fit) -> Replay:
    """Simulate the windows of all logs of one joint with their body, or one per log."""
    bodies = [body] * len(prepared) if isinstance(body, RigidBody) else body
    found: list[Array] = []
    for one, some in itertools.groupby(
        zip(bodies, prepared.segments, strict=True), key=lambda pair: pair[0]
    ):
        logs = [{one.joint: segment} for _, segment in some]
        found += replay_joints(one.spec(), logs, {one.joint: fitted}, one.named_poses).errors
    return Replay(tuple(found), max(float(np.ptp(s.signals[:, Q])) for s in prepared.segments))


def replay_joints(
    spec: mujoco.MjSpec,
    logs: Sequence[Mapping[str, Segment]],
    fits: Mapping[str, Fit],
    poses: Mapping[str, Sequence[float]],
) -> Replay:
    """Simulate the windows of all logs, each with its driven joints, all joints together; the spec
    gets their friction, and joints that no log contains are in their poses."""
    for joint, fitted in fits.items():
        friction_spec(spec, joint, fitted)
    model = spec.compile()
    take_pose(model, {model.joint(name).id: np.array(pose) for name, pose in poses.items()})
    lock(model, *(model.joint(name).id for name in fits), *(deflection(model, n) for n in fits))
    off = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.opt.disableflags |= int(off)
    motors = {joint: motor_of(fitted) for joint, fitted in fits.items()}
    found: list[Array] = []
    with attach(model), unheard():
        for log in logs:
            driven = {n: _acting(s, fits[n].terms) for n, s in log.items()}
            found.extend(Windows(model, driven, motors).errors().T)
    travel = max(float(np.ptp(s.signals[:, Q])) for log in logs for s in log.values())
    return Replay(tuple(found), travel)


def _acting(segment: Segment, terms: tuple[Term, ...]) -> Segment:
    """A log with the drive that acted at each measured position: as effects of the drive have
    changed it, and as much earlier as the position is logged late."""
    found, time = changed_drive(segment, terms), segment.signals[:, TIME]
    return replace(found, drive=np.interp(time - delay_of(terms), time, found.drive))
