"""What is named is simulated: identify, write model.xml, simulate it, identify again.

    python scripts/round_trip.py [--effects NAME...] [--search] [--seconds 12] > table.md

For each effect a plant that has it (`tests/plants`: MuJoCo's own parts, a LuGre joint) is logged.
A fit with the effect, or with --search the whole search, gives a model; the model is written as an
MJCF, loaded, and moved along the same targets by the same controller, its log taken from its own
sensors. The same fit of that log, of the effect in the same form, should give the same numbers.
Errors are in standard errors of the second fit; those of the first are the plant's, which no model
need share. Both models are run freely along their logs, half a second at a time: with the torque
that the fits leave, the plant's runs may err as the model's own, times the ratio of what is left.
"""

import argparse
import sys
import tempfile
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))  # tests.plants
from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.intervals import stated_covariance
from frictionjoint.diagnose.library import columns_of, effect_terms, periodic_terms, signals_of
from frictionjoint.diagnose.replay import friction_spec, motor_of, replayed_whole
from frictionjoint.diagnose.trace import trace
from frictionjoint.identify.fit import Fit, refit
from frictionjoint.identify.prepare import Prepared, prepare
from frictionjoint.identify.result import Estimate, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm, Term
from frictionjoint.measured.readers import read_log
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import load_model
from tests.plants import motion
from tests.plants.draw import draw_trial
from tests.plants.plant import simulate, write
from tests.plants.spec import PlantSpec

# A plant each, by the seed it is drawn from; slow effects need longer logs.
PLANTS = {
    "torque-bias": 1,
    "inertia-error": 1,
    "gravity-error": 1,
    "torque-gain": 1,
    "spring": 1,
    "load-dependent": 1,
    "position-periodic": 1,
    "nonlinear-viscous": 1,
    "warm-up-drift": 1,
    "measurement-delay": 2,
    "joint-elasticity": 1,
    "backlash": 1,
    "frictional-lag": 1,
    "dwell-time": 2,
    "end-stop": 1,
}
# candidates that are refined
_BEST = 3
_TICK = 1e-3


@dataclass(frozen=True)
class Trip:
    """One way round.

    Attributes:
        name: of the effect. again: what the search named on the simulated log.
        first, second: numbers of the effect by name, of the plant's log and of the model's.
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


def plant(name: str, seed: int, seconds: float) -> PlantSpec:
    """Two short logs of a LuGre joint that has the effect."""
    spec = draw_trial(np.random.default_rng(seed), f"one:{name}")
    return replace(
        spec,
        motions=tuple(replace(m, duration=seconds) for m in spec.motions[:2]),
        instrument=replace(spec.instrument, rate=250.0, jitter=0.0),
        friction=replace(spec.friction, law="lugre"),
    )


def nominated(prepared: Prepared, name: str, form: int | None = None) -> tuple[Fit, Fit]:
    """The fit without the effect, and with it, in one form or any, from the best of its shapes."""
    base = fit(prepared)
    signals = signals_of(prepared, base)
    terms = [
        *effect_terms(prepared, signals, ()),
        *periodic_terms(prepared, signals, base, make_blocks(prepared, base))[0],
    ]
    own = [t for t in terms if t.name == name and form in (None, t.effect.effect_id)]
    gains = [_gain(base, columns_of(prepared, signals, t)) for t in own]
    best: list[Term] = [own[i] for i in np.argsort(gains)[::-1][:_BEST]]
    fits = [refit(prepared, (t,), base.shape) for t in best]
    return base, min(fits, key=lambda f: f.drive_rms)


def _gain(base: Fit, columns: np.ndarray) -> float:
    """Squares of the residual that columns take away beside the law's own sensitivities."""
    J = np.column_stack([base.free_jacobian, columns]) * base.weight[:, None]
    e = base.residual * base.weight
    J = J / (np.linalg.norm(J, axis=0) + 1e-300)
    return float(np.sum((J @ np.linalg.lstsq(J, e, rcond=1e-10)[0]) ** 2))


def searched(prepared: Prepared) -> tuple[Fit, Fit]:
    """Begin and end of the whole search."""
    found = trace(prepared)
    return found.base, found.final


def form_of(found: Fit, name: str) -> int:
    """Number of the named effect in a fit."""
    return next(
        t.effect.effect_id for t in found.terms if isinstance(t, EffectTerm) and t.name == name
    )


def numbers(prepared: Prepared, found: Fit, name: str) -> dict[str, Estimate]:
    """Of the named effect in a fit, or nothing."""
    cov = stated_covariance(prepared, found)
    for i, term in enumerate(found.terms):
        if isinstance(term, EffectTerm) and term.name == name:
            return term_estimates(found, cov, i, prepared.slide)
    return {}


