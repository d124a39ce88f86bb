"""From logs to the arrays of a fit: band, hold of the drive, used samples."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import Array, root_mean_square
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import commands, measures_drive, with_drive
from frictionjoint.effects.signals import (
    DT,
    GEAR,
    GX,
    GY,
    LOAD,
    N_SIGNALS,
    SAG,
    SWAY,
    TEMP,
    TIME,
    A,
    Q,
    V,
)
from frictionjoint.errors import LogError
from frictionjoint.identify.bundle import Commanded
from frictionjoint.identify.motion import Motion, holds, motion_of, of_drive
from frictionjoint.identify.noise import Band, clear_of, count_of, noise_of
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import A_BALANCE, Drive, Prepared, Segment
from frictionjoint.identify.tracks import path_of
from frictionjoint.measured.derivatives import LEAST_HZ, motion_band, on_a_grid
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.lowpass import REACH
from frictionjoint.measured.repairs import silent_runs


def prepare(
    logs: list[JointLog],
    body: RigidBody | Sequence[RigidBody],
    band: Band | None = None,
    controller: Controller | None = None,
) -> Prepared:
    """Prepare logs of one joint.

    Args:
        body: of the joint; one per log if they have different loads.
        controller: that drove it, for logs without torque, voltage or current.
        band: of logs to compare with; None: from the logs themselves.
    Raises:
        LogError: different kinds of drive, or an unknown drive.
    """
    bodies = [body] * len(logs) if isinstance(body, RigidBody) else list(body)
    body = bodies[0]
    measured = [measures_drive(log) for log in logs]
    logs = [with_drive(log, controller) for log in logs]
    drives = [_drive(log)[0] for log in logs]
    for log, drive in zip(logs, drives, strict=True):
        if drive != drives[0]:
            what = f"{logs[0].name} has a {drives[0]} and {log.name} a {drive}"
            raise LogError(f"{what}: give logs of one kind")

    def motions(corner_hz: float, held: bool) -> list[Motion]:
        each = zip(logs, bodies, measured, strict=True)
        return [motion_of(log, b, corner_hz, held and own) for log, b, own in each]

    def segments(way: Band, along: list[Motion]) -> tuple[Segment, ...]:
        each = zip(logs, bodies, along, measured, strict=True)
        return tuple(
            _segment(log, b, m, way, None if own else controller) for log, b, m, own in each
        )

    if band is None:
        bands = [motion_band(*on_a_grid(log)[1:]) for log in logs]
        # a servo's logs are many and short, and a corrupt one must not widen the band of all
        over_logs = np.max if all(measured) else np.median
        corner = max(float(over_logs([m.whole for m in bands])), 2.0 * LEAST_HZ)
        main = float(over_logs([m.main for m in bands]))
        along = motions(corner, held=False)
        wide = Band(corner / 2.0, corner)
        band = Band(_balance_hz(segments(wide, along), main, corner), corner)
        found = segments(band, along)
        if _may_be_held(found, band):
            held = replace(band, zero_order_hold=True)
            other = segments(held, motions(corner, held=True))
            if holds(found, other):
                band, found = held, other
    else:
        found = segments(band, motions(band.motion, band.zero_order_hold))
    free = any(bool(np.any(s.mask & ~s.driven)) for s in found)
    motor_off = free and drives[0] == "voltage"
    return Prepared(found, body.joint, bool(body.slide), drives[0], band, motor_off=motor_off)


def _may_be_held(segments: Sequence[Segment], band: Band) -> bool:
    """Whether a measured drive may be constant between samples and this matters."""
    samples = [s.sample for s in segments if s.commanded is None]
    # with 50 samples per period, holding lowers a torque by 0.06% only
    return max(samples, default=0.0) * band.balance * 50.0 >= 1.0


def _balance_hz(segments: Sequence[Segment], main: float, motion: float) -> float:
    """Corner of the balance: as high as the noise allows, but high enough for the motion."""
    # friction and the effects of the catalogue act below 60 Hz; above only time is spent
    most = min(60.0, motion / 2.0)
    least = min(max(LEAST_HZ, main), most)
    slowest = max(s.sample for s in segments)
    # 16 samples per period of the corner: a torque that a controller holds for a sample is lower by
    # 0.6% there, and not every log shows whether it is held
    most = max(least, min(most, 1.0 / (16.0 * slowest)))
    return float(np.median([s.noise.band_hz(least, most) for s in segments]))


def _drive(log: JointLog) -> tuple[Drive, Array]:
    """Kind and values of the drive that a log contains; `with_drive` ensures that there is one."""
    return next((name, x) for name in get_args(Drive) if (x := getattr(log, name)) is not None)


def _segment(
    log: JointLog, body: RigidBody, motion: Motion, band: Band, controller: Controller | None
) -> Segment:
    """Prepare a log whose motion is known; a controller computes its drive, or it is measured."""
    grid, sample, smooth, rigid = motion.raw_time, motion.sample, motion.smooth, motion.rigid
    t, dt, n = motion.time, motion.dt, len(motion.time)
    signals = _signals(log, motion)
    mask = np.ones(n, dtype=bool)
    # the ends depend on the motion beyond the log
    edge = min(n // 10, max(2, int(REACH / (band.balance * dt))))
    mask[:edge] = mask[n - edge :] = False
    driven = np.ones(n, dtype=bool)
    kind, values = _drive(log)
    commanded = None
    if controller is not None:
        commanded = Commanded(commands(log, controller), grid, (smooth,))
        values = commanded.commands.mean_drive()
    measured = np.interp(grid, log.time, values)
    if log.torque_enabled is not None:
        enabled = np.interp(t, log.time, log.torque_enabled.astype(float))
        driven = enabled > 0.999
        # a motor without voltage gives no torque; of any other drive that is off nothing is known
        mask &= _away_from_switching(enabled, edge) if kind == "voltage" else driven
        if kind == "voltage":
            measured = np.where(np.interp(grid, t, driven.astype(float)) > 0.5, measured, 0.0)
    held = band.zero_order_hold and controller is None
    more = partial(of_drive, sample=sample) if held else None
    drive = smooth.back(smooth.spectrum(measured), weight=more)
    per_drive = 1.0 if kind == "torque" else _per_torque(drive, rigid.load, motion.v)
    unknown = np.interp(t, log.time, body.at_limit(log.position).astype(float)) > 0.0
    others: tuple[tuple[float, float], ...] = ()
    if controller is None:
        others = turned_by_another(log, values, t, drive - per_drive * rigid.load, motion.v)
        for begin, end in others:
            unknown |= (t >= begin) & (t <= end)
    mask &= clear_of(unknown, band.balance, dt)
    noise = noise_of(
        measured,
        motion.raw,
        np.interp(grid, t, motion.q),
        sample,
        count_of(log.position),
        root_mean_square(rigid.coupling) * per_drive,
    )
    found = Segment(
        name=log.name,
        dt=dt,
        bandwidth_hz=band.balance,
        step=max(1, int(1.0 / (dt * A_BALANCE * band.balance))),
        signals=signals,
        drive=drive,
        driven=driven,
        mask=mask,
        others={
            f"{name}.{kind}": triple[i]
            for name, triple in motion.others.items()
            for i, kind in enumerate(("position", "velocity", "acceleration"))
        }
        | {name: np.interp(t, log.time, x) for name, x in log.signals.items()},
        # a reconstructed drive leaps with its target, and has no noise
        noise=noise if commanded is None else replace(noise, torque=0.0),
        driven_along=path_of(signals, noise.resolution),
        unknown=rigid.unknown,
        saturated=_saturated(log.time, values, t) if controller is None else None,
        sample=sample,
        corner_hz=band.motion,
        commanded=commanded,
        inertia=float(np.mean(rigid.inertia)),
        turned_by_another=others,
    )
    return found.without_limits() if band.sensor_saturates else found


def _signals(log: JointLog, motion: Motion) -> Array:
    """Motion, load and temperature of a log, shape (n, N_SIGNALS)."""
    rigid = motion.rigid
    signals = np.zeros((len(motion.time), N_SIGNALS))
    signals[:, TIME] = motion.time - motion.time[0]
    signals[:, Q], signals[:, V], signals[:, A] = motion.q, motion.v, motion.a
    signals[:, LOAD], signals[:, GEAR] = rigid.load, motion.gear
    signals[:, GX], signals[:, GY] = rigid.gx, rigid.gy
    signals[:, SAG], signals[:, SWAY] = rigid.sag, rigid.sway
    signals[1:, DT] = motion.dt
    # not a number where no thermometer was read
    signals[:, TEMP] = np.nan
    if log.temperature is not None:
        signals[:, TEMP] = np.interp(motion.time, log.time, log.temperature)
    return signals


def _saturated(time: Array, values: Array, grid: Array) -> Array | None:
    """1 where a drive is at its largest value, -1 where it is at its smallest; None if never.

    At a limit, unlike at the crest of a wave, many samples have the same value, within the noise.
    """
    found = np.zeros(len(values))
    steps = np.abs(np.diff(values))
    apart = np.diff(np.unique(values))
    # a drive at its limit: within 4 usual changes per sample of its end, 4 times as often as just
    # below, 10 times or more at the very end, and less than half of the time, unlike a drive with
    # few values
    near = 4.0 * max(float(np.median(steps)), float(apart.min(initial=np.inf)))
    for side in (1.0, -1.0):
        below = np.max(side * values) - side * values
        there = below <= near
        under = np.count_nonzero(below <= 2.0 * near) - np.count_nonzero(there)
        piled = np.count_nonzero(there) > 4.0 * under
        if piled and np.count_nonzero(below == 0.0) >= 10:
            found[1:-1][there[:-2] & there[1:-1] & there[2:]] = side
    if not 0 < np.count_nonzero(found) < 0.5 * len(found):
        return None
    return np.round(np.interp(grid, time, found))


def _per_torque(drive: Array, load: Array, velocity: Array) -> float:
    """Drive per unit of torque, roughly: from load, viscous and Coulomb friction."""
    columns = np.column_stack([load, velocity, np.sign(velocity), np.ones_like(load)])
    return abs(float(np.linalg.lstsq(columns, drive, rcond=None)[0][0]))


def _away_from_switching(enabled: Array, edge: int) -> NDArray[np.bool_]:
    """False within `edge` samples of a switching of the drive, which a filter smears in time."""
    away = np.ones(len(enabled), dtype=bool)
    for k in np.flatnonzero(np.diff(enabled)):
        away[max(0, k - edge + 1) : k + edge + 1] = False
    return away


def turned_by_another(
    log: JointLog, values: Array, grid: Array, lost: Array, velocity: Array
) -> tuple[tuple[float, float], ...]:
    """Start and end of each part in which another drive turns the joint, s in the log's time, while
    the joint's own drive is off.

    A joint that coasts loses energy to its friction, about as much over a distance as when it is
    driven. If another motor turns the joint, that motor supplies this energy. Then the balance of
    the joint's own drive and the rigid body shows almost no friction.

    Args:
        values: of the log's drive, at its samples. grid: times of the balance, s, shape (n,), of
            `lost`, drive minus rigid-body torque in units of the drive, and of the velocity.
    """
    silent = [
        (float(log.time[a]), float(log.time[b - 1]))
        for a, b in silent_runs(log.time, log.position, values)
    ]
    inside = [(grid >= a) & (grid <= b) for a, b in silent]
    driven = ~np.any([np.zeros(len(grid), dtype=bool), *inside], axis=0)
    usual = _friction(lost[driven], velocity[driven])
    # a coasting joint has about all of its usual friction
    return tuple(
        span
        for span, there in zip(silent, inside, strict=True)
        if _friction(lost[there], velocity[there]) < usual / 3.0
    )


def _friction(lost: Array, velocity: Array) -> float:
    """Friction as work over distance; 0 if nothing moves."""
    distance = float(np.sum(np.abs(velocity)))
    return float(np.sum(lost * velocity)) / distance if distance else 0.0
