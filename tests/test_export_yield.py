"""Springs that yield, of stock MuJoCo 4.0, in the place of our friction."""

import itertools

import mujoco
import numpy as np
import pytest
from exported import carrying
from test_early_checks import stages

import frictionjoint as fj
from frictionjoint.errors import ModelError
from frictionjoint.export.presliding import yield_springs
from frictionjoint.export.run import export
from frictionjoint.law.motion import friction_torque
from frictionjoint.rivals import StaticParameters

LAW = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.5, Vs=0.05, sigma2=0.1, knots=((1e-3, 1.5), (4e-3, 2.5), (8e-3, 3.0))
)
ARM = """<mujoco><option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"/><worldbody>
<body><joint name="elbow" ref="20"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/>
</body></worldbody></mujoco>"""
NEEDED = pytest.mark.skipif(
    not hasattr(mujoco.MjModel, "tendon_springyield"), reason="springs that yield need MuJoCo 4.0"
)


def test_elements_follow_the_law_through_loops_within_loops() -> None:
    springs = yield_springs(LAW, 1.5)
    assert 2 <= len(springs.stiffness) <= 4
    assert springs.stiffness @ springs.displacement == pytest.approx(1.5)
    turns = (0.0, 1.5e-2, 7e-3, 1e-2, -5e-3, 2e-3, 0.0)
    q = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(turns)])
    law = friction_torque(LAW, 10.0 * np.arange(len(q)), q)
    # from the first reversal on: a joint that never moved may load by another curve
    elements = zip(springs.stiffness, springs.displacement, strict=True)
    torque = sum(stages(q, k * most, most) for k, most in elements)
    apart, law = (torque - law)[200:], law[200:]
    # four elements are a coarse curve; plain Coulomb friction misses by 0.9
    assert np.sqrt(np.mean(apart**2)) < 0.2 * np.sqrt(np.mean(law**2))


def test_what_it_cannot_do_is_refused(tmp_path) -> None:
    static = StaticParameters.symmetric(Fs=1.0, Fc=0.8, Vs=0.1, delta=2.0, sigma2=0.1, V0=1e-3)
    with pytest.raises(ModelError, match="static has no presliding stiffness"):
        yield_springs(static, 0.8)
    path = carrying(ARM, LAW, tmp_path)
    with pytest.raises(ModelError, match="--yield is for the target native"):
        export(path, "urdf", tmp_path / "a.urdf", yielding=True)
    if not hasattr(mujoco.MjModel, "tendon_springyield"):
        with pytest.raises(ModelError, match=r"need MuJoCo 4\.0"):
            export(path, "native", tmp_path / "a.xml", yielding=True)


@NEEDED
def test_stock_mujoco_holds_without_drift_and_slides(tmp_path) -> None:
    """0.5 +- 0.4 N m for 20 s, where MuJoCo's LuGre creeps by 7e-4 rad per cycle."""
    path = carrying(ARM, LAW, tmp_path)
    yields = export(path, "native", tmp_path / "a.xml", yielding=True)
    today = export(path, "native", tmp_path / "b.xml")
    assert yields.losses[0].torque_lost < 0.6 * today.losses[0].torque_lost
    assert yields.losses[0].apart < 0.3 * today.losses[0].apart
    assert not yields.lost
    model = mujoco.MjModel.from_xml_string(yields.text)
    data = mujoco.MjData(model)
    start, places = float(data.qpos[0]), []
    for k in range(40_000):
        t = 5e-4 * k
        data.qfrc_applied[0] = min(1.0, t) * (0.5 + 0.4 * np.sin(2.0 * np.pi * t))
        mujoco.mj_step(model, data)
        places.append(float(data.qpos[0]) - start)
    cycle = 2000
    assert abs(places[-1] - places[-1 - cycle * 10]) < 1e-9
    assert 0.0 < max(places) < 2e-3
    for _ in range(4000):
        data.qfrc_applied[0] = 2.5
        mujoco.mj_step(model, data)
    # viscous friction takes what is above the springs' limit
    assert data.qvel[0] == pytest.approx((2.5 - 1.5) / 0.1, rel=0.35)
