"""Make the shipped log: one joint whose cogging its model does not mention.

    python scripts/make_demo_log.py                     # rewrites frictionjoint/demo/

The plant is a geared arm with a gravity load, generalised Maxwell-slip friction and MuJoCo's own
`dcmotor` cogging, stepped by MuJoCo at 0.1 ms. Nothing of the package under test takes part.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "lab"))  # plants
from plants.plant import (
    Controller,
    Effect,
    Friction,
    Instrument,
    Motion,
    PlantSpec,
    simulate,
    write,
)

SPEC = PlantSpec(
    mass=1.2,
    length=0.25,
    inertia=0.1,
    armature=0.05,
    friction=Friction("gms", Fs=1.2, Fc=1.0, Vs=0.15, sigma2=0.35, presliding=1e-3),
    controller=Controller(kp=80.0, kd=5.0, ki=60.0),
    motions=(
        Motion("pick-and-place", 11, amplitude=1.1, speed=2.0, duration=12.0),
        Motion("ramps", 12, amplitude=0.9, speed=1.0, duration=12.0),
        Motion("multisine", 13, amplitude=1.0, speed=2.2, duration=12.0),
    ),
    instrument=Instrument(rate=250.0, counts=2**19, torque_noise=0.05, jitter=0.02),
    seed=1997,
    effects=(Effect("position-periodic", {"amplitude": 0.3, "cycles": 14.0, "phase": 0.7}),),
)
NAMES = ("pick_and_place.csv", "ramps.csv", "multisine.csv")
DIGITS = {"time_s": "%.4f", "torque_nm": "%.3f", "target_rad": "%.4f", "position_rad": "%.6f"}


def main() -> None:
    """Simulate the test joint and write its three logs and the model its user believes in."""
    folder = Path(__file__).resolve().parents[1] / "frictionjoint" / "demo"
    write(simulate(SPEC), folder, NAMES, DIGITS)


if __name__ == "__main__":
    main()
