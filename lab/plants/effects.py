"""Undeclared effects of the catalogue, each built from MuJoCo parts or in the stepping loop."""

from __future__ import annotations

import numpy as np

from .kind import Kind, Sizes, in_loop
from .parts import JOINT, Parts
from .spec import GRAVITY, PlantSpec


def back_emf(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Back-EMF slope kt^2/R of one to three times the viscous friction; full torque near 12 V."""
    slope = float(rng.uniform(1.0, 3.0) * spec.friction.sigma2)
    gain = (2.0 * spec.friction.Fs + spec.gravity_torque) / 12.0
    kt = slope / gain
    return {"kt": kt, "resistance": kt / gain}


def build_motor(parts: Parts, p: Sizes) -> None:
    """A voltage-driven motor, MuJoCo's `dcmotor`: torque = kt/R (V - kt v); log has voltage_v.

    kt N m/A, resistance ohm, both at the joint.
    """
    gain = p["kt"] / p["resistance"]
    parts.actuators.append(
        f'<dcmotor name="motor" joint="{JOINT}" motorconst="{p["kt"]:.9g}" '
        f'resistance="{p["resistance"]:.9g}" input="voltage"/>'
    )
    control = parts.spec.controller
    parts.voltage = True
    parts.loop |= {
        "voltage": gain, "kp": control.kp / gain, "ki": control.ki / gain, "kd": control.kd / gain,
        "limit": control.limit / gain,
    }  # fmt: skip


def backlash(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """0.3 to 1.5 degrees, flanks ten times stiffer than what the load bends over the gap."""
    gap = float(np.radians(rng.uniform(0.3, 1.5)))
    load = max(spec.gravity_torque, spec.inertia * 10.0, spec.friction.Fs)
    return {"gap": gap, "stiffness": 20.0 * load / gap}


def build_gap(parts: Parts, p: Sizes) -> None:
    """A gap between motor and link: a shaft hinge held by a tendon with a dead band.

    gap rad in all; the flanks are as stiff as `stiffness` N m/rad; encoder on the motor.
    """
    damping = 0.3 * np.sqrt(p["stiffness"] * parts.spec.inertia)
    parts.shaft = {"damping": f"{0.02 * damping:.9g}"}
    half = 0.5 * p["gap"]
    parts.tendons.append(
        f'<fixed name="flanks" stiffness="{p["stiffness"]:.9g}" '
        f'springlength="{-half:.9g} {half:.9g}">'
        '<joint joint="shaft" coef="1"/></fixed>'
    )


def direction_asymmetry(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Own friction level for each direction: 1 + part forward, 1 - part backward."""
    return {"part": float(rng.uniform(0.08, 0.2) * rng.choice([-1.0, 1.0]))}


def dwell_time(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Breakaway that grows while at rest: Fs + rise (1 - exp(-t/tau)), lost again over `slip` rad.

    Rate-and-state ageing (Dieterich 1979) with an exponential instead of the logarithm: 30 to 80 %
    of Fs, over a fraction of a second to a second. The slip that wipes it out is some hundredths of
    a radian: over less, it is gone within a sample and no log shows it.
    """
    return {
        "rise": float(rng.uniform(0.3, 0.8) * spec.friction.Fs),
        "tau": float(rng.uniform(0.2, 1.0)),
        "slip": float(rng.uniform(0.01, 0.04)),
    }


def end_stop(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Met in the outer fifth of the motion; up to twice the Coulomb level at its end."""
    reach = max(m.amplitude for m in spec.motions)
    center = spec.motions[0].center
    at = float(center + rng.uniform(0.55, 0.7) * reach)
    return {"at": at, "stiffness": float(rng.uniform(1.5, 4.0) * spec.friction.Fc / (0.3 * reach))}


def build_stop(parts: Parts, p: Sizes) -> None:
    """A soft stop at one end: a tendon with a dead band, k (q - at) beyond `at` rad."""
    parts.tendons.append(
        f'<fixed name="stop" stiffness="{p["stiffness"]:.9g}" springlength="-1000 {p["at"]:.9g}">'
        f'<joint joint="{JOINT}" coef="1"/></fixed>'
    )


def frictional_lag(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Sliding friction that follows the Stribeck curve late: tau dS/dt = S(v) - S.

    After Hess and Soom 1990 (a pure delay there, a first-order lag here).
    """
    return {"tau": float(rng.uniform(0.02, 0.08))}


def gravity_error(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Up to 30 to 80 % of the Coulomb level, off to one side."""
    return {
        "mass": float(rng.uniform(0.3, 0.8) * spec.friction.Fc / (GRAVITY * spec.arm)),
        "angle": float(rng.uniform(0.7, 1.6) * rng.choice([-1.0, 1.0])),
    }


def build_payload(parts: Parts, p: Sizes) -> None:
    """A mass on the link that the model does not know (a payload, or a wrong one).

    mass kg, at the distance of the link's centre (0.1 m where the link has no arm), turned by
    `angle` rad from it: straight below the centre, a mass cannot be told from a wrong torque gain.
    """
    parts.extra_mass, parts.extra_angle = p["mass"], p["angle"]


def inertia_error(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """15 to 60 % of the nominal inertia."""
    return {"inertia": float(rng.uniform(0.15, 0.6) * (spec.inertia + spec.armature))}


def build_rotor(parts: Parts, p: Sizes) -> None:
    """Rotor inertia that the model does not know: MuJoCo's `armature`, kg m^2."""
    parts.extra_armature = p["inertia"]


def joint_elasticity(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Link resonance with the motor held between 4 and 12 Hz, lightly damped."""
    w = 2.0 * np.pi * float(rng.uniform(4.0, 12.0))
    stiffness = spec.inertia * w * w
    return {"stiffness": stiffness, "damping": 2.0 * 0.03 * stiffness / w}


def build_shaft(parts: Parts, p: Sizes) -> None:
    """Motor and link joined by a spring and damper: a second hinge, encoder on the motor.

    stiffness N m/rad, damping N m s/rad. The rotor holds the armature.
    """
    parts.shaft = {"stiffness": f"{p['stiffness']:.9g}", "damping": f"{p['damping']:.9g}"}


def load_dependent(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Friction level that grows with the torque the gear hands on to the link.

    slope: N m of friction per N m transmitted (Bittencourt and Gunnarsson 2012; Duclusaud et al.
    2024); from a harmonic drive to a cheap servo.
    """
    return {"slope": float(rng.uniform(0.08, 0.3))}


def measurement_delay(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """1 to 3 samples, and at least 3 ms: below that nothing in the motion shows it."""
    return {
        "delay": float(max(rng.uniform(1.0, 3.0) / spec.instrument.rate, rng.uniform(3e-3, 8e-3)))
    }


def build_delay(parts: Parts, p: Sizes) -> None:
    """Position recorded late against torque, by a fixed time in s."""
    parts.delay = p["delay"]


def nonlinear_viscous(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Viscous friction c sgn(v) |v|^power: 30 to 70 % of the Coulomb level at top speed.

    Quadratic (churning) or concave (elastohydrodynamic films, power below 1).
    """
    top = max(m.speed for m in spec.motions)
    power = float(rng.choice([rng.uniform(0.4, 0.6), rng.uniform(1.8, 2.2)]))
    return {"c": float(rng.uniform(0.3, 0.7) * spec.friction.Fc / top**power), "power": power}


def position_periodic(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """5 to 20 % of the friction, enough cycles for the motion to cross several."""
    reach = max(m.amplitude for m in spec.motions)
    cycles = float(rng.uniform(5.0, 30.0) / reach)
    additive = rng.uniform() < 0.75
    size = float(rng.uniform(0.08, 0.25))
    return {
        **({"amplitude": size * spec.friction.Fs} if additive else {"level": size}),
        "cycles": float(max(1, round(cycles))),
        "phase": float(rng.uniform(-np.pi, np.pi)),
    }


def build_ripple(parts: Parts, p: Sizes) -> None:
    """Cogging: amplitude sin(cycles q + phase), N m, of a `dcmotor` without input.

    With `level` instead of amplitude (an eccentric gear) the friction level is multiplied by
    1 + level sin(cycles q + phase). The motor constant is 1e-6 because 3.17 refuses zero.
    """
    if "level" in p:
        in_loop(periodic_level="level", periodic_n="cycles", periodic_phase="phase")(parts, p)
        return
    parts.actuators.append(
        f'<dcmotor name="cogging" joint="{JOINT}" input="none" motorconst="1e-6" resistance="1" '
        f'cogging="{p["amplitude"]:.9g} {p["cycles"]:.9g} {p["phase"]:.9g}"/>'
    )


def spring(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Up to 30 to 80 % of the Coulomb level at the end of the motion."""
    reach = max(m.amplitude for m in spec.motions)
    return {
        "stiffness": float(rng.uniform(0.3, 0.8) * spec.friction.Fc / reach),
        "rest": float(rng.uniform(-0.5, 0.5) * reach),
    }


def build_spring(parts: Parts, p: Sizes) -> None:
    """A cable or hose: MuJoCo's joint `stiffness`, N m/rad, about a rest angle, rad."""
    parts.joint |= {"stiffness": f"{p['stiffness']:.9g}", "springref": f"{p['rest']:.9g}"}


def temperature_dependent(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """The friction's own loss warms the joint by 10 to 30 K in steady motion."""
    tau = float(rng.uniform(15.0, 60.0))
    return {
        "viscous": float(rng.uniform(1.0, 2.5) * spec.friction.sigma2),
        "level": float(rng.uniform(0.15, 0.4)),
        "rise": float(rng.uniform(12.0, 30.0)),
        "tau": tau,
        "scale": float(rng.uniform(15.0, 30.0)),
    }


def build_warming(parts: Parts, p: Sizes) -> None:
    """A joint that its friction warms, from 25 C on, with no thermometer in the log.

    viscous N m s/rad and level (a fraction) at 25 C, both times exp(-(T - 25)/scale); T is a first
    order thermal body heated by the friction loss: rise K, tau s.
    """
    speed = 0.5 * float(np.mean([m.speed for m in parts.spec.motions]))
    loss = (parts.spec.friction.Fc + parts.spec.friction.sigma2 * speed) * speed
    parts.loop |= {
        "visc_T": p["viscous"], "level_T": p["level"], "T0": p["scale"],
        "cooling_tau": p["tau"], "heat": p["rise"] / (p["tau"] * loss),
    }  # fmt: skip


def build_thermometer(parts: Parts, p: Sizes) -> None:
    """The same with a temperature that the log records."""
    build_warming(parts, p)
    parts.log_temperature = True
    parts.start_temperatures = (25.0, 33.0, 41.0, 29.0)


def torque_bias(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """A constant torque the log does not show (offset of the amplifier or of the sensor)."""
    return {"bias": float(rng.uniform(0.1, 0.4) * spec.friction.Fc * rng.choice([-1.0, 1.0]))}


def torque_gain(rng: np.random.Generator, spec: PlantSpec) -> Sizes:
    """Motor constant wrong: the log shows (1 + error) times the true torque."""
    return {"error": float(rng.uniform(0.06, 0.2) * rng.choice([-1.0, 1.0]))}


def build_gain(parts: Parts, p: Sizes) -> None:
    """Scale the logged torque."""
    parts.torque_gain = 1.0 + p["error"]


EFFECTS = {
    "back-emf": Kind(back_emf, build_motor),
    "backlash": Kind(backlash, build_gap),
    "direction-asymmetry": Kind(direction_asymmetry, in_loop(asymmetry="part")),
    "dwell-time": Kind(dwell_time, in_loop(dwell="rise", dwell_tau="tau", dwell_slip="slip")),
    "end-stop": Kind(end_stop, build_stop),
    "frictional-lag": Kind(frictional_lag, in_loop(lag_tau="tau")),
    "gravity-error": Kind(gravity_error, build_payload),
    "inertia-error": Kind(inertia_error, build_rotor),
    "joint-elasticity": Kind(joint_elasticity, build_shaft),
    "load-dependent": Kind(load_dependent, in_loop(load="slope")),
    "measurement-delay": Kind(measurement_delay, build_delay),
    "nonlinear-viscous": Kind(nonlinear_viscous, in_loop(visc2="c", visc_p="power")),
    "position-periodic": Kind(position_periodic, build_ripple),
    "spring": Kind(spring, build_spring),
    "temperature-dependent": Kind(temperature_dependent, build_thermometer),
    "torque-bias": Kind(torque_bias, in_loop(bias="bias")),
    "torque-gain": Kind(torque_gain, build_gain),
    "warm-up-drift": Kind(temperature_dependent, build_warming),
}
