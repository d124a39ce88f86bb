"""Make the logs that ship: those of `frictionjoint demo`, and the recording of the tutorial.

    python scripts/make_logs.py demo          # rewrites frictionjoint/demo/
    python scripts/make_logs.py recording     # rewrites examples/recording/

Geared arms with a gravity load, stepped by MuJoCo at 0.1 ms: one with generalised Maxwell-slip
friction and MuJoCo's own `dcmotor` cogging, which its model does not mention, and one with LuGre
friction that grows with its load, in columns with the names of an invented recorder. Nothing of the
package under test takes part.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "lab"))  # plants
from plants.plant import simulate, write
from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

ROOT = Path(__file__).resolve().parents[1]
DEMO = PlantSpec(
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
RECORDING = PlantSpec(
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
DIGITS = {"time_s": "%.4f", "torque_nm": "%.3f", "target_rad": "%.4f", "position_rad": "%.6f"}
COLUMNS = {"stamp": "time_s", "q_meas": "position_rad", "tau_meas": "torque_nm"}


def names(spec: PlantSpec) -> list[str]:
    """Files of the logs, by their motions."""
    return [f"{motion.kind.replace('-', '_')}.csv" for motion in spec.motions]


def main() -> None:
    """Simulate a joint; write its three logs and the model its user believes in."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("which", choices=("demo", "recording"))
    if parser.parse_args().which == "demo":
        write(simulate(DEMO), ROOT / "frictionjoint" / "demo", names(DEMO), DIGITS)
        return
    trial, folder = simulate(RECORDING), ROOT / "examples" / "recording"
    logs = [{name: log[ours] for name, ours in COLUMNS.items()} for log in trial.logs]
    digits = {name: DIGITS[ours] for name, ours in COLUMNS.items()}
    write(replace(trial, logs=logs), folder, names(RECORDING), digits)
    model = (folder / "joint.xml").rename(folder / "arm.xml")
    model.write_text(model.read_text().replace('name="joint"', 'name="elbow"'))


if __name__ == "__main__":
    main()
