"""Friction as feed-forward in a control loop of 1 kHz: the tracking error with and without it.

    python examples/feed_forward.py

The controller drives its own copy of the friction along the desired motion, which it knows without
noise, and adds the torque that comes out. The joint is MuJoCo's, with the same friction.
"""

import time

import mujoco
import numpy as np

import frictionjoint as fj

RATE, SECONDS, KP, KD = 1000.0, 4.5, 20.0, 0.5
FRICTION = fj.FrictionParameters.symmetric(
    Fs=1.0, Fc=0.8, Vs=0.1, sigma2=0.2, knots=((1e-3, 1.0), (4e-3, 2.0))
)
JOINT = """<mujoco><option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"/><worldbody>
<body><joint name="joint"/><inertial pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.05"/></body>
</worldbody></mujoco>"""


def desired(t: float) -> tuple[float, float, float]:
    """Position, velocity and acceleration: slow, with reversals inside presliding."""
    parts = ((0.3, 1.5), (0.02, 9.0))
    return (
        sum(a * np.sin(w * t) for a, w in parts),
        sum(a * w * np.cos(w * t) for a, w in parts),
        sum(-a * w * w * np.sin(w * t) for a, w in parts),
    )


def track(feed_forward: bool) -> tuple[float, float]:
    """rms tracking error, rad, and seconds that one call of the friction takes."""
    spec = mujoco.MjSpec.from_string(JOINT)
    fj.install(spec, {"joint": FRICTION})
    model = spec.compile()
    data = mujoco.MjData(model)
    friction = fj.FrictionBatch(FRICTION, 1)
    q, v = np.zeros(1), np.zeros(1)
    data.qvel[0] = desired(0.0)[1]
    errors, spent = [], 0.0
    per_tick = round(1.0 / RATE / model.opt.timestep)
    with fj.attach(model):
        for k in range(int(SECONDS * RATE)):
            q[0], v[0], a = desired(k / RATE)
            begin = time.perf_counter()
            torque, _, _ = friction.step(q, v, 1.0 / RATE)
            spent += time.perf_counter() - begin
            u = 0.05 * a + KP * (q[0] - data.qpos[0]) + KD * (v[0] - data.qvel[0])
            data.qfrc_applied[0] = u + float(torque[0]) * feed_forward
            errors.append(q[0] - data.qpos[0])
            mujoco.mj_step(model, data, per_tick)
    return float(np.sqrt(np.mean(np.square(errors)))), spent / len(errors)


def main() -> None:
    without, _ = track(False)
    with_friction, seconds = track(True)
    print(f"tracking error without feed-forward {1e3 * without:.2f} mrad")
    print(f"tracking error with feed-forward {1e3 * with_friction:.2f} mrad")
    print(f"one call takes {1e6 * seconds:.1f} us of a tick of {1e6 / RATE:.0f} us")


if __name__ == "__main__":
    main()
