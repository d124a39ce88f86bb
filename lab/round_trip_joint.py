"""The round trip of an effect of the joint, on test joints of `lab/plants`; see `round_trip`."""

from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np
from plants import motion
from plants.draw import draw_trial
from plants.loop import INDEX
from plants.plant import assemble, constants, simulate, write
from plants.spec import PlantSpec

from frictionjoint.diagnose.candidate import columns_of, signals_of
from frictionjoint.diagnose.library import effect_terms
from frictionjoint.diagnose.spectrum import periodic_terms
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.effect import Effect
from frictionjoint.identify.base_fit import with_last_freedoms
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import Estimate, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.identify.weights import reweighed
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log
from frictionjoint.replay.free_runs import friction_spec, motor_of, replay, replayed_whole
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import load_model
from frictionjoint.simulate.thermal import set_temperature

SATURATION = "motor-saturation"
# A test joint each, by the seed it is drawn from
PLANTS = {
    "torque-bias": 1,
    "inertia-error": 1,
    "gravity-error": 1,
    "torque-gain": 1,
    "spring": 1,
    "load-dependent": 1,
    "position-periodic": 1,
    "nonlinear-viscous": 1,
    "direction-asymmetry": 1,
    "temperature-dependent": 1,
    "warm-up-drift": 1,
    "measurement-delay": 2,
    "joint-elasticity": 1,
    "backlash": 1,
    "frictional-lag": 1,
    "dwell-time": 2,
    "end-stop": 1,
    "back-emf": 1,
    SATURATION: 1,
}
# they show in minutes
SLOW = ("temperature-dependent", "warm-up-drift")
MECHANISMS = ("joint-elasticity", "backlash")
# candidates that are tried
_BEST = 3
_TICK = 1e-3
# of the motor that saturates: N m/A, and the part of its largest torque that it loses
_KT, _LOST = 0.5, 0.3


@dataclass(frozen=True)
class Trip:
    """One way round.

    Attributes:
        name: of the effect. again: what the search named on the simulated log.
        first, second: numbers of the effect by name, of the test joint's log and of the model's.
        left, left_again: rms of the torque that the fits leave, N m.
        before, after: rms error of free runs along the plant's logs, without the effect and with
            it, rad; again_free: of the second model along the first one's; None where a log does
            not hold where a run begins.
    """

    name: str
    again: tuple[str, ...]
    first: dict[str, Estimate]
    second: dict[str, Estimate]
    left: float
    left_again: float
    before: float | None
    after: float | None
    again_free: float | None

    @property
    def errors(self) -> dict[str, float]:
        """By name, change of the numbers in standard errors of the second fit."""
        return {
            key: abs(self.second[key].value - x.value) / self.second[key].stderr
            for key, x in self.first.items()
            if key in self.second and self.second[key].stderr and x.stderr
        }


def plant(name: str, seconds: float, seed: int = 0) -> PlantSpec:
    """Two short logs of a LuGre joint that has the effect."""
    kind = "none" if name == SATURATION else f"one:{name}"
    spec = draw_trial(np.random.default_rng(PLANTS[name] + seed), kind)
    return replace(
        spec,
        motions=tuple(replace(m, duration=seconds) for m in spec.motions[:2]),
        instrument=replace(spec.instrument, rate=250.0, jitter=0.0),
        friction=replace(spec.friction, law="lugre"),
    )


def nominated(prepared: Prepared, name: str, form: int | None = None) -> tuple[Prepared, Fit, Fit]:
    """The logs with their weights, the fit without the effect, and with it, from its best shape.

    Weights and initial states follow from the fit, as in `base_fit`: samples in which the joint
    sticks would bias the law.
    """
    base = fit(prepared)
    signals = signals_of(prepared, base)
    terms = [
        *effect_terms(prepared, signals, ()),
        *periodic_terms(prepared, signals, base, make_blocks(prepared, base))[0],
    ]
    own = [t for t in terms if t.name == name and form in (None, t.effect.effect_id)]
    gains = [_gain(base, columns_of(prepared, signals, t)) for t in own]
    best: list[Term] = [own[i] for i in np.argsort(gains)[::-1][:_BEST]]
    fits = [refit(prepared, (t,), base.shape, ROUGH) for t in best]
    nearest = min(fits, key=lambda f: f.drive_rms)
    # the law without the effect was bent by it, and leads to no better one from there
    again = (fit(prepared, nearest.effects), refit(prepared, nearest.effects, nearest.shape))
    best_fit = min(again, key=lambda f: f.drive_rms)
    prepared, best_fit = reweighed(*settled(*reweighed(prepared, best_fit)))
    prepared, found = with_last_freedoms(prepared, best_fit)
    return prepared, base, found