def model_log(path: Path, spec: PlantSpec, number: int, rng: np.random.Generator) -> np.ndarray:
    """Log `number` of a written model under the plant's controller: time, position, torque."""
    model = load_model(path)
    model.opt.timestep = _TICK / round(_TICK / min(model.opt.timestep, _TICK))
    data = mujoco.MjData(model)
    joint = model.joint("joint")
    q, v = int(joint.qposadr[0]), int(joint.dofadr[0])
    sensors = {model.sensor(i).name: model.sensor(i).adr[0] for i in range(model.nsensor)}
    wanted = motion.target(spec.motions[number], _TICK)
    c, soft = spec.controller, spec.motions[number].soft
    every = round(1.0 / (spec.instrument.rate * _TICK))
    integral, speed, rows = 0.0, 0.0, []
    with attach(model):
        for k, target in enumerate(wanted):
            error = target - data.qpos[q]
            speed += 0.3 * (data.qvel[v] - speed)
            integral += c.ki * soft * error * _TICK
            data.ctrl[-1] = c.kp * soft * error + integral - c.kd * np.sqrt(soft) * speed
            mujoco.mj_forward(model, data)
            if k % every == 0:
                read = data.sensordata[sensors["joint_position"]]
                rows.append([data.time, read, data.sensordata[sensors["joint_torque"]]])
            while data.time < (k + 1) * _TICK - 1e-9:
                mujoco.mj_step(model, data)
    log = np.array(rows)
    count = 2.0 * np.pi / spec.instrument.counts
    log[:, 1] = np.round(log[:, 1] / count) * count
    log[:, 2] += spec.instrument.torque_noise * rng.standard_normal(len(log))
    return log


def write_model(path: Path, mjcf: Path, found: Fit) -> None:
    """The fitted model with a motor and with sensors, late where the effect says so."""
    spec = mujoco.MjSpec.from_file(str(mjcf))
    friction_spec(spec, "joint", found)
    assert motor_of(found) is None
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


def round_trip(name: str, folder: Path, seconds: float = 12.0, search: bool = False) -> Trip:
    """There and back with one effect's plant.

    Raises:
        ValueError: the first fit or search has not found the effect.
    """
    spec = plant(name, PLANTS[name], seconds)
    body_path = folder / "joint.xml"
    logs = [read_log(path, "joint") for path in write(simulate(spec), folder)]
    first_logs = prepare(logs, RigidBody(body_path, "joint"))
    base, found = searched(first_logs) if search else nominated(first_logs, name)
    first = numbers(first_logs, found, name)
    if not first:
        raise ValueError(f"{name} was not found on the plant: {[t.name for t in found.effects]}")
    path = folder / "model.xml"
    write_model(path, body_path, found)
    rng = np.random.default_rng(7)
    again = []
    for number in range(len(spec.motions)):
        rows = model_log(path, spec, number, rng)
        log = folder / f"model{number}.csv"
        np.savetxt(log, rows, "%.9g", ",", header="time_s,position_rad,torque_nm", comments="")
        again.append(read_log(log, "joint"))
    body = RigidBody(body_path, "joint")
    second_logs = prepare(again, body)
    form = form_of(found, name)
    _, refound = searched(second_logs) if search else nominated(second_logs, name, form)
    return Trip(
        name,
        tuple(t.name for t in refound.effects),
        first,
        numbers(second_logs, refound, name),
        found.rms,
        refound.rms,
        replayed_whole(first_logs, body, base),
        replayed_whole(first_logs, body, found),
        replayed_whole(second_logs, body, refound),
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--effects", nargs="+", choices=PLANTS, default=list(PLANTS))
    parser.add_argument("--search", action="store_true")
    parser.add_argument("--seconds", type=float, default=12.0)
    asked = parser.parse_args()
    warnings.simplefilter("ignore", RuntimeWarning)
    heads = ("effect", "found again", "numbers, first", "again", "worst, standard errors")
    runs = "free runs, mrad: without, with, model's own"
    print(f"| {' | '.join(heads)} | left, N m | {runs} |")
    print("|---" * (len(heads) + 2) + "|")
    for name in asked.effects:
        seconds = max(asked.seconds, 40.0) if name == "warm-up-drift" else asked.seconds
        with tempfile.TemporaryDirectory() as folder:
            try:
                trip = round_trip(name, Path(folder), seconds, asked.search)
            except ValueError as error:
                print(f"| {name} | {error} | | | | | |", flush=True)
                continue
        told = [
            ", ".join(f"{key} {x.value:.4g}" for key, x in values.items())
            for values in (trip.first, trip.second)
        ]
        worst = max(trip.errors.values(), default=float("nan"))
        free = [
            "-" if x is None else f"{1e3 * x:.3g}"
            for x in (trip.before, trip.after, trip.again_free)
        ]
        print(
            f"| {name} | {', '.join(trip.again) or 'nothing'} | {told[0]} | {told[1]} | "
            f"{worst:.1f} | {trip.left:.3g}, {trip.left_again:.3g} | {', '.join(free)} |",
            flush=True,
        )


if __name__ == "__main__":
    sys.exit(main())
