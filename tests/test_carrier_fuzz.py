"""Whatever an MJCF carries as friction: a model that simulates, or one line that says why not."""

import os
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from frictionjoint import attach, install, load_model
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import FrictionJointError
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate.carrier import read_friction

# more inputs on demand: FRICTIONJOINT_FUZZ=20000 pytest tests/test_carrier_fuzz.py
EXAMPLES = int(os.environ.get("FRICTIONJOINT_FUZZ", "60"))

BARE = """<mujoco><compiler angle="radian"/><worldbody>
<body><joint name="elbow" axis="0 1 0"/><geom size=".1" mass="1" pos=".2 0 0"/>
<body pos=".3 0 0"><joint name="tip" type="slide" axis="1 0 0"/><geom size=".05" mass=".2"/></body>
</body></worldbody></mujoco>"""
GOOD = FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.3, n=2, knots=((1e-3, 1.5), (1e-2, 3.2))
)
EFFECT = next(e for e in CATALOGUE if e.name == "position-periodic")


def carrying() -> str:
    spec = mujoco.MjSpec.from_string(BARE)
    effect = SimulatedEffect(EFFECT, (3.0,) * len(EFFECT.shape), (0.1,) * len(EFFECT.coefficients))
    install(spec, {"elbow": GOOD, "tip": GOOD}, {"elbow": [effect]})
    spec.compile()
    return str(spec.to_xml())


TEXT = carrying()
# every number of the two blocks, and what sizes, names and types stand in the file
NUMBERS = [
    m.span()
    for block in re.finditer(r'data="([^"]*)"', TEXT)
    for m in re.compile(r"[^ \"]+").finditer(TEXT, block.start(1), block.end(1))
]


@pytest.fixture(scope="module")
def file():
    before = os.getcwd()
    with TemporaryDirectory() as folder:
        os.chdir(folder)  # MuJoCo writes its warnings to a file here
        yield Path(folder) / "arm.xml"
        os.chdir(before)


def never_anything_else(file: Path, content: bytes) -> None:
    """Load a file of that content; what loads is valid and simulates to finite numbers."""
    file.write_bytes(content)
    try:
        model = load_model(file)
        found = read_friction(model)
    except FrictionJointError as error:
        text = str(error)
        assert "\n" not in text
        return
    assert found
    for carried in found.values():
        assert np.isfinite(carried.parameters.pack()).all()
    if model.opt.timestep > 1.0:
        return
    data = mujoco.MjData(model)
    with attach(model):
        mujoco.mj_step(model, data, nstep=3)
    assert np.isfinite(data.qpos).all()


number = st.floats(allow_nan=False, allow_infinity=False).map(repr) | st.integers(
    -(10**6), 10**6
).map(str)
word = st.sampled_from(["nan", "inf", "", "x", "1 2", "65536", "-1", "0.5", "1e400"])


@settings(max_examples=EXAMPLES, deadline=None)
@given(at=st.sampled_from(NUMBERS), text=number | word)
def test_a_block_with_one_number_changed(file: Path, at: tuple[int, int], text: str) -> None:
    start, end = at
    never_anything_else(file, (TEXT[:start] + text + TEXT[end:]).encode())


@settings(max_examples=EXAMPLES, deadline=None)
@given(count=st.integers(0, len(NUMBERS)), from_end=st.booleans())
def test_a_block_cut_short(file: Path, count: int, from_end: bool) -> None:
    spans = NUMBERS[-count:] if from_end and count else NUMBERS[:count]
    text = TEXT
    for start, end in reversed(spans):
        text = text[:start] + text[end:]
    never_anything_else(file, text.encode())


@settings(max_examples=EXAMPLES, deadline=None)
@given(at=st.integers(0, len(TEXT)), length=st.integers(0, 20), piece=st.text(max_size=5))
def test_a_file_corrupt_somewhere(file: Path, at: int, length: int, piece: str) -> None:
    corrupt = (TEXT[:at] + piece + TEXT[at + length :]).encode("utf-8", "surrogatepass")
    never_anything_else(file, corrupt)
