"""What acts beside the motion: the gear's load, temperature and warmth, late instruments."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects import heating, measurement_delay, temperature_dependent, warm_up_drift
from frictionjoint.effects.friction_level import LOAD_DEPENDENT
from frictionjoint.errors import ModelError
from frictionjoint.joint_friction import SimulatedEffect
from frictionjoint.measured.log import JointLog
from frictionjoint.rivals import LuGreParameters

TWIST = -2.0  # N m, on the forearm
LAW = LuGreParameters.symmetric(Fs=1.0, Fc=1.0, Vs=0.05, sigma2=0.0, sigma0=1e4)
ARM = """<mujoco><option timestep="{step}" integrator="implicitfast"/><worldbody>
<body><joint name="a" axis="0 1 0" armature="0.02"/><geom type="capsule" size=".03" mass="2"
fromto="0 0 0 .3 0 0"/><body pos=".3 0 0"><joint name="b" axis="0 1 0" armature="0.01"/>
<geom type="capsule" size=".03" mass="1" fromto="0 0 0 .3 0 0"/></body></body>{floor}</worldbody>
<actuator><motor name="a" joint="a"/><motor name="b" joint="b"/></actuator></mujoco>"""
TURNING = """<mujoco><option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>
<worldbody><body><joint name="j" axis="0 0 1"/><geom size="0.1" mass="10"/></body></worldbody>
<actuator><velocity name="j" joint="j" kv="100"/></actuator></mujoco>"""


def model_of(xml, effects, joint="j"):
    spec = mujoco.MjSpec.from_string(xml)
    made = [SimulatedEffect(*e) for e in effects]
    fj.install(spec, {joint: LAW}, {joint: made})
    spec.compile()
    return mujoco.MjModel.from_xml_string(spec.to_xml())


@pytest.mark.parametrize("backend", ["native", "python"])
def test_the_load_is_that_of_the_whole_arm(backend):
    step = 2e-4
    model = model_of(ARM.format(step=step, floor=""), [(LOAD_DEPENDENT, (1e-6,), (0.3,))], "a")
    data, inverse = mujoco.MjData(model), np.zeros(model.nv)
    found, wanted, coupled = [], [], []
    data.xfrc_applied[2, 4] = TWIST
    with fj.attach(model, backend):
        for k in range(1500):
            # the elbow thrashes, so that its acceleration is much of the shoulder's load
            data.ctrl[:] = 9.0 * math.sin(11.0 * data.time), 4.0 * math.sin(40.0 * data.time)
            mujoco.mj_step(model, data)
            again = mujoco.MjData(model)
            if k % 50 == 49:
                mujoco.mj_copyData(again, model, data)
                mujoco.mj_forward(model, again)
                torque = fj.torque(model, again)["a"]
                mujoco.mj_forward(model, again)
                assert fj.torque(model, again)["a"] == torque
                found.append(torque.effects["load-dependent"])
                # inverse dynamics without the armature; what others bear is not the gear's
                mujoco.mj_rne(model, again, 1, inverse)
                load = inverse[0] - again.qfrc_constraint[0] - TWIST
                wanted.append(0.3 * abs(load) * torque.hysteresis)
                alone = again.M[0] - model.dof_armature[0]
                coupled.append(load - again.qfrc_bias[0] - alone * again.qacc[0])
    assert np.std(coupled) > 0.5
    np.testing.assert_allclose(found, wanted, atol=0.03)
    assert np.std(wanted) > 0.3


def test_the_loss_warms_the_joint():
    ambient, resistance, tau = 20.0, 30.0, 2.0
    model = model_of(
        TURNING,
        [
            (temperature_dependent.EFFECT, (25.0, 40.0), (0.5, 0.0)),
            (heating.EFFECT, (ambient, resistance, tau), ()),
        ],
    )
    data = mujoco.MjData(model)
    data.ctrl[0] = 1.0
    with fj.attach(model):
        with pytest.raises(ModelError, match="'j' has no temperature yet"):
            fj.temperature(model, data)
        assert fj.torque(model, data)["j"].temperature == ambient
        expected = ambient
        for _ in range(3000):
            before = fj.torque(model, data)["j"] if data.time else None
            mujoco.mj_step(model, data)
            loss = before.total * data.qvel[0] if before else 0.0
            decay = math.exp(-model.opt.timestep / tau)
            expected = ambient + resistance * loss * (1 - decay) + (expected - ambient) * decay
        found = fj.temperature(model, data)["j"]
        assert found > 35.0
        assert found == pytest.approx(expected, abs=0.2)
        assert fj.torque(model, data)["j"].temperature == found
        part = fj.torque(model, data)["j"].effects["temperature-dependent"]
        assert part == pytest.approx(0.5 * math.expm1(-(found - 25.0) / 40.0), rel=1e-3)
        fj.set_temperature(model, data, "j", 60.0)
        assert fj.temperature(model, data) == {"j": 60.0}
        mujoco.mj_step(model, data)
        part = fj.torque(model, data)["j"].effects["temperature-dependent"]
        assert part == pytest.approx(0.5 * math.expm1(-35.0 / 40.0), rel=1e-3)
        with pytest.raises(ModelError, match="has an effect that depends on warmth"):
            fj.warmth(model, data)
        mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)
        assert fj.temperature(model, data) == {"j": ambient}


def test_a_model_is_evaluated_at_the_measured_temperature():
    spec = mujoco.MjSpec.from_string(TURNING)
    spec.delete(spec.actuators[0])
    warm = SimulatedEffect(temperature_dependent.EFFECT, (25.0, 40.0), (0.5, 0.3))
    fj.install(spec, {"j": LAW}, {"j": [warm]})
    model = spec.compile()
    data, n = mujoco.MjData(model), 6000
    celsius = np.linspace(35.0, 65.0, n)
    rows = np.empty((3, n))
    with fj.attach(model):
        mujoco.mj_forward(model, data)
        for k in range(n):
            fj.set_temperature(model, data, "j", celsius[k])
            data.qfrc_applied[0] = 2.5 * math.sin(5.0 * data.time)
            rows[:, k] = data.time, data.qpos[0], data.qfrc_applied[0]
            mujoco.mj_step(model, data)
    time, position, torque = rows[:, ::4]
    log = JointLog(name="log", joint="j", time=time, position=position, torque=torque)
    blind = fj.evaluate(spec.to_xml(), [log]).joints["j"]
    seen = fj.evaluate(spec.to_xml(), [replace(log, temperature=celsius[::4])]).joints["j"]
    assert seen.torque_rms < 0.5 * blind.torque_rms
    assert seen.replay_rms < 0.2 * blind.replay_rms


@pytest.mark.parametrize(
    ("effect", "shape"),
    [
        (warm_up_drift.EFFECT, (20.0,)),
        (warm_up_drift.BY_LOSS, (20.0, 4.0)),
        (warm_up_drift.BY_WHOLE_LOSS, (4.0, 0.1, 20.0)),
    ],
)
def test_a_joint_can_be_set_warm(effect, shape):
    model = model_of(TURNING, [(effect, shape, (0.5, 0.0))])
    data = mujoco.MjData(model)
    data.ctrl[0] = 1.0
    with fj.attach(model):
        mujoco.mj_step(model, data, 300)
        cold = fj.warmth(model, data)["j"]
        assert 0.0 < cold < 0.2
        fj.set_warmth(model, data, "j", 0.75)
        assert fj.warmth(model, data)["j"] == pytest.approx(0.75)
        mujoco.mj_step(model, data)
        part = fj.torque(model, data)["j"].effects["warm-up-drift"]
        assert part == pytest.approx(0.25 * 0.5, rel=2e-2)
        mujoco.mj_step(model, data, 500)
        assert 0.75 < fj.warmth(model, data)["j"] < 0.9
        with pytest.raises(ModelError, match="give 0 or more, below 1"):
            fj.set_warmth(model, data, "j", 1.0)


@pytest.mark.parametrize("delay", [0.0123, -0.0123])
def test_instruments_are_late(delay):
    model = model_of(TURNING, [(measurement_delay.EFFECT, (delay,), ())])
    names = [model.sensor(i).name for i in range(model.nsensor)]
    assert names == ["j_position", "j_velocity", "j_torque"]
    data = mujoco.MjData(model)
    rows = []
    with fj.attach(model):
        for _ in range(2000):
            data.ctrl[0] = math.sin(5.0 * data.time)
            mujoco.mj_forward(model, data)
            now = data.time, data.qpos[0], data.qvel[0], data.qfrc_actuator[0]
            mujoco.mj_step(model, data)
            rows.append([*now, *data.sensordata])
    t, q, v, u, *measured = np.array(rows)[50:].T
    late = {True: (delay, delay, 0.0), False: (0.0, 0.0, -delay)}[delay > 0.0]
    for truth, said, lag in zip((q, v, u), measured, late, strict=True):
        inside = t > t[0] + 0.05
        wanted = np.interp(t - lag, t, truth)[inside]
        np.testing.assert_allclose(said[inside], wanted, atol=1e-6 * np.ptp(truth) + 1e-12)
