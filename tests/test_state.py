"""The friction state lives in mjData.userdata: whatever MuJoCo saves, copies or repeats works."""

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ModelError

KNOTS = ((1e-4, 1.5), (3e-4, 2.5), (1e-3, 3.2))
FRICTION = fj.FrictionParameters.symmetric(
    Fs=1.5, Fc=1.0, Vs=0.01, sigma2=0.4, sigma1=0.5, n=2, knots=KNOTS
)
ARM = """
<mujoco>
  <option timestep="0.001" integrator="{integrator}"/>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/>
      <body pos="0 0 -.4"><joint name="b" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/></body></body>
  </worldbody>
</mujoco>
"""


def model(integrator: str = "implicitfast") -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(ARM.format(integrator=integrator))
    fj.install(spec, {"a": FRICTION, "b": FRICTION})
    return spec.compile()


def run(m, data, steps, between=lambda m, d: None):
    """Slow and fast sines: presliding loops nest, and now and then the joint breaks away."""
    out = []
    for _ in range(steps):
        t = data.time
        data.qfrc_applied[:] = [1.2 * np.sin(9 * t) + 0.6 * np.sin(41 * t), 0.9 * np.sin(23 * t)]
        mujoco.mj_step(m, data)
        between(m, data)
        out.append([*data.qpos, *data.qvel])
    return np.array(out)


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
@pytest.mark.parametrize("calls", [1, 5])
def test_forward_between_steps_changes_nothing(integrator, calls):
    m = model(integrator)

    def forward(m, d):
        for _ in range(calls):
            mujoco.mj_forward(m, d)

    with fj.attach(m):
        plain = run(m, mujoco.MjData(m), 400)
        disturbed = run(m, mujoco.MjData(m), 400, forward)
    # mj_forward changes qacc_warmstart only where there are constraints; here there are none
    np.testing.assert_array_equal(plain, disturbed)


def test_step_halves_and_nstep_equal_single_steps():
    m = model()
    with fj.attach(m):
        one, halves = mujoco.MjData(m), mujoco.MjData(m)
        one.qfrc_applied[:] = halves.qfrc_applied[:] = [1.3, 0.4]
        mujoco.mj_step(m, one, nstep=300)
        for _ in range(300):
            mujoco.mj_step1(m, halves)
            mujoco.mj_step2(m, halves)
    np.testing.assert_array_equal(one.qpos, halves.qpos)


def test_a_saved_state_goes_on_bit_for_bit_on_another_data():
    m = model()
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    with fj.attach(m):
        data, other = mujoco.MjData(m), mujoco.MjData(m)
        run(m, data, 137)
        memory = fj.remembered(m, data)["a"]
        assert memory.minima + memory.maxima, "no loop on the stacks: the test would prove nothing"
        state = np.zeros(mujoco.mj_stateSize(m, kind))
        mujoco.mj_getState(m, data, state, kind)
        run(m, other, 55)
        mujoco.mj_setState(m, other, state, kind)
        np.testing.assert_array_equal(run(m, data, 300), run(m, other, 300))


def test_copy_goes_on_bit_for_bit_and_reset_or_time_set_back_starts_afresh():
    m = model()
    with fj.attach(m):
        data, other = mujoco.MjData(m), mujoco.MjData(m)
        first = run(m, data, 137)
        mujoco.mj_copyData(other, m, data)
        np.testing.assert_array_equal(run(m, data, 200), run(m, other, 200))
        mujoco.mj_resetData(m, data)
        np.testing.assert_array_equal(run(m, data, 137), first)
        data.time, data.qpos[:], data.qvel[:] = 0.0, 0.0, 0.0
        np.testing.assert_array_equal(run(m, data, 137), first)


def test_native_and_python_callbacks_agree():
    m = model()
    with fj.attach(m):
        native = run(m, mujoco.MjData(m), 500)
    with fj.attach(m, backend="python"):
        python = run(m, mujoco.MjData(m), 500)
    np.testing.assert_allclose(native, python, rtol=0, atol=1e-12 * FRICTION.Fs_pos)


def test_two_models_attached_at_once_and_one_without_friction():
    m, other = model(), model("Euler")
    bare = mujoco.MjModel.from_xml_string(ARM.format(integrator="Euler"))
    free = run(bare, mujoco.MjData(bare), 50)
    with fj.attach(m):
        alone = run(m, mujoco.MjData(m), 100)
        with fj.attach(other):
            loaded = mujoco.MjModel.from_xml_string(ARM.format(integrator="Euler"))
            np.testing.assert_array_equal(run(loaded, mujoco.MjData(loaded), 50), free)
            np.testing.assert_array_equal(run(m, mujoco.MjData(m), 100), alone)
            assert np.abs(run(other, mujoco.MjData(other), 50) - free).max() > 1e-6
        np.testing.assert_array_equal(run(m, mujoco.MjData(m), 100), alone)


def test_a_model_that_is_never_called_back_is_refused():
    m = model()
    m.opt.disableflags |= int(
        mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    )
    with pytest.raises(ModelError, match="enable one of them"), fj.attach(m):
        pass


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_rollout_and_batch_equal_a_serial_loop(threads):
    from mujoco import rollout

    m = model("Euler")
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    steps, runs = 200, 6
    control = np.zeros((runs, steps, 2))
    for i in range(runs):
        t = np.arange(steps) * m.opt.timestep
        control[i, :, 0] = (0.8 + 0.2 * i) * np.sin(19 * t)
        control[i, :, 1] = 0.5 * np.sin(31 * t + i)
    spec = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    with fj.attach(m):
        data = mujoco.MjData(m)
        start = np.zeros(mujoco.mj_stateSize(m, kind))
        mujoco.mj_getState(m, data, start, kind)
        serial = []
        for i in range(runs):
            one = mujoco.MjData(m)
            for k in range(steps):
                one.qfrc_applied[:] = control[i, k]
                mujoco.mj_step(m, one)
            serial.append(one.qpos.copy())
        # fresh data for each thread: userdata is not part of a full-physics state
        pool = [mujoco.MjData(m) for _ in range(threads)]
        states, _ = rollout.rollout(
            m, pool, np.tile(start, (runs, 1)), control, control_spec=spec, nstep=steps
        )
    np.testing.assert_array_equal(states[:, -1, 1:3], np.array(serial))


@pytest.mark.parametrize("astray", [np.nan, np.inf, -1e11])
def test_a_state_gone_astray_has_no_torque_and_leaves_no_trace(astray):
    m = model()
    data, other = mujoco.MjData(m), mujoco.MjData(m)
    with fj.attach(m):
        for d in (data, other):
            run(m, d, 50)
        good = data.qpos.copy()
        data.qpos[0] = astray
        mujoco.mj_forward(m, data)
        assert np.isnan(data.qfrc_passive[0])
        data.qpos[:] = good
        # the solver's warm start holds the acceleration of the lost state
        data.qacc_warmstart[:] = other.qacc_warmstart
        np.testing.assert_array_equal(run(m, data, 50), run(m, other, 50))
