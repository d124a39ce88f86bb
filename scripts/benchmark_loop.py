"""Time and memory of the base fit and of the whole loop against the length of the log.

    python scripts/benchmark_loop.py [--seconds 15 60] [--json]

Logs at 1 kHz of a plant of `scripts/plants` with generalized Maxwell-slip friction and cogging.
Each length runs in a process of its own, so that its memory is its own; kernels are compiled before
the clock starts. The peak is that of the process, libraries included.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
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


def plant(seconds: float) -> PlantSpec:
    """A joint with a load on a lever and cogging, led by a multisine, then by ramps."""
    return PlantSpec(
        mass=1.0,
        length=0.2,
        inertia=0.06,
        armature=0.02,
        friction=Friction("gms", Fs=0.8, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3),
        controller=Controller(kp=60.0, kd=3.0),
        motions=(
            Motion("multisine", 3, 0.8, 2.0, seconds / 2),
            Motion("ramps", 4, 0.8, 1.0, seconds / 2),
        ),
        instrument=Instrument(rate=1000.0, counts=2**20, torque_noise=0.01),
        seed=1,
        effects=(Effect("position-periodic", {"amplitude": 0.1, "cycles": 9.0, "phase": 0.4}),),
    )


def measure(seconds: float) -> dict[str, Any]:
    """Seconds of the base fit and of the loop, MB at the peak, what was found."""
    from frictionjoint.diagnose.close_loop import close_loop
    from frictionjoint.identify.fit import fit
    from frictionjoint.identify.prepare import prepare
    from frictionjoint.identify.rigid_body import RigidBody
    from frictionjoint.measured.readers import read_log

    with tempfile.TemporaryDirectory() as folder:
        write(simulate(plant(6.0)), Path(folder))
        few = [read_log(path, "joint") for path in sorted(Path(folder).glob("*.csv"))]
        close_loop(few, Path(folder) / "joint.xml", "joint")  # compiles
    with tempfile.TemporaryDirectory() as folder:
        paths = write(simulate(plant(seconds)), Path(folder))
        model = Path(folder) / "joint.xml"
        begin = time.perf_counter()
        logs = [read_log(path, "joint") for path in paths]
        reading = time.perf_counter() - begin
        prepared = prepare(logs, RigidBody(model, "joint"))
        begin = time.perf_counter()
        fit(prepared)
        base = time.perf_counter() - begin
        begin = time.perf_counter()
        report = close_loop(logs, model, "joint")
        whole = time.perf_counter() - begin
    return {
        "seconds": seconds,
        "reading_s": reading,
        "base_fit_s": base,
        "loop_s": whole,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "added": [added.effect for added in report.added],
    }


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seconds", type=float, nargs="+", default=[15.0, 60.0, 240.0])
    parser.add_argument("--one", type=float, help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(measure(given.one)))
        return
    rows = []
    for seconds in given.seconds:
        command = [sys.executable, __file__, "--one", str(seconds)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        rows.append(json.loads(done.stdout.splitlines()[-1]))
    if given.json:
        print(json.dumps(rows, indent=2))
        return
    print(f"{os.cpu_count()} CPUs, load {os.getloadavg()[0]:.1f} at the end\n")
    print("| log at 1 kHz | base fit | whole loop | peak memory | effects added |")
    print("|---|---|---|---|---|")
    for row in rows:
        print(
            f"| {row['seconds']:g} s | {row['base_fit_s']:.1f} s | {row['loop_s']:.1f} s | "
            f"{row['peak_mb']:.0f} MB | {', '.join(row['added']) or 'none'} |"
        )


if __name__ == "__main__":
    main()
