"""A joint under control, by fourth-order Runge-Kutta with the torque held between ticks."""

import math

import numpy as np
from numba import njit

from .control import command
from .friction import bristle, element, level, parallel, viscosity
from .joint import AMBIENT

# state: position, velocity, the same of the link, bristle, lagged level, temperature, time at rest
STATES = 8
COLUMNS = [
    "time",
    "position",
    "velocity",
    "acceleration",
    "asked",
    "friction",
    "sliding",
    "level",
    "gravity",
    "coupling",
    "load",
    "temperature",
    "age",
    "impulse",
    "link",
]
FRICTION, SLIDING, LEVEL, GRAVITY, COUPLING, LOAD, ACCELERATION = range(7)


@njit(cache=True)
def external(joint, t, q, v):
    """Torque on the motor's side that the believed model knows nothing of, N m."""
    e = joint.bias + joint.spring * (q - joint.spring_centre)
    e += joint.gravity_cos * math.cos(q) + joint.gravity_sin * math.sin(q)
    phase = joint.ripple_order * q + joint.ripple_phase
    e += joint.ripple * math.sin(phase) + joint.ripple_second * math.sin(2.0 * phase)
    e += joint.quadratic * v * abs(v)
    if joint.power != 0.0:
        e += joint.power * math.copysign(abs(v) ** joint.exponent, v)
    if q > joint.stop:
        e += joint.stop_stiffness * (q - joint.stop)
    if joint.gust != 0.0:
        w = 2.0 * math.pi / joint.gust_period
        e += joint.gust * math.sin(w * t + joint.gust_phase + 0.7 * math.sin(0.31 * w * t))
    return e


@njit(cache=True)
def window(joint, q):
    """One inside the contact's range, zero outside, over 20 mrad."""
    low = 0.5 + 0.5 * math.tanh((q - joint.contact_low) / 0.02)
    return low * (0.5 - 0.5 * math.tanh((q - joint.contact_high) / 0.02))


@njit(cache=True)
def coupling_torque(joint, twist, rate):
    """Of the shaft between motor and link, which may have a gap."""
    if twist > joint.gap:
        torque = joint.coupling * (twist - joint.gap) + joint.coupling_damping * rate
        return max(torque, 0.0) if joint.gap > 0.0 else torque
    if twist < -joint.gap:
        torque = joint.coupling * (twist + joint.gap) + joint.coupling_damping * rate
        return min(torque, 0.0) if joint.gap > 0.0 else torque
    return 0.0


@njit(cache=True)
def derivative(joint, elements, held, t, y, tau, start, load, dy, seen):
    """Rates dy of the state y at time t; `seen` takes the torques of the balance."""
    q, v = y[0], y[1]
    now = level(joint, t, q, v, load, y[6], y[7])
    s = y[5] if joint.lag > 0.0 else now
    if joint.law == 3:
        sliding, dy[4] = parallel(elements, held, s, v, q - start), 0.0
    else:
        sliding, dy[4] = bristle(joint, s, v, y[4])
    friction = sliding + viscosity(joint, t, v, y[6]) * v
    contact = 0.0
    if joint.contact > 0.0:
        limit = joint.contact * window(joint, q)
        limit *= 0.5 + 0.5 * math.exp(-abs(v) / 0.05)
        contact = element(held[-1], joint.contact_stiffness, q - start, limit)
    acts = min(max(tau, -joint.torque_limit), joint.torque_limit) * (1.0 + joint.gain)
    left = acts - friction - contact - external(joint, t, q, v)
    twisted = 0.0
    if joint.link > 0.0:
        behind = joint.inertia * (joint.link + joint.inertia_error)
        gravity = joint.gravity * math.sin(y[2] + joint.tilt)
        twisted = coupling_torque(joint, q - y[2], v - y[3])
        dy[1] = (left - twisted) / (joint.inertia * (1.0 - joint.link))
        dy[3] = (twisted - gravity) / behind
    else:
        gravity = joint.gravity * math.sin(q + joint.tilt)
        dy[1] = (left - gravity) / (joint.inertia * (1.0 + joint.inertia_error))
        dy[3] = dy[1]
    dy[0], dy[2] = v, y[3]
    dy[5] = (now - y[5]) / joint.lag if joint.lag > 0.0 else 0.0
    dy[6] = joint.heating * abs(friction * v) - (y[6] - AMBIENT) / joint.cooling_time
    dy[7] = 1.0 - y[7] * abs(v) / joint.memory if joint.dwell != 0.0 else 0.0
    seen[FRICTION], seen[SLIDING], seen[LEVEL], seen[GRAVITY] = friction, sliding, s, gravity
    seen[COUPLING], seen[ACCELERATION] = twisted, dy[1]
    seen[LOAD] = gravity + joint.inertia * dy[1]


