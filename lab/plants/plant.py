"""Simulate a trial plant and record its logs.

    spec = PlantSpec(...)                  # or draw.draw_trial(rng, "one:backlash")
    trial = simulate(spec)
    trial.logs[0]["torque_nm"], trial.mjcf, trial.truth

Log columns: time_s, position_rad, torque_nm (or voltage_v), target_rad, where recorded
temperature_c; with a second joint every name but time_s is prefixed `joint.` or `other.`.
The believed model's joint is named `joint`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray

from . import loop, motion
from .catalogue import build
from .parts import JOINT, OTHER, Parts
from .spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

__all__ = ["Controller", "Effect", "Friction", "Instrument", "Motion", "PlantSpec", "Trial",
           "simulate", "write"]  # fmt: skip

Log = dict[str, NDArray]


@dataclass(frozen=True)
class Trial:
    """Logs of one plant, the MJCF its user believes in, and the sealed truth."""

    spec: PlantSpec
    logs: list[Log]
    mjcf: str
    truth: dict[str, Any]


def simulate(spec: PlantSpec) -> Trial:
    """Run every motion of `spec` on its plant; same spec, same logs."""
    parts = assemble(spec)
    dt = control_period(parts)
    logs = [follow(parts, motion.target(m, dt), i) for i, m in enumerate(spec.motions)]
    return Trial(spec, logs, parts.believed(), truth(spec))


def assemble(spec: PlantSpec) -> Parts:
    """The plant's parts with all its effects in place."""
    parts = Parts(spec)
    for effect in spec.effects:
        build(parts, effect)
    return parts


def truth(spec: PlantSpec) -> dict[str, Any]:
    """What a trial is judged by; never shown to the loop."""
    f = spec.friction
    return {
        "effects": [{"name": e.name, **e.parameters} for e in spec.effects],
        "friction": {
            "law": f.law, "Fs_pos": f.Fs * (1 + f.asymmetry), "Fs_neg": f.Fs * (1 - f.asymmetry),
            "Fc_pos": f.Fc * (1 + f.asymmetry), "Fc_neg": f.Fc * (1 - f.asymmetry),
            "Vs": f.Vs, "sigma2": f.sigma2,
        },
        "noise_rms": spec.instrument.torque_noise,
    }  # fmt: skip


def control_period(parts: Parts) -> float:
    """s between two values of a target."""
    return float(parts.constants()[loop.INDEX["hold"]]) * parts.spec.step


def constants(parts: Parts, number: int) -> NDArray:
    """The loop's numbers in log `number`."""
    c, wish = parts.constants(), parts.spec.motions[number]
    for name in ("kp", "ki", "kd"):
        c[loop.INDEX[name]] *= wish.soft if name != "kd" else np.sqrt(wish.soft)
    if parts.level_by_log:
        c[loop.INDEX["level_factor"]] *= parts.level_by_log[number % len(parts.level_by_log)]
    starts = parts.start_temperatures
    c[loop.INDEX["temp0"]] = starts[number % len(starts)]
    return c


def follow(parts: Parts, target: NDArray, number: int) -> Log:
    """Log `number` of a target, rad, one value per control period, as the instrument samples it."""
    spec, wish, c = parts.spec, parts.spec.motions[number], constants(parts, number)
    hold = int(c[loop.INDEX["hold"]])
    dt = hold * spec.step
    rng = np.random.default_rng((spec.seed, number))
    steps = _instants(spec, target.size * hold, rng)
    late = np.maximum(steps - round(parts.delay / spec.step), 0)
    other = _other_target(parts, wish, dt, target.size)
    out = _run(parts, c, target, other, steps, late)
    return _columns(parts, out, steps * spec.step, rng)


def _instants(spec: PlantSpec, total: int, rng: np.random.Generator) -> NDArray:
    """Step numbers of the samples, jittered, strictly increasing."""
    period = 1.0 / (spec.instrument.rate * spec.step)
    ideal = np.arange(1.0, total / period - 1.0) * period
    noise = spec.instrument.jitter * period * rng.uniform(-0.5, 0.5, ideal.size)
    return np.unique(np.round(ideal + noise).astype(np.int64))


