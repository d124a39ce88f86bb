"""The rival laws: each keeps the promises of its paper, and none breaks at any step."""

import contextlib
import dataclasses

import mujoco
import numpy as np
import pytest
from acting import LEVELS, RIVALS
from hypothesis import given, settings
from hypothesis import strategies as st

import frictionjoint as fj
from frictionjoint import friction_torque
from frictionjoint.errors import ParameterError
from frictionjoint.rivals import DahlParameters, LuGreParameters

(FS, FC, VS, SIGMA2), K = LEVELS.values(), 1e4
HYSTERETIC = RIVALS[1:]
BY_NAME = {p.law: p for p in RIVALS}
each_law = pytest.mark.parametrize("p", RIVALS, ids=lambda p: p.law)
each_hysteretic = pytest.mark.parametrize("p", HYSTERETIC, ids=lambda p: p.law)


def dry(p):
    """Without viscous friction and presliding damping."""
    values = {name: 0.0 for name in ("sigma2_pos", "sigma2_neg", "sigma1") if hasattr(p, name)}
    return dataclasses.replace(p, **values)


@each_law
@pytest.mark.parametrize("v", [0.02, 0.1, 0.5, -0.1])
def test_steady_sliding_is_the_stribeck_curve(p, v):
    level = FC if p.law == "dahl" else FC + (FS - FC) * np.exp(-((v / VS) ** 2))
    t = np.linspace(0.0, 2.0, 2001)
    assert friction_torque(p, t, v * t)[-1] == pytest.approx(
        np.sign(v) * level + SIGMA2 * v, rel=1e-4 if p.law == "static" else 1e-6
    )


@each_hysteretic
def test_presliding_starts_with_the_stiffness(p):
    t = np.linspace(0.0, 2.0, 2001)
    q = 1e-9 * t
    slope = friction_torque(dry(p), t, q)[-1] / q[-1]
    assert slope == pytest.approx(K, rel=1e-4)  # the Maxwell-slip springs add up to K as well


@each_law
def test_mirrored_motion_mirrors_the_torque(p):
    t = np.linspace(0.0, 2.0, 1001)
    q = 1e-3 * np.sin(7 * t) + 0.02 * np.sin(3.1 * t)
    np.testing.assert_allclose(friction_torque(p, t, -q), -friction_torque(p, t, q), atol=1e-12)


@settings(max_examples=200)
@given(
    st.sampled_from(RIVALS),
    st.lists(
        st.tuples(st.floats(-12, 3), st.booleans(), st.floats(-6, 2)), min_size=1, max_size=40
    ),
)
def test_finite_and_bounded_for_any_steps(p, moves):
    steps = np.array([10**e * (1 if up else -1) for e, up, _ in moves])
    t = np.concatenate(([0.0], np.cumsum([10**d for *_, d in moves])))
    F = friction_torque(dry(p), t, np.append(0.0, np.cumsum(steps)))
    assert np.isfinite(F).all()
    # the published presliding damping and spring-to-slide jump stay within the level as well
    assert np.abs(F).max() <= FS * (1 + 1e-9)


def test_dahl_follows_its_closed_forms():
    """Dahl (1968): i = 1 an exponential, i = 0 a spring with a limit, i = 2 a hyperbola."""
    x = np.linspace(0.0, 5e-4, 501)
    for i, expected in (
        (0.0, np.minimum(K * x, FC)),
        (1.0, FC * (1 - np.exp(-K * x / FC))),
        (2.0, FC * (1 - 1 / (1 + K * x / FC))),
    ):
        p = DahlParameters.symmetric(Fc=FC, sigma0=K, i=i)
        np.testing.assert_allclose(friction_torque(p, x, x), expected, atol=1e-9)


def test_elastoplastic_is_a_spring_below_its_breakaway_and_does_not_drift():
    """Dupont et al. (2002): the property LuGre lacks."""
    p = dry(BY_NAME["elastoplastic"])
    t = np.linspace(0.0, 20.0, 4001)
    q = 3e-5 + 2e-5 * np.sin(5 * t)  # torque 0.1 to 0.5 N m, below 0.7 Fc
    q[0] = 0.0
    np.testing.assert_allclose(friction_torque(p, t, q), K * q, atol=1e-9)
    lugre = friction_torque(dry(BY_NAME["lugre"]), t, q)
    assert np.abs(lugre - K * q).max() > 0.1


