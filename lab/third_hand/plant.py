"""One plant: drawn, simulated, judged usable, logged."""

from dataclasses import dataclass, replace

import numpy as np

from . import control, instrument
from .draw import Drawn, draw
from .effect import Record, rms, shares, stacked
from .friction import slip_elements
from .hidden import ALL, NAMES, ONE_SIDED
from .instrument import Instruments
from .integrate import COLUMNS, simulate
from .joint import AMBIENT, LAWS, Joint
from .motion import reference

LOGS = ("fit1", "fit2", "fit3", "held")
ENOUGH, ENOUGH_HELD, ENOUGH_LEFT = 5.0, 3.0, 2.0  # an effect's rms over the noise
QUIETEST = 0.0015  # of the Coulomb torque; an effect that needs less noise is drawn again
BOTH_WAYS = 0.12
SEEN, TOO_MUCH = 0.03, 1.5  # an effect's rms over the friction's


@dataclass(frozen=True)
class Plant:
    """logs: columns by name of each log; answer: as written to answer.json; joint: the truth."""

    logs: dict[str, dict[str, np.ndarray]]
    answer: dict
    joint: Joint


def make(seed: int, number: int, kinds: tuple[str, ...]) -> Plant:
    """The plant of this seed and number; unusable draws are drawn again."""
    rng = np.random.default_rng([seed, number])
    while True:
        plant = attempt(rng, kinds)
        if plant is not None:
            return plant


def attempt(rng: np.random.Generator, kinds: tuple[str, ...]) -> Plant | None:
    d = draw(rng, kinds)
    if "drive-saturation" in kinds:
        first = run(rng, d, 0)
        if not usable(first, d):
            return None
        limit = float(np.quantile(abs(first["asked"]), rng.uniform(0.93, 0.98)))
        d = replace(d, joint=d.joint._replace(torque_limit=limit))
    records = []
    for index in range(len(LOGS)):
        records.append(run(rng, d, index))
        if not usable(records[-1], d):
            return None
    fit, held = stacked(records[:-1]), records[-1]
    noise = bearable(rng, kinds, d, fit, held)
    if noise is None or not (both_ways(fit, d, BOTH_WAYS) and both_ways(held, d, BOTH_WAYS / 2)):
        return None
    d = replace(d, instruments=quieter(d.instruments, noise))
    logs = {name: logged(rng, d, r) for name, r in zip(LOGS, records, strict=True)}
    columns = {name: log for name, (log, _, _) in logs.items()}
    return Plant(columns, answer(kinds, d, records, logs), d.joint)


def run(rng: np.random.Generator, d: Drawn, index: int) -> Record:
    """One log's simulation: columns at the log's instants, and those that the log needs besides."""
    i, joint = d.instruments, d.joint
    seconds = rng.uniform(15, 30)
    aged = (1 + d.ageing) ** index
    joint = joint._replace(
        coulomb=joint.coulomb * aged, breakaway=joint.breakaway * aged, viscous=joint.viscous * aged
    )
    ref = reference(rng, d.styles[index], seconds, i.control_rate, d.limits)
    at, written = instrument.steps(rng, seconds, i, d.dt)
    early = at - round(d.delay / d.dt)
    elements = slip_elements(joint.coulomb, joint.stiffness)
    tick = round(1 / (i.control_rate * d.dt))
    count = i.count if i.reads_encoder else 0.0
    warm = AMBIENT + d.warmth[index]
    rows, earlier = simulate(
        joint, elements, d.controller, ref, tick, d.dt, count, 0.003, warm, at, early
    )
    r = dict(zip(COLUMNS, rows.T.copy(), strict=True))
    r["written"], r["position_early"] = written, earlier[:, COLUMNS.index("position")].copy()
    r["asked_early"] = earlier[:, COLUMNS.index("asked")].copy()
    r["aged"] = np.full(at.size, aged)
    phase = d.eccentric_order * r["position"] + d.eccentric_phase
    e, n = d.eccentric, d.eccentric_order
    r["encoder_error"] = e * np.sin(phase)
    r["encoder_acceleration"] = (
        e * n * np.cos(phase) * r["acceleration"] - e * n**2 * np.sin(phase) * r["velocity"] ** 2
    )
    shown = r["temperature"] if d.thermometer else np.full(at.size, AMBIENT)
    r["logged_temperature"] = np.round(shown + rng.normal(0, 0.05, at.size), 1)
    return r


def usable(r: Record, d: Drawn) -> bool:
    """Finite, near its reference's range, the controller below its limit and not chattering."""
    if not all(np.isfinite(r[name]).all() for name in COLUMNS):
        return False
    near = abs(r["position"]).max() < 2.5 * d.limits.reach + 0.3
    moves = rms(r["velocity"]) > 0.05 * d.limits.speed * (0.3 if d.slow else 1.0)
    return near and moves and abs(r["asked"]).max() < 0.99 * d.controller.limit


