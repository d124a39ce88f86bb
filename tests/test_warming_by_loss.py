"""Friction that falls as its own loss warms the joint, found in two logs of unlike motion."""

import numpy as np
import pytest

from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.warm_up_drift import BY_WHOLE_LOSS
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog
from tests.three_sines import sines

INERTIA, TAU, LEVEL, VISCOUS, NOISE = 0.5, 15.0, 1.8, 1.2, 0.05
MODEL = f"""<mujoco><worldbody><body><joint name="j" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 {INERTIA}"/></body></worldbody></mujoco>"""
T = np.arange(0.0, 50.0, 0.01)
MOTIONS = ([(0.9, 0.21), (0.4, 0.53)], [(0.6, 0.31), (0.3, 0.83)])


def warming(name, lines, seed):
    """Level and viscosity fall by 1.5% and by 3% per kelvin; tau dT/dt = loss - T, 1 K/W."""
    q, v, a = sines(T, lines)
    side, heat = np.tanh(v / 0.02), 0.0
    friction = np.empty_like(T)
    for k, x in enumerate(v):
        friction[k] = LEVEL * (1.0 - 0.03 * heat) * side[k] + VISCOUS * np.exp(-0.06 * heat) * x
        heat += 0.01 * (friction[k] * x - heat) / TAU
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(T))
    return JointLog(name=name, joint="j", time=T, position=q, torque=INERTIA * a + friction + noise)


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    file = tmp_path_factory.mktemp("model") / "j.xml"
    file.write_text(MODEL)
    logs = [warming("a", MOTIONS[0], 1), warming("b", MOTIONS[1], 2)]
    return prepare(logs, RigidBody(file, "j"))


def test_it_is_found_with_its_time_constant(prepared):
    found = trace(prepared)
    (warm_up,) = found.findings
    assert warm_up.term.effect is BY_WHOLE_LOSS
    assert warm_up.term.shape[-1] == pytest.approx(TAU, rel=0.2)
    # cold, the friction is that of the law and of the effect together
    level, viscous = np.add(found.final.levels, found.final.term_coefficients(0))
    assert level == pytest.approx(LEVEL, rel=0.1)
    assert viscous == pytest.approx(VISCOUS, rel=0.1)
    assert not found.unexplained


@pytest.mark.parametrize(("errors", "named"), [(0.0, []), (0.5, ["warm-up-drift"])])
def test_an_open_size_counts_if_it_takes_half_of_the_rest(prepared, monkeypatch, errors, named):
    """Else it is listed with the reason, and the search goes on."""
    open_sizes = "frictionjoint.diagnose.final_evidence.undetermined"
    monkeypatch.setattr(open_sizes, lambda _, fit: dict.fromkeys(fit.effects, errors))
    found = trace(prepared)
    assert [f.term.name for f in found.findings] == named
    if not named:
        assert "warm-up-drift" in [row.name for row in found.last_look.rows]
        assert any("warm-up" in x and "do not determine its size" in x for x in found.hints)
        assert found.unexplained
