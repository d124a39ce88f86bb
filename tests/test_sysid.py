"""MuJoCo's system identification takes friction among its parameters and recovers it."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ParameterError

sysid = pytest.importorskip("mujoco.sysid")
if not hasattr(sysid, "optimize"):
    pytest.skip(
        "mujoco.sysid lacks its dependencies: install mujoco[sysid]", allow_module_level=True
    )

from frictionjoint.simulate.sysid import (  # noqa: E402
    build_model,
    friction_parameters,
    identified,
    rollout,
)

ARM = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body><joint name="elbow" axis="0 1 0" armature="0.05"/>
    <inertial pos="0 0 -0.25" mass="1.2" diaginertia="0.02 0.02 0.02"/></body></worldbody>
  <actuator><position name="servo" joint="elbow" kp="80" kv="5"/></actuator>
  <sensor><jointpos name="q" joint="elbow"/><actuatorfrc name="torque" actuator="servo"/></sensor>
</mujoco>
"""
KNOTS = ((1e-4, 0.6), (3e-4, 1.0), (1e-3, 1.5))
START = fj.FrictionParameters.symmetric(Fs=0.7, Fc=0.6, Vs=0.05, sigma2=0.1, n=2, knots=KNOTS)
RANGES = {"Fc": (0.1, 4.0), "Fs_over_Fc": (1.0, 3.0), "Vs": (0.01, 0.5), "sigma2": (0.0, 2.0)}
TRUE = {"Fc": 1.0, "Fs_over_Fc": 1.5, "Vs": 0.1, "sigma2": 0.4}


def parameters(values=None) -> "sysid.ParameterDict":
    found = sysid.ParameterDict({p.name: p for p in friction_parameters("elbow", START, RANGES)})
    for name, value in (values or {}).items():
        found[f"elbow:{name}"].value[:] = value
    return found


def steps(model, seconds):
    """Times, targets and sensors of plain mj_step from rest."""
    data = mujoco.MjData(model)
    times = np.arange(round(seconds / model.opt.timestep)) * model.opt.timestep
    target = 0.5 * np.sin(2 * np.pi * 0.3 * times) + 0.25 * np.sin(2 * np.pi * 1.1 * times)
    rows = []
    for u in target:
        data.ctrl[0] = u
        mujoco.mj_step1(model, data)
        rows.append([data.qpos[0], 0.0])
        mujoco.mj_step2(model, data)
        rows[-1][1] = data.actuator_force[0]
    return times, target[:, None], np.array(rows)


def measured(model, seconds, noise=0.0):
    times, target, rows = steps(model, seconds)
    rows = rows + noise * np.random.default_rng(5).standard_normal(rows.shape) * [1.0, 100.0]
    bare = mujoco.MjSpec.from_string(ARM).compile()
    return sysid.ModelSequences(
        "arm",
        mujoco.MjSpec.from_string(ARM),
        "log",
        sysid.create_initial_state(bare, np.zeros(1)),
        sysid.TimeSeries(times, target),
        # sysid counts a sensor at the end of the step it was computed in
        sysid.TimeSeries.from_names(times + bare.opt.timestep, rows, bare),
    )


def test_sysid_recovers_the_friction_under_noise():
    build = build_model({"elbow": START})
    truth = build(parameters(TRUE), mujoco.MjSpec.from_string(ARM))
    with fj.attach(truth):
        log = measured(truth, 4.0, noise=2e-5)
        residual = sysid.build_residual_fn(
            models_sequences=[log], build_model=build, custom_rollout=rollout
        )
        found, _ = sysid.optimize(parameters(), residual, verbose=False)
    for name, value in TRUE.items():
        assert found[f"elbow:{name}"].value[0] == pytest.approx(value, rel=0.02), name
    friction = identified(START, found, "elbow")
    assert friction.Fs_neg == pytest.approx(1.5, rel=0.02)
    assert friction.stiffness == pytest.approx(START.stiffness * friction.Fs_pos / START.Fs_pos)


def test_every_rollout_begins_with_joints_never_moved():
    model = build_model({"elbow": START})(parameters(), mujoco.MjSpec.from_string(ARM))
    with fj.attach(model):
        times, target, rows = steps(model, 1.0)
        log = measured(model, 1.0)
        # started late, so that a time that goes back does not wipe the memory by itself
        late = log.initial_state[0].copy()
        late[0] = 9.0
        control = sysid.TimeSeries(times, target)
        qpos, qvel, act, ctrl = sysid.TimeSeries.compute_all_state_mappings(model)
        used = mujoco.MjData(model)
        several = rollout(
            models=[model] * 4,
            datas=[used],
            control_signal=[control] * 4,
            initial_states=[log.initial_state[0], late, late, log.initial_state[0]],
            param_dicts=[],
            rollout_signal_mapping=sysid.TimeSeries.compute_all_sensor_mapping(model),
            rollout_state_mapping=qpos | qvel | act,
            ctrl_mapping=ctrl,
        )
    positions = [t.state.data[:, 1] for t in several]
    np.testing.assert_array_equal(positions[0], rows[1:, 0])
    np.testing.assert_array_equal(positions[3], positions[0])
    np.testing.assert_array_equal(positions[1], positions[2])


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ({"Fv": (0.0, 1.0)}, "no free parameter 'Fv': choose from Fc, Fs_over_Fc"),
        ({"Fs_over_Fc": (0.5, 2.0)}, "Fc_pos is 0.6: it must be in"),
        ({"Vs": (0.0, 1.0)}, "Vs_pos is 0"),
    ],
)
def test_bounds_outside_the_law_are_refused(ranges, words):
    with pytest.raises(ParameterError, match=words):
        friction_parameters("elbow", START, ranges)
