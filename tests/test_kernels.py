"""Every kernel of the library gives the numbers of the Python it is translated from."""

import importlib
import json
import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from frictionjoint import library

RECORDER = Path(__file__).with_name("kernel_calls.py")
# they take addresses of MuJoCo's structures: tests/test_state.py steps them beside the Python ones
ADDRESSED = {"frictionjoint.simulate.native.native", "frictionjoint.simulate.native.both"}


def listed() -> dict:
    """Kernels of the library, by module and name."""
    library.load()
    return json.loads((library.FOLDER / library.LISTED).read_text())["kernels"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> dict:
    """Calls of kernels as Python, from two seeds."""
    found: dict = {}
    for seed in (0, 1):
        file = tmp_path_factory.mktemp("calls") / "calls.pkl"
        subprocess.run(
            [sys.executable, str(RECORDER), str(file), str(seed)],
            env=os.environ | {"FRICTIONJOINT_PYTHON": "1"},
            check=True,
            capture_output=True,
        )
        for name, calls in pickle.loads(file.read_bytes()).items():
            found.setdefault(name, []).extend(calls)
    return found


def of_name(name: str):
    module, _, own = name.rpartition(".")
    return getattr(importlib.import_module(module), own)


def flat(value) -> np.ndarray:
    """All numbers of a nest of tuples and arrays."""
    if value is None:
        return np.zeros(0)
    if isinstance(value, tuple | list):
        return np.concatenate([np.zeros(0), *map(flat, value)])
    return np.ravel(np.asarray(value, dtype=np.float64))


def test_every_kernel_was_called(recorded):
    missing = set(listed()) - set(recorded) - ADDRESSED
    assert not missing, f"call them in {RECORDER.name}"


@pytest.mark.parametrize("name", sorted(set(listed()) - ADDRESSED))
def test_a_kernel_gives_what_its_python_gives(name, recorded):
    kernel = of_name(name)
    for before, after in recorded[name]:
        given = pickle.loads(before)
        given_after, result = pickle.loads(after)
        got = kernel(*given)
        expected, found = flat((given_after, result)), flat((given, got))
        size = np.max(np.abs(expected), initial=0.0, where=np.isfinite(expected))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * min(1.0, size))