def both_ways(r: Record, d: Drawn, part: float) -> bool:
    """Whether at least this part of the time goes into sliding up, and as much down."""
    fast = 1.5 * d.joint.stribeck_velocity
    return min(np.mean(r["velocity"] > fast), np.mean(r["velocity"] < -fast)) > part


def bearable(rng, kinds, d: Drawn, fit: Record, held: Record) -> float | None:
    """Noise under which every hidden effect is visible, None if no instrument has so little."""
    noise = d.instruments.noise
    seen, seen_held = shares(kinds, d.joint, fit, 1.0), shares(kinds, d.joint, held, 1.0)
    for kind in kinds:
        if not SEEN < seen[kind]["over_friction"] < TOO_MUCH:
            return None
        bounds = [seen[kind]["rms"] / ENOUGH, seen_held[kind]["rms"] / ENOUGH_HELD]
        if kind not in ONE_SIDED:
            bounds.append(seen[kind]["left_by_base_over_noise"] / ENOUGH_LEFT)
        if min(bounds) < noise:
            noise = min(bounds) * rng.uniform(0.7, 1.0)
    return None if noise < QUIETEST * d.joint.coulomb else noise


def quieter(i: Instruments, noise: float) -> Instruments:
    """The same instruments with this noise, ripple and resolution in proportion."""
    scale = noise / i.noise
    return replace(i, noise=noise, ripple=i.ripple * scale, resolution=i.resolution * scale)


def logged(rng, d: Drawn, r: Record) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """The log, and by how much its torque and position are wrong, effects apart."""
    i = d.instruments
    phase = i.ripple_order * r["position"] + rng.uniform(0, 2 * np.pi)
    wrong = instrument.torque_noise(rng, r["time"].size, i) + i.ripple * np.sin(phase)
    torque = instrument.rounded(r["asked"] + wrong, i.resolution)
    position = r["position_early"] + r["encoder_error"]
    log = {"time_s": r["written"], "position_rad": instrument.rounded(position, i.count)}
    log["torque_nm"] = torque
    if d.thermometer or d.idle_thermometer:
        log["temperature_c"] = r["logged_temperature"]
    late = r["time"] - r["time"][0] - log["time_s"]
    unseen = r["velocity"] * (late - late.mean())
    return log, torque - r["asked"], log["position_rad"] - position + unseen


def hold(r: Record) -> np.ndarray:
    """What sampling a held torque costs: Simpson's mean of three samples less the true mean."""
    t, asked, impulse = r["time"], r["asked"], r["impulse"]
    sampled = (asked[:-2] + 4 * asked[1:-1] + asked[2:]) / 6
    return sampled - (impulse[2:] - impulse[:-2]) / (t[2:] - t[:-2])


def unresolved(joint: Joint, r: Record, wrong: np.ndarray) -> np.ndarray:
    """Torque that the error of the position stands for while the joint sticks."""
    sticks = abs(r["sliding"]) < 0.95 * r["level"]
    return np.where(sticks, joint.stiffness * wrong, 0.0).clip(-r["level"], r["level"])


def by_role(of_logs: list[np.ndarray]) -> dict[str, float]:
    return {"fit": rms(np.concatenate(of_logs[:-1])), "held_out": rms(of_logs[-1])}


def answer(kinds, d: Drawn, records: list[Record], logs) -> dict:
    """As written to answer.json; its keys are explained in `files`."""
    fit, i, joint = stacked(records[:-1]), d.instruments, d.joint
    told = shares(kinds, joint, fit, i.noise)
    accept = {}
    for kind in kinds:
        also = told[kind].pop("also")
        known = [] if ALL[kind].variable else [NAMES.get(kind, kind), *also]
        accept[kind] = ONE_SIDED.get(kind, known)
    variable = sorted({name for kind in kinds for name in ALL[kind].variable})
    return {
        "kinds": list(kinds),
        "accept": accept,
        "variable": variable,
        "effects": told,
        "noise_rms": i.noise,
        "true_rms": by_role([wrong for _, wrong, _ in logs.values()]),
        "position_rms": by_role([wrong for _, _, wrong in logs.values()]),
        "hold_rms": by_role([hold(r) for r in records]),
        "presliding_rms": by_role(
            [unresolved(joint, r, log[2]) for log, r in zip(logs.values(), records, strict=True)]
        ),
        "friction_rms": rms(fit["friction"]),
        "parameters": joint._asdict() | {"law": LAWS[joint.law]} | d.of_the_log(),
        "controller": d.controller._asdict() | {"kind": control.CONTROLLERS[d.controller.kind]},
        "instruments": {n: getattr(i, n) for n in i.__dataclass_fields__},
        "styles": dict(zip(LOGS, d.styles, strict=True)),
    }
