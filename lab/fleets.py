"""How often the intervals over recordings of simulated fleets contain the fleet's mean.

    python lab/fleets.py [--fleets 8] [--seed 0 --seed 1 ...] [--spread 0 --spread 0.05 ...]

A fleet is six recordings of one kind of joint, simulated here by the LuGre equations and nothing of
the package; Coulomb and viscous friction differ between recordings by a normal deviate. The package
estimates each recording from the nominal joint (`recordings.estimate`) and the mean of the fleet
with its 95% interval (`recordings.between`). Intervals should contain the mean in 90 to 98% of the
fleets, whatever the spread. Told: fleets of which the package says, at a level of 5%, that their
recordings differ; for fleets without a spread also how often `drift` calls a number of a single
recording changed, which should be 5% at most. The law is the one of the simulation: these figures
are of the intervals, not of what a wrong law does to a number.
"""

import argparse

import mujoco
import numpy as np

from frictionjoint.decisions import TIE
from frictionjoint.files import toml_document
from frictionjoint.measured.log import JointLog
from frictionjoint.recordings.between import over
from frictionjoint.recordings.drift import judged
from frictionjoint.recordings.estimate import Estimates, Known
from frictionjoint.recordings.in_report import explained
from frictionjoint.refine.posterior import Posterior, numbers_in
from frictionjoint.rivals import LuGreParameters
from frictionjoint.simulate.carrier import install

COULOMB, VISCOUS = 0.30, 0.08
# static friction over Coulomb friction, N m; Stribeck velocity, rad/s; bristles, N m/rad, N m s/rad
RISE, STRIBECK, BRISTLE, BRISTLE_DAMPING = 0.06, 0.15, 300.0, 0.5
MASS, ARM, OWN = 0.5, 0.2, 1e-3
INERTIA = OWN + MASS * ARM**2
# s: so small that the Euler steps add nothing to the bristles' damping
STEP, EVERY, SECONDS = 3.125e-5, 128, 12.0
TORQUE_NOISE, POSITION_NOISE = 0.01, 2e-5
RECORDINGS = 6
SPREADS, LEVEL = (0.0, 0.05, 0.15), 0.05
MODEL = f"""<mujoco><option timestep="0.0005" integrator="implicitfast"/><worldbody><body>
<joint name="elbow" axis="0 1 0"/><inertial pos="{ARM} 0 0" mass="{MASS}" diaginertia="{OWN} {OWN}
{OWN}"/></body></worldbody></mujoco>"""


def nominal():
    """The joint without differences, as a report would have it."""
    law = LuGreParameters.symmetric(
        Fs=COULOMB + RISE,
        Fc=COULOMB,
        Vs=STRIBECK,
        sigma2=VISCOUS,
        sigma0=BRISTLE,
        sigma1=BRISTLE_DAMPING,
        delta=2.0,
    )
    spec = mujoco.MjSpec.from_string(MODEL)
    install(spec, {"elbow": law})
    spec.compile()
    content = toml_document(law, ()).unwrap()
    factor = np.diag(0.01 * np.abs(numbers_in(content)))
    return Known(spec.to_xml(), "elbow", Posterior(content, factor))


def simulated(rngs, coulomb, viscous):
    """Logs of joints with these numbers, shape (seeds, n) each; one generator per seed."""
    shape = (5, coulomb.shape[1])
    drawn = [
        [rng.uniform(*ends, shape) for ends in ((2.0, 12.0), (0.2, 0.4), (0, 6))] for rng in rngs
    ]
    wave = [np.concatenate(x, axis=1) for x in zip(*drawn, strict=True)]
    coulomb, viscous = coulomb.ravel(), viscous.ravel()
    time = STEP * np.arange(int(SECONDS / STEP))
    q, v, z = (np.zeros(len(coulomb)) for _ in range(3))
    positions, torques = [], []
    for k, t in enumerate(time):
        gravity = -MASS * 9.81 * ARM * np.cos(q)
        torque = np.sum(wave[1] * np.sin(wave[0] * t + wave[2]), 0) - 0.5 * q + gravity
        if k % EVERY == 0:
            positions.append(q)
            torques.append(torque)
        level = coulomb + RISE * np.exp(-((v / STRIBECK) ** 2))
        rate = v - BRISTLE * np.abs(v) / level * z
        friction = BRISTLE * z + BRISTLE_DAMPING * rate + viscous * v
        z = z + STEP * rate
        v = v + STEP / INERTIA * (torque - gravity - friction)
        q = q + STEP * v
    kept = np.array(positions).T, np.array(torques).T
    for i, (position, torque) in enumerate(zip(*kept, strict=True)):
        rng = rngs[i // shape[1]]
        yield JointLog(
            name=f"recording {i}",
            joint="elbow",
            time=time[::EVERY],
            position=position + rng.normal(0.0, POSITION_NOISE, len(position)),
            torque=torque + rng.normal(0.0, TORQUE_NOISE, len(torque)),
        )


def main():
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fleets", type=int, default=8, help="per seed")
    parser.add_argument("--seed", type=int, action="append")
    parser.add_argument("--spread", type=float, action="append")
    asked = parser.parse_args()
    known, rngs = nominal(), [np.random.default_rng(seed) for seed in asked.seed or [0]]
    print("| number | spread between recordings | fleets | mean inside | told | spread, mean |")
    print("|---|---|---|---|---|---|")
    for spread in asked.spread or SPREADS:
        size = (2, asked.fleets * RECORDINGS)
        each = 1.0 + spread * np.stack([rng.standard_normal(size) for rng in rngs], axis=1)
        logs = simulated(rngs, COULOMB * each[0], VISCOUS * each[1])
        found = [Estimates(known, log) for log in logs]
        fleets = [found[i : i + RECORDINGS] for i in range(0, len(found), RECORDINGS)]
        for name, value in {"Fc": COULOMB, "sigma2": VISCOUS}.items():
            i = [number.name for number in known.numbers].index(name)
            over_each = [over(own, i) for own in fleets]
            inside = np.mean([x.interval[0] < value < x.interval[1] for x in over_each])
            pairs = zip(over_each, fleets, strict=True)
            told = np.mean([x.p_value < LEVEL and explained(own, i) > TIE for x, own in pairs])
            stated = np.mean([x.deviation for x in over_each]) / value
            print(
                f"| {name} | {spread:.0%} | {len(fleets)} | {inside:.0%} | {told:.0%} | "
                f"{stated:.1%} |",
                flush=True,
            )
        if not spread:
            alarms = [any(x.state == "changed" for x in judged(known, [one])) for one in found]
            print(f"drift: {np.mean(alarms):.1%} of {len(found)} recordings", flush=True)


if __name__ == "__main__":
    main()
