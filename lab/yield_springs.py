"""MuJoCo 4.0's yield springs as joint friction: holding, drift and stopping, per integrator.

    python lab/yield_springs.py         prints the table of lab/notes/native_friction.md; needs 4.0

One hinge of 0.01 kg m^2 at 1 ms. Fixed tendons with `springyield` form a Maxwell-slip model with a
yield torque of 1 N m; `ratio` is h sqrt(K/J) of their total stiffness K.
"""

import math

import mujoco

INERTIA, STEP, YIELD = 0.01, 1e-3, 1.0
# fractions of the total stiffness and of the total yield torque, per tendon
ELEMENTS = ((0.6, 0.3), (0.3, 0.4), (0.1, 0.3))
INTEGRATORS = ("Euler", "implicitfast", "discrete")


def joint(ratio: float, integrator: str) -> mujoco.MjModel:
    """A hinge whose only friction is three yield springs."""
    K = INERTIA * (ratio / STEP) ** 2
    tendons = "".join(
        f'<fixed stiffness="{k * K}" springlength="0" springyield="{f * YIELD / (k * K)}">'
        '<joint joint="j" coef="1"/></fixed>'
        for k, f in ELEMENTS
    )
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{STEP}" gravity="0 0 0" integrator="{integrator}"/>'
        '<worldbody><body><joint name="j"/><inertial pos="0 0 0" mass="1" '
        f'diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body></worldbody>'
        f"<tendon>{tendons}</tendon></mujoco>"
    )


def held(ratio: float, integrator: str) -> float:
    """Displacement over 10 s under half of the yield torque, rad, after the first second."""
    model = joint(ratio, integrator)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.5 * YIELD
    mujoco.mj_step(model, data, round(1.0 / STEP))
    start = data.qpos[0]
    mujoco.mj_step(model, data, round(10.0 / STEP))
    return abs(data.qpos[0] - start)


def drift(ratio: float, integrator: str) -> float:
    """Displacement per cycle under 0.5 +- 0.4 of the yield torque at 1 Hz, rad, in 20 cycles."""
    model = joint(ratio, integrator)
    data = mujoco.MjData(model)
    period = round(1.0 / STEP)
    ends = []
    for k in range(25 * period):
        data.qfrc_applied[0] = YIELD * (0.5 + 0.4 * math.sin(2 * math.pi * k / period))
        mujoco.mj_step(model, data)
        if k % period == period - 1:
            ends.append(data.qpos[0])
    return (ends[-1] - ends[4]) / 20


def pulled(ratio: float, integrator: str) -> float:
    """Speed after 0.02 s under twice the yield torque, rad/s; 2.0 without viscous friction."""
    model = joint(ratio, integrator)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 2.0 * YIELD
    mujoco.mj_step(model, data, 20)
    return data.qvel[0]


if __name__ == "__main__":
    print("| h sqrt(K/J) | integrator | creep in 10 s, rad | drift, rad per cycle | speed, rad/s |")
    print("|---|---|---|---|---|")
    for ratio in (0.3, 1.0, 3.6, 10.0):
        for integrator in INTEGRATORS:
            numbers = (f(ratio, integrator) for f in (held, drift, pulled))
            print(f"| {ratio:g} | {integrator} | " + " | ".join(f"{x:.2g}" for x in numbers) + " |")
