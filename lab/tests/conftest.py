"""Tests of the laboratory itself: `pytest lab/tests`."""

import sys
from pathlib import Path

from hypothesis import settings

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / name) for name in ("lab", "scripts", "tests")]
sys.path.append(str(ROOT))

settings.register_profile("laboratory", deadline=None)
settings.load_profile("laboratory")
