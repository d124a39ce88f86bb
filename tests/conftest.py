"""What all tests share: where the trial plants and the measured logs lie."""

import fcntl
import os
import pickle
import sys
from importlib.resources import files
from pathlib import Path

# workers side by side take a core each: threads within them would only compete
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("FRICTIONJOINT_THREADS", "1")

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parents[1]
# simulated joints and arms of the laboratory
sys.path[:0] = [str(ROOT / name) for name in ("examples", "lab", "scripts")]
# last, so that an installed frictionjoint is the one that is tested
sys.path.append(str(ROOT))

# first examples compile kernels: a deadline would time the compiler
settings.register_profile("frictionjoint", deadline=None)
settings.load_profile("frictionjoint")


@pytest.fixture(scope="session")
def measured_data() -> Path:
    """Folder of the public measured logs; skips the test where it is absent."""
    fallback = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("FRICTIONJOINT_DATA", fallback))
    if not folder.is_dir():
        pytest.skip(f"no measured logs: set FRICTIONJOINT_DATA (looked in {folder})")
    return folder


@pytest.fixture(scope="session")
def demo_report(tmp_path_factory):
    """Report of the whole loop on the shipped logs, once for all tests and all workers."""
    from frictionjoint import close_loop

    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    made = folder / "demo_report.pickle"
    with (folder / "demo_report.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not made.exists():
            demo = Path(str(files("frictionjoint"))) / "demo"
            fitted = [demo / f"{name}.csv" for name in ("pick_and_place", "ramps")]
            report = close_loop(fitted, demo / "joint.xml", "joint", [demo / "multisine.csv"])
            made.write_bytes(pickle.dumps(report))
    return pickle.loads(made.read_bytes())
