"""The effect that CONTRIBUTING.md shows works as it stands there."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

from frictionjoint.effects import signals

GUIDE = Path(__file__).resolve().parents[1] / "CONTRIBUTING.md"


@pytest.fixture(scope="module")
def magnet(tmp_path_factory):
    (code,) = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(), re.MULTILINE | re.DOTALL)
    file = tmp_path_factory.mktemp("guide") / "magnet.py"
    file.write_text(code)
    spec = importlib.util.spec_from_file_location("magnet", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_its_torque_pulls_as_its_form_says(magnet):
    width, strength = 0.2, 3.0
    torque = getattr(magnet.torque, "py_func", magnet.torque)  # it is not in the built library
    P, row, X = np.array([width, strength]), np.zeros(signals.N_SIGNALS), np.zeros(3)
    for q in (-0.3, 0.0, 0.1, 0.2, 2.0):
        row[signals.Q] = q
        expected = strength * q / width * np.exp(-((q / width) ** 2))
        assert torque(P, 0, row, X, 0) == pytest.approx(expected, rel=1e-12)
