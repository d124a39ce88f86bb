"""What all tests share: where the trial plants and the measured logs lie."""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

# the trial plants live beside the scripts that use them
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
# tests.third_hand has one name everywhere: numba's cache holds it. Last, so that an installed
# frictionjoint is the one that is tested
sys.path.append(str(Path(__file__).resolve().parents[1]))

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
