"""A pendulum in plain NumPy with the friction of its joint: it comes to rest off the vertical.

    python examples/numpy_pendulum.py

`FrictionBatch` gives torque, stiffness and damping for the step that begins. Taking the last two
into the step makes it implicit, so that the joint sticks at 200 steps per second as well.
"""

import numpy as np

import frictionjoint as fj

STEP, SECONDS = 5e-3, 10.0
MASS, LENGTH, GRAVITY = 1.0, 0.3, 9.81
INERTIA = MASS * LENGTH**2
FRICTION = fj.FrictionParameters.symmetric(
    Fs=0.5, Fc=0.4, Vs=0.05, sigma2=0.01, knots=((1e-3, 0.5), (4e-3, 1.0))
)


def swing(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles in the end and half way, rad, shape (n,), of pendulums released at these angles."""
    friction = fj.FrictionBatch(FRICTION, len(angles))
    q, v = angles.copy(), np.zeros_like(angles)
    half_way = q
    for k in range(int(SECONDS / STEP)):
        if k == int(0.5 * SECONDS / STEP):
            half_way = q.copy()
        torque, stiffness, damping = friction.step(q, v, STEP)
        other = -MASS * GRAVITY * LENGTH * np.sin(q) - torque + damping * v
        v = (INERTIA * v + STEP * other) / (INERTIA + STEP * (STEP * stiffness + damping))
        q = q + STEP * v
    return half_way, q


def main() -> None:
    begin = np.array([0.05, 0.1, 0.5, 1.0])
    half_way, end = swing(begin)
    for first, middle, last in zip(begin, half_way, end, strict=True):
        print(
            f"from {first:.2f} rad: rests at {last:.4f} rad, creep in the last "
            f"{0.5 * SECONDS:.0f} s {abs(last - middle):.1e} rad"
        )


if __name__ == "__main__":
    main()
