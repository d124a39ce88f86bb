"""Make the recording of the tutorial: a joint whose friction grows with its load.

    python scripts/make_recording.py                 # rewrites examples/recording/

A geared arm with a gravity load and LuGre friction, stepped by MuJoCo at 0.1 ms. Nothing of the
package under test takes part. The columns have the names of an invented recorder.
"""

import sys
from dataclasses import replace
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

ROOT = Path(__file__).resolve().parents[1]
SPEC = PlantSpec(
    mass=2.0,
    length=0.3,
    inertia=0.22,
    armature=0.08,
    friction=Friction("lugre", Fs=1.1, Fc=0.8, Vs=0.1, sigma2=0.5, presliding=2e-3),
    controller=Controller(kp=90.0, kd=6.0, ki=40.0),
    motions=(
        Motion("ramps", 21, amplitude=1.2, speed=1.0, duration=12.0),
        Motion("pick-and-place", 22, amplitude=1.2, speed=1.8, duration=12.0),
        Motion("multisine", 23, amplitude=1.1, speed=1.5, duration=12.0),
    ),
    instrument=Instrument(rate=200.0, counts=2**18, torque_noise=0.05, jitter=0.02),
    seed=2026,
    effects=(Effect("load-dependent", {"slope": 0.2}),),
)
NAMES = ("ramps.csv", "pick_and_place.csv", "multisine.csv")
COLUMNS = {"stamp": "time_s", "q_meas": "position_rad", "tau_meas": "torque_nm"}
DIGITS = {"stamp": "%.4f", "q_meas": "%.6f", "tau_meas": "%.3f"}


def main() -> None:
    """Simulate the joint; write three logs and the model that its user has."""
    trial = simulate(SPEC)
    logs = [{name: log[ours] for name, ours in COLUMNS.items()} for log in trial.logs]
    folder = ROOT / "examples" / "recording"
    write(replace(trial, logs=logs), folder, NAMES, DIGITS)
    model = (folder / "joint.xml").rename(folder / "arm.xml")
    model.write_text(model.read_text().replace('name="joint"', 'name="elbow"'))


if __name__ == "__main__":
    main()