def _other_target(parts: Parts, wish: Motion, dt: float, size: int) -> NDArray:
    if not parts.has_other:
        return np.zeros(0)
    shape = Motion("multisine", wish.seed + 99, 1.0, parts.other_speed, wish.duration)
    return motion.target(shape, dt)[:size]


def _run(parts: Parts, c: NDArray, target: NDArray, other: NDArray, steps: NDArray,
         late: NDArray) -> NDArray:  # fmt: skip
    """Compile the plant's MJCF and step it; columns as `loop.run` states them."""
    model = mujoco.MjModel.from_xml_string(parts.mjcf())
    data = mujoco.MjData(model)
    k, alpha = parts.elements()
    z, slip = np.zeros(k.size + 1), np.zeros(k.size, dtype=np.bool_)
    out = np.zeros((steps.size, 5))
    ctrl = data.ctrl if model.nu else np.zeros(1)
    ctrl_slot = ctrl[-1:] if parts.voltage else np.zeros(1)
    # the look column holds the encoder's joint: the motor's hinge, or with the encoder on the
    # link the sum of hinge and shaft, formed below
    loop.run(
        model._address, data._address, c, k, alpha, z, slip, target, other, data.qpos, data.qvel,
        data.qacc, data.qfrc_applied, ctrl_slot, model.dof_frictionloss, int(parts.voltage), steps,
        late, out,
    )  # fmt: skip
    if not np.isfinite(out).all():
        raise FloatingPointError(f"the plant diverged: {parts.spec}")
    if parts.encoder_on_link and parts.shaft is not None:
        out[:, 0] += out[:, 4]
    return out


def _columns(parts: Parts, out: NDArray, time: NDArray, rng: np.random.Generator) -> Log:
    """Apply the instrument's errors and name the columns."""
    instrument = parts.spec.instrument
    position = out[:, 0]
    amplitude, phase = parts.eccentricity
    position = position + amplitude * np.sin(position + phase)
    noise = instrument.torque_noise * rng.standard_normal(time.size)
    torque = parts.torque_gain * out[:, 1]
    log: Log = {"time_s": time, "position_rad": _counts(position, instrument.counts)}
    if parts.voltage:
        log["voltage_v"] = torque + noise / parts.loop["voltage"]
    else:
        log["torque_nm"] = torque + noise
    log["target_rad"] = out[:, 3]
    if parts.log_temperature:
        log["temperature_c"] = np.round(out[:, 2] + 0.05 * rng.standard_normal(time.size), 1)
    if parts.has_other:
        log = {k if k == "time_s" else f"{JOINT}.{k}": v for k, v in log.items()}
        log[f"{OTHER}.position_rad"] = _counts(out[:, 4], instrument.counts)
    return log


def _counts(position: NDArray, counts: int) -> NDArray:
    """Quantised position; counts = 0 leaves it as it is."""
    if counts == 0:
        return position
    quantum = 2.0 * np.pi / counts
    return np.asarray(np.round(position / quantum) * quantum)


def write(
    trial: Trial, folder: Path, names: Sequence[str] = (), digits: Mapping[str, str] | None = None
) -> list[Path]:
    """Write the logs (log0.csv, ... or `names`) and joint.xml into `folder`; the logs' paths.

    `digits` gives a column's number format. The truth is not written: seal it where the loop
    does not read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "joint.xml").write_text(pretty(trial.mjcf), encoding="utf-8")
    paths = []
    for i, log in enumerate(trial.logs):
        path = folder / (names[i] if names else f"log{i}.csv")
        form = [(digits or {}).get(name, "%.9g") for name in log]
        table = np.column_stack(list(log.values()))
        np.savetxt(path, table, delimiter=",", header=",".join(log), comments="", fmt=form)
        paths.append(path)
    return paths


def pretty(mjcf: str) -> str:
    """MJCF indented for reading."""
    root = ElementTree.fromstring(mjcf)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