def _gain(base: Fit, columns: np.ndarray) -> float:
    """Squares of the residual that columns take away next to the law's own sensitivities."""
    J = np.column_stack([base.free_jacobian, columns]) * base.weight[:, None]
    e = base.residual * base.weight
    J = J / (np.linalg.norm(J, axis=0) + 1e-300)
    return float(np.sum((J @ np.linalg.lstsq(J, e, rcond=1e-10)[0]) ** 2))


def searched(prepared: Prepared) -> tuple[Prepared, Fit, Fit]:
    """The logs with their weights, begin and end of the whole search."""
    found = trace(prepared)
    return found.prepared, found.base, found.final


def form_of(found: Fit, name: str) -> Effect | None:
    """The form in which an effect is in a fit."""
    effects = (t.effect for t in found.terms if isinstance(t, EffectTerm) and t.name == name)
    return next(effects, None)


def numbers(prepared: Prepared, found: Fit, name: str) -> dict[str, Estimate]:
    """Of the named effect in a fit, or nothing."""
    cov = stated_covariance(prepared, found)
    for i, term in enumerate(found.terms):
        if isinstance(term, EffectTerm) and term.name == name:
            return term_estimates(found, cov, i, prepared.slide)
    return {}


def saturated(spec: PlantSpec, torque: np.ndarray) -> np.ndarray:
    """Current of a motor that gives a torque, A: it takes more than in proportion."""
    largest = spec.gravity_torque + 2.0 * spec.friction.Fs
    return np.asarray((torque + _LOST * torque * (torque / largest) ** 2) / _KT)


def plant_logs(name: str, spec: PlantSpec, folder: Path) -> list[JointLog]:
    """The plant's logs; that of a saturating motor holds its current in place of its torque."""
    logs = [read_log(path, "joint") for path in write(simulate(spec), folder)]
    if name != SATURATION:
        return logs
    return [replace(x, torque=None, current=saturated(spec, x.torque)) for x in logs]


def model_log(path: Path, name: str, spec: PlantSpec, number: int, like: JointLog) -> JointLog:
    """Log `number` of a written model under the plant's controller, with the plant's instruments.

    Args:
        like: the test joint's own log; a joint whose temperature counts is as warm as it was there.
    """
    c = constants(assemble(spec), number)
    drive = next(x for x in ("torque", "voltage", "current") if getattr(like, x) is not None)
    kp, ki, kd, limit, volts = (c[INDEX[k]] for k in ("kp", "ki", "kd", "limit", "voltage"))
    model = load_model(path)
    # a spring's damping is taken at one end of a step, which moves its resonance
    longest = spec.step if name in MECHANISMS else _TICK
    model.opt.timestep = _TICK / round(_TICK / min(model.opt.timestep, longest))
    wanted = motion.target(spec.motions[number], _TICK)
    every = round(1.0 / (spec.instrument.rate * _TICK))
    warm = None
    if like.temperature is not None:
        at = _TICK * np.arange(len(wanted))
        warm = np.interp(at, like.time - like.time[0], like.temperature)
    data = mujoco.MjData(model)
    joint = model.joint("joint")
    q, v = int(joint.qposadr[0]), int(joint.dofadr[0])
    integral, speed, rows = 0.0, 0.0, []
    with attach(model):
        for k, target in enumerate(wanted):
            error = target - data.qpos[q]
            speed += 0.3 * (data.qvel[v] - speed)
            integral += ki * error * _TICK
            command = min(max(kp * error + integral - kd * speed, -limit), limit)
            data.ctrl[-1] = saturated(spec, command) if name == SATURATION else command
            mujoco.mj_forward(model, data)
            if k % every == 0:
                if warm is not None:
                    set_temperature(model, data, "joint", warm[k])
                read = data.sensor("joint_torque").data[0] if drive == "torque" else data.ctrl[-1]
                heat = 0.0 if warm is None else warm[k]
                rows.append([data.time, data.sensor("joint_position").data[0], read, heat])
            while data.time < (k + 1) * _TICK - 1e-9:
                mujoco.mj_step(model, data)
    time, position, drives, heat = np.array(rows).T
    count = 2.0 * np.pi / spec.instrument.counts
    noise = np.random.default_rng(number).normal(0.0, spec.instrument.torque_noise, len(time))
    return JointLog(
        name=f"model{number}",
        joint="joint",
        time=time,
        position=np.round(position / count) * count,
        temperature=None if warm is None else heat,
        **{drive: drives + noise / {"torque": 1.0, "voltage": volts, "current": _KT}[drive]},
    )


