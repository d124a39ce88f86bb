"""Whatever a parameter file holds: parameters that keep their promises, or one line."""

import json
import math
import os
import zlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ParameterError
from frictionjoint.files import read_parameters, toml_text
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.laws import unpack
from frictionjoint.parameters import FrictionParameters

# more inputs on demand: FRICTIONJOINT_FUZZ=20000 pytest tests/test_parameters_fuzz.py
EXAMPLES = int(os.environ.get("FRICTIONJOINT_FUZZ", "120"))

GOOD = FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.3, n=2, knots=((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))
)
EFFECTS = tuple(
    SimulatedEffect(e, (0.5,) * len(e.shape), (0.1,) * len(e.coefficients)) for e in CATALOGUE[:3]
)


@pytest.fixture(scope="module")
def file():
    with TemporaryDirectory() as folder:
        yield Path(folder) / "joint.toml"


def never_anything_else(file: Path, content: bytes) -> None:
    """Read a file of that content; what was read is finite, packs, and reads back the same."""
    file.write_bytes(content)
    try:
        found = read_parameters(file)
    except ParameterError as error:
        text = str(error)
        assert "\n" not in text
        assert file.name in text
        return
    block = found.parameters.pack()
    assert np.isfinite(block).all()
    assert unpack(block) == found.parameters
    assert all(np.isfinite(e.pack()).all() for e in found.effects)
    if zlib.crc32(content) % 16 == 0:  # writing is the slow part
        file.write_text(toml_text(found.parameters, found.effects), encoding="utf-8")
        assert read_parameters(file) == found


number = (
    st.floats()
    | st.integers()
    | st.sampled_from([0.0, -0.0, 5e-324, 1e308, math.inf, -math.inf, math.nan, 1.5, 3.0, 10**400])
)
leaf = number | st.booleans() | st.text(max_size=4) | st.dates() | st.times()
anything: st.SearchStrategy[Any] = st.recursive(
    leaf,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=6,
)


LINES = toml_text(GOOD, EFFECTS).splitlines()
AT = [i for i, line in enumerate(LINES) if "=" in line]


def literal(value: Any) -> str:
    """A value as TOML; what TOML cannot say comes out as an error of the file."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {literal(x)}" for k, x in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(literal(x) for x in value) + "]"
    if isinstance(value, str | bool):
        return json.dumps(value)
    return repr(value) if isinstance(value, int | float) else str(value.isoformat())


@settings(max_examples=6 * EXAMPLES, deadline=None)
@given(at=st.sampled_from(AT), value=anything)
def test_a_good_file_with_one_bad_value_anywhere(file: Path, at: int, value: Any) -> None:
    name = LINES[at].partition("=")[0]
    lines = [*LINES[:at], f"{name}= {literal(value)}", *LINES[at + 1 :]]
    never_anything_else(file, "\n".join(lines).encode("utf-8", "surrogatepass"))


TEXT = toml_text(GOOD, EFFECTS).encode()


@settings(max_examples=EXAMPLES, deadline=None)
@given(at=st.integers(0, len(TEXT)), length=st.integers(0, 12), piece=st.binary(max_size=6))
def test_a_good_file_corrupt_somewhere(file: Path, at: int, length: int, piece: bytes) -> None:
    never_anything_else(file, TEXT[:at] + piece + TEXT[at + length :])


@settings(max_examples=EXAMPLES, deadline=None)
@given(
    Fs=st.floats(1e-6, 1e6),
    share=st.floats(1e-3, 1.0),
    Vs=st.floats(1e-6, 1e3),
    n=st.floats(1.0, 1000.0),
    length=st.floats(1e-9, 1.0),
    first=st.floats(0.3, 0.99),
)
def test_good_parameters_come_back_to_the_last_bit(
    file: Path, Fs: float, share: float, Vs: float, n: float, length: float, first: float
) -> None:
    knots = ((length, first * 2 * Fs), (4 * length, 2.01 * Fs))
    parameters = FrictionParameters.symmetric(Fs=Fs, Fc=share * Fs, Vs=Vs, n=n, knots=knots)
    file.write_text(toml_text(parameters, EFFECTS), encoding="utf-8")
    found = read_parameters(file)
    assert found.parameters == parameters
    assert found.effects == EFFECTS