@njit(cache=True)
def settle(joint, elements, held, y, now, start):
    """After a step: the slipping springs take what they hold at the new position."""
    moved = y[0] - start
    for i in range(elements.shape[0]):
        held[i] = element(held[i], elements[i, 0], moved, elements[i, 1] * now)
    if joint.contact > 0.0:
        limit = joint.contact * window(joint, y[0])
        held[-1] = element(held[-1], joint.contact_stiffness, moved, limit)


@njit(cache=True)
def runge_kutta(joint, elements, held, t, y, tau, load, dt, k, seen):
    """One step of y in place; k[0] and `seen` must hold the derivative at its start."""
    start = y[0]
    trial, unused = np.empty(STATES), np.empty(7)
    for stage in range(1, 4):
        part = dt if stage == 3 else 0.5 * dt
        for i in range(STATES):
            trial[i] = y[i] + part * k[stage - 1, i]
        derivative(joint, elements, held, t + part, trial, tau, start, load, k[stage], unused)
    for i in range(STATES):
        y[i] += dt / 6.0 * (k[0, i] + 2.0 * k[1, i] + 2.0 * k[2, i] + k[3, i])
    settle(joint, elements, held, y, seen[LEVEL], start)


@njit(cache=True)
def note(row, t, y, tau, seen, impulse):
    """One row in the order of COLUMNS."""
    row[0], row[1], row[2], row[3], row[4] = t, y[0], y[1], seen[ACCELERATION], tau
    row[5], row[6], row[7], row[8] = seen[FRICTION], seen[SLIDING], seen[LEVEL], seen[GRAVITY]
    row[9], row[10], row[11], row[12] = seen[COUPLING], seen[LOAD], y[6], y[7]
    row[13], row[14] = impulse, y[2]


@njit(cache=True)
def simulate(joint, elements, control, reference, tick, dt, count, smooth, warm, at, early):
    """Rows in the order of COLUMNS at the steps `at`, and at the steps `early` (both sorted).

    reference: position, velocity, acceleration at each tick, shape (ticks, 3); tick: steps a
    tick; count: radians of an encoder count that the controller reads, 0 if it reads the true
    position; smooth: time constant of its velocity then, s; warm: temperature at the start.
    """
    steps = at[-1] + 1
    rows, earlier = np.empty((at.size, 15)), np.empty((early.size, 15))
    y, k, seen = np.zeros(STATES), np.zeros((4, STATES)), np.zeros(7)
    held = np.zeros(elements.shape[0] + 1)
    y[0] = y[2] = reference[0, 0]
    y[5] = level(joint, 0.0, y[0], 0.0, 0.0, warm, 0.0)
    y[6] = warm
    tau = integral = impulse = load = rate = 0.0
    was = y[0]
    a, e = 0, 0
    for i in range(steps):
        t = i * dt
        if i % tick == 0:
            j = min(i // tick, reference.shape[0] - 1)
            q, v = y[0], y[1]
            if count > 0.0:
                q = round(q / count) * count
                rate += ((q - was) / (tick * dt) - rate) * tick * dt / (smooth + tick * dt)
                was, v = q, rate
            ref = reference[j]
            tau, integral = command(control, q, v, ref[0], ref[1], ref[2], integral, tick * dt)
        derivative(joint, elements, held, t, y, tau, y[0], load, k[0], seen)
        while a < at.size and at[a] == i:
            note(rows[a], t, y, tau, seen, impulse)
            a += 1
        while e < early.size and early[e] == i:
            note(earlier[e], t, y, tau, seen, impulse)
            e += 1
        load = seen[LOAD]
        runge_kutta(joint, elements, held, t, y, tau, load, dt, k, seen)
        impulse += tau * dt
        if not abs(y[0]) < 1e3:
            rows[:] = np.nan
            break
    return rows, earlier