def test_maxwell_slip_is_a_superposition_of_jenkins_elements_at_a_constant_level():
    p = dataclasses.replace(dry(BY_NAME["maxwell_slip"]), Fc_pos=FS, Fc_neg=FS)
    rng = np.random.default_rng(0)
    q = np.append(0.0, np.cumsum(rng.normal(0.0, 1e-4, 400)))
    expected, elements = [0.0], [0.0, 0.0, 0.0]
    for dq in np.diff(q):
        for i, (k, share) in enumerate(BY_NAME["maxwell_slip"].elements):
            elements[i] = float(np.clip(elements[i] + k * dq, -share * FS, share * FS))
        expected.append(sum(elements))
    np.testing.assert_allclose(friction_torque(p, np.arange(q.size) * 1.0, q), expected, atol=1e-9)


LUGRE_JOINT = """<mujoco><option timestep="{h}" integrator="implicitfast" gravity="0 0 0"/>
<size nuserdata="200"/><worldbody><body><joint name="j" damping="{damping}"/>
<geom size="0.1" mass="2.5"/></body></worldbody><actuator>{own}<motor joint="j"/></actuator>
</mujoco>"""


def test_lugre_agrees_with_the_one_in_mujoco():
    """`dcmotor` with lugre, the same sine of torque through stick and slip, step for step."""
    lugre = "200 2 1 1.5 0.05"
    native = LUGRE_JOINT.format(
        h=1e-4,
        damping=0.4,
        own=f'<dcmotor joint="j" input="none" motorconst="1e-6" resistance="1" lugre="{lugre}"/>',
    )
    p = LuGreParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, sigma2=0.4, sigma0=200.0, sigma1=2.0)
    runs = []
    for text, friction in ((native, None), (LUGRE_JOINT.format(h=1e-4, damping=0, own=""), p)):
        spec = mujoco.MjSpec.from_string(text)
        if friction:
            fj.install(spec, {"j": friction})
        model = spec.compile()
        data = mujoco.MjData(model)
        track = []
        with fj.attach(model) if friction else contextlib.nullcontext():
            while data.time < 2.0:
                data.ctrl[-1] = 2.5 * np.sin(2 * np.pi * data.time)
                mujoco.mj_step(model, data)
                track.append(data.qpos[0])
        runs.append(np.array(track))
    a, b = runs
    assert np.ptp(a) > 0.5  # it slid
    assert np.abs(a - b).max() < 5e-3 * np.ptp(a)


@each_law
def test_carried_by_an_mjcf_and_felt_by_a_joint(p):
    spec = mujoco.MjSpec.from_string(LUGRE_JOINT.format(h=1e-3, damping=0, own=""))
    fj.install(spec, {"j": p})
    model = mujoco.MjModel.from_xml_string(spec.to_xml())
    data = mujoco.MjData(model)
    with fj.attach(model):
        data.ctrl[0] = 3.0
        for _ in range(3000):
            mujoco.mj_step(model, data)
        moving = data.qvel[0]
        data.ctrl[0] = 0.0
        for _ in range(6000):
            mujoco.mj_step(model, data)
    assert 3.0 < moving < 5.5  # (3 - Fc)/sigma2 = 5 in the long run
    # the static law holds nothing: it chatters by what Fs does to the inertia in a step
    assert abs(data.qvel[0]) < (1.01 * 1e-3 * FS / 0.01 if p.law == "static" else 0.02)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"sigma0": 0.0}, "sigma0 is 0: it must be > 0"),
        ({"Fc_pos": 2.0}, "Fc_pos is 2"),
        ({"breakaway": 1.0}, "breakaway is 1: it must be in"),
        ({"sigma1": float("nan")}, "sigma1"),
    ],
)
def test_bad_values_are_named(change, says):
    with pytest.raises(ParameterError, match=says):
        dataclasses.replace(BY_NAME["elastoplastic"], **change)