def write_model(path: Path, mjcf: Path, found: Fit) -> None:
    """The fitted model with a motor and with sensors, late where the effect says so."""
    spec = mujoco.MjSpec.from_file(str(mjcf))
    friction_spec(spec, "joint", found)
    if motor_of(found) is None:
        spec.add_actuator(name="drive", target="joint", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    have = {s.name for s in spec.sensors}
    for kind, name in (
        (mujoco.mjtSensor.mjSENS_JOINTPOS, "joint_position"),
        (mujoco.mjtSensor.mjSENS_JOINTACTFRC, "joint_torque"),
    ):
        if name not in have:
            of = mujoco.mjtObj.mjOBJ_JOINT
            spec.add_sensor(name=name, type=kind, objtype=of, objname="joint")
    spec.compile()
    path.write_text(spec.to_xml())


def joint_trip(
    name: str, folder: Path, seconds: float, search: bool = False, seed: int = 0
) -> Trip:
    """There and back with one effect's test joint.

    Args:
        folder: to write into. seconds: of each of two logs. search: the whole search names the
            effect, else it is fitted. seed: added to the test joint's.
    Raises:
        ValueError: the first fit or search has not found the effect.
    """
    spec = plant(name, seconds, seed)
    body_path = folder / "joint.xml"
    logs = plant_logs(name, spec, folder)
    body = RigidBody(body_path, "joint")
    first_logs = prepare(logs, body)
    first_logs, base, found = searched(first_logs) if search else nominated(first_logs, name)
    first = numbers(first_logs, found, name)
    if not first:
        raise ValueError(f"{name} was not found on the plant: {_names(found)}")
    path = folder / "model.xml"
    write_model(path, body_path, found)
    second_logs = prepare([model_log(path, name, spec, i, x) for i, x in enumerate(logs)], body)
    form = form_of(found, name)
    second_logs, _, refound = (
        searched(second_logs)
        if search
        else nominated(second_logs, name, form.effect_id if form else None)
    )
    return Trip(
        name,
        _names(refound),
        first,
        numbers(second_logs, refound, name),
        found.rms,
        refound.rms,
        free_error(first_logs, body, base),
        free_error(first_logs, body, found),
        free_error(second_logs, body, refound),
    )


def _names(found: Fit) -> tuple[str, ...]:
    return tuple(t.name for t in found.effects)


def free_error(prepared: Prepared, body: RigidBody, found: Fit) -> float | None:
    """Rms position error of a fit's free runs, rad; None where they do not hold all of it.

    Where a link behind a spring or a gap is at their beginning follows from the motion before.
    """
    if any(isinstance(t, EffectTerm) and t.effect.acts == "mechanism" for t in found.terms):
        return replay(prepared, body, found).rms
    runs = replayed_whole(prepared, body, found)
    return float(np.sqrt(np.mean(runs))) if runs is not None and runs.size else None
