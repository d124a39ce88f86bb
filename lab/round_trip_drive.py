"""The round trip of an effect of the drive, on `tests/servo_plant`; see `round_trip`."""

import sys
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
from round_trip_joint import Trip, numbers

from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import STATE, tick
from frictionjoint.control.kernel_numbers import block_of
from frictionjoint.diagnose.library import drive_terms
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.search import ROUGH, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import DriveTerm, EffectTerm, Term
from frictionjoint.measured.log import JointLog
from frictionjoint.replay.closed_loop import closed_loop, courses_of, found_controller
from frictionjoint.replay.free_runs import friction_spec
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import load_model

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from servo_plant import COUNT, KNOWN, KT, PLANT, SUPPLY, logs

# what the firmware hides of each effect
DRIVES = {
    "command-delay": {"delay": 0.03},
    "command-rate": {"rate": 2.5},
    "drive-limit": {"limit": 0.4},
    "deadband": {"deadband": 0.07},
    "duty-drop": {"threshold": 0.35, "left": 0.3},
    "supply-sag": {"sag": 0.2},
    "gain-error": {"factor": 0.7, "emf": 0.0},
}
_EMF = EffectTerm(next(e for e in CATALOGUE if e.name == "back-emf"))
_TICK, _EVERY = 1e-3, 10
# samples and steps of the coarse fits from all starts
_COARSE, _STEPS = 1500, 6
# the motor with its supply as one gain: a torque knows its gain, a duty does not
_TORQUE = Controller(output="torque_nm", kp="log:kp", limit=KT * SUPPLY, count_rad=COUNT)


def servo_logs(name: str, seed: int) -> tuple[Controller, list[JointLog]]:
    """What is believed of the controller, and the servo's logs; another servo with each seed."""
    made = logs(DRIVES[name])
    if seed:
        rng = np.random.default_rng(seed)
        loss, damping = rng.uniform(0.03, 0.12), rng.uniform(0.01, 0.06)
        hidden = {key: x * rng.uniform(0.8, 1.25) for key, x in DRIVES[name].items()}
        made = logs(hidden, friction=f'frictionloss="{loss:.4f}" damping="{damping:.4f}"')
    if name != "gain-error":
        return KNOWN, made
    return _TORQUE, [replace(x, metadata={"kp": KT * SUPPLY * x.metadata["kp"]}) for x in made]


def nominated(prepared: Prepared, name: str, form: str | None) -> tuple[Fit, Fit]:
    """The fit without the effect, and with it from the best of its starts, in one form or any."""
    own: tuple[Term, ...] = (_EMF,) if prepared.drive == "voltage" else ()
    base = fit(prepared, own)
    starts = [
        t for t in drive_terms(prepared, ()) if t.name == name and form in (None, t.effect.form)
    ]
    coarse = prepared.thinned(_COARSE)
    tried = [refit(coarse, (*own, t), base.shape, ROUGH, _STEPS) for t in starts]
    best = min(tried, key=lambda f: f.drive_rms)
    return base, refit(prepared, best.effects, best.shape)


def _model_log(path: Path, controller: Controller, volts: float, like: JointLog) -> JointLog:
    """A log of a written model under a controller that does what was found, at 100 Hz.

    Args:
        volts: N m per unit of the controller's output; 0 where the model has the motor.
    """
    model = load_model(path)
    model.opt.timestep = _TICK
    data = mujoco.MjData(model)
    block, state = block_of(controller, like), np.zeros(STATE)
    count = round((like.time[-1] - like.time[0]) / _TICK) + 1
    delay = float(controller.delay_s)
    position = np.empty(count)
    with attach(model):
        for i in range(count):
            q, v, t = float(data.qpos[0]), float(data.qvel[0]), i * _TICK
            at = np.searchsorted(like.time, t - delay + 1e-9, side="right") - 1
            position[i] = round(q / COUNT) * COUNT
            drive = tick(block, state, t, like.target[max(0, at)], q, v, 1.0)
            if volts:
                data.qfrc_applied[0] = volts * drive
            else:
                data.ctrl[0] = drive
            mujoco.mj_step(model, data)
    return replace(like, name=f"model of {like.name}", position=position[::_EVERY])


def drive_trip(name: str, folder: Path, seed: int = 0) -> Trip:
    """There and back; free runs are whole logs, simulated from the target alone."""
    believed, made = servo_logs(name, seed)
    body = RigidBody(PLANT.format(""), "j")
    first_logs = prepare(made, body, controller=believed)
    base, found = nominated(first_logs, name, None)
    term = next(t for t in found.terms if isinstance(t, DriveTerm))
    spec = body.spec()
    friction_spec(spec, "j", found)
    spec.compile()
    path = folder / "model.xml"
    path.write_text(spec.to_xml())
    controller = found_controller(believed, found, scaled=True)
    volts = 1.0 if believed.output == "torque_nm" else 0.0
    again = [_model_log(path, controller, volts, x) for x in made]
    second_logs = prepare(again, body, controller=believed)
    _, refound = nominated(second_logs, name, term.effect.form)
    bodies = [body] * len(made)
    courses, own = courses_of(made, bodies, believed), courses_of(again, bodies, believed)
    return Trip(
        name,
        tuple(t.name for t in refound.effects if isinstance(t, DriveTerm)),
        numbers(first_logs, found, name),
        numbers(second_logs, refound, name),
        found.rms,
        refound.rms,
        closed_loop(courses, base).rms,
        closed_loop(courses, found).rms,
        closed_loop(own, refound).rms,
    )
