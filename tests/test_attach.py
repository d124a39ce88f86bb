"""Friction acts when asked to, for one model or the whole process, and nothing else is lost."""

import ctypes
import warnings

import mujoco
import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.errors import ModelError
from frictionjoint.simulate import attach
from frictionjoint.simulate.block import COUNT
from frictionjoint.simulate.check import check

FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
JOINT = """
<mujoco>{more}
  <option timestep="0.001"/>
  <worldbody><body><joint name="j" armature="1"/><geom size=".1"/></body></worldbody>
</mujoco>
"""
PUSH = 0.5  # N m, below breakaway: held with friction, running away without
HELD = 1e-3  # rad
C_CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)


@pytest.fixture(autouse=True)
def _nothing_installed():
    mujoco.set_mjcb_passive(None)
    yield
    fj.disable()
    for handle in list(attach._attached.values()):  # of tests that keep none
        handle.detach()
    mujoco.set_mjcb_passive(None)


def spec() -> mujoco.MjSpec:
    made = mujoco.MjSpec.from_string(JOINT.format(more=""))
    fj.install(made, {"j": FRICTION})
    return made


def reach(model: mujoco.MjModel, steps: int = 300) -> float:
    """Where a constant push leads, rad."""
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = PUSH
    mujoco.mj_step(model, data, nstep=steps)
    return float(data.qpos[0])


def held(model: mujoco.MjModel) -> bool:
    return 0.0 < reach(model) < HELD


FREE = reach(mujoco.MjModel.from_xml_string(JOINT.format(more="")))


def test_attach_acts_at_once_and_detach_ends_it():
    model = spec().compile()
    h = fj.attach(model)
    assert h.model is model
    assert held(model)
    h.detach()
    assert reach(model) == FREE > HELD
    h.detach()  # twice is once
    assert mujoco.get_mjcb_passive() is None
    with fj.attach(model) as attached:
        assert attached is model
        assert held(model)
    assert reach(model) == FREE


def test_a_handle_that_nobody_keeps_keeps_acting():
    model = spec().compile()
    fj.attach(model)
    assert held(model)
    with pytest.raises(ModelError, match="attached already"):
        fj.attach(model)


def test_enable_serves_models_of_all_kinds_until_disable():
    before = spec().compile()
    fj.enable()
    fj.enable()
    after = mujoco.MjModel.from_xml_string(before_xml := spec().to_xml())
    assert held(before)
    assert held(after)
    bare = mujoco.MjModel.from_xml_string(JOINT.format(more=""))
    assert reach(bare) == FREE
    fj.disable()
    assert reach(mujoco.MjModel.from_xml_string(before_xml)) == FREE
    assert reach(before) == FREE
    fj.disable()


def test_threads_that_meet_a_model_together_agree():
    from mujoco import rollout

    model = spec().compile()
    fj.enable()
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.zeros((8, mujoco.mj_stateSize(model, kind)))
    push = np.full((8, 300, 1), PUSH)
    pool = [mujoco.MjData(model) for _ in range(4)]
    states, _ = rollout.rollout(
        model, pool, start, push, control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    )
    assert 0.0 < states[0, -1, 1] < HELD
    np.testing.assert_array_equal(states[:, -1, 1], states[0, -1, 1])


def test_a_model_whose_friction_cannot_act_is_named_once_and_steps_on():
    broken = spec().compile()
    broken.numeric_data[int(broken.numeric_adr[0]) + COUNT] += 1
    fj.enable()
    with pytest.warns(RuntimeWarning, match="does not act: numeric frictionjoint:j has"):
        assert reach(broken) == FREE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert reach(broken) == FREE


def counted_in_python():
    calls = []

    def mine(model, data):
        calls.append(data.time)
        data.qfrc_passive[0] -= 0.1

    return mine, calls


def counted_in_c():
    calls = []

    @C_CALLBACK
    def mine(model, data):
        calls.append(data)

    return mine, calls


@pytest.mark.parametrize("backend", ["native", "python"])
@pytest.mark.parametrize("make", [counted_in_python, counted_in_c])
def test_the_users_own_callback_is_called_too_and_comes_back(make, backend):
    model = spec().compile()
    mine, calls = make()
    mujoco.set_mjcb_passive(mine)
    with fj.attach(model, backend):
        assert held(model)
        assert len(calls) == 300
        installed = mujoco.get_mjcb_passive()
        other = next(iter({"native", "python"} - {backend}))
        mujoco.set_mjcb_passive(None)  # MuJoCo compiles nothing with a Python callback
        second = spec().compile()
        mujoco.set_mjcb_passive(installed)
        with fj.attach(second, other):
            assert held(second)
            assert len(calls) == 600
    assert mujoco.get_mjcb_passive() is mine
    reach(model)
    assert len(calls) == 900


def test_the_users_callback_comes_back_whatever_order_models_are_detached_in():
    mine, _ = counted_in_c()
    mujoco.set_mjcb_passive(mine)
    handles = [fj.attach(spec().compile()) for _ in range(3)]
    for i in (1, 0, 2):
        assert mujoco.get_mjcb_passive() is not mine
        handles[i].detach()
    assert mujoco.get_mjcb_passive() is mine


def test_models_compiled_while_friction_acts_have_it():
    made = spec()
    model = made.compile()
    with fj.attach(model):
        again = made.compile()
        assert held(again)
        data = mujoco.MjData(again)
        data.qfrc_applied[0] = PUSH
        mujoco.mj_step(again, data, nstep=100)
        made.worldbody.add_body().add_geom(size=[0.1, 0, 0])
        new, new_data = made.recompile(again, data)
        assert new.nbody == again.nbody + 1
        new_data.qfrc_applied[0] = PUSH
        mujoco.mj_step(new, new_data, nstep=300)
        assert 0.0 < new_data.qpos[0] < HELD
        mujoco.mj_step(new, copied := mujoco.MjData(new), nstep=1)
        assert copied.time > 0.0


@pytest.mark.parametrize("in_python", [True, False])
def test_models_load_whatever_callback_is_installed(in_python, tmp_path):
    (tmp_path / "j.xml").write_text(spec().to_xml())
    mine, calls = counted_in_python() if in_python else counted_in_c()
    model = spec().compile()
    mujoco.set_mjcb_passive(mine)
    loaded = fj.load_model(tmp_path / "j.xml")
    assert mujoco.get_mjcb_passive() is mine
    with fj.attach(model, backend="python"):
        fj.load_model(tmp_path / "j.xml")
    with fj.attach(loaded):
        assert held(loaded)
    assert calls


def test_an_unknown_backend_is_refused_and_leaves_nothing():
    model = spec().compile()
    for act in (lambda: fj.attach(model, "gpu"), lambda: fj.enable("gpu")):
        with pytest.raises(ModelError, match="use 'native' or 'python'"):
            act()
    assert mujoco.get_mjcb_passive() is None
    with fj.attach(model):
        assert held(model)


def told_once(model, data, match):
    """`torque` warns, and no second time."""
    with pytest.warns(RuntimeWarning, match=match):
        fj.torque(model, data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fj.torque(model, data)


def test_torque_warns_once_of_a_model_that_is_stepped_without_friction():
    model = spec().compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 10)
    told_once(model, data, "has not acted since 0 s, and data.time is 0.01")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with fj.attach(model):
            mujoco.mj_step(model, data, 10)
            fj.torque(model, data)
        fj.torque(model, data)  # of the last step that was attached


def test_torque_warns_once_of_a_callback_that_was_set_over_ours():
    model = spec().compile()
    data = mujoco.MjData(model)
    h = fj.attach(model)
    mine, _ = counted_in_c()
    mujoco.set_mjcb_passive(mine)
    mujoco.mj_step(model, data, 10)
    told_once(model, data, "other code replaced MuJoCo.*set yours before")
    with pytest.warns(RuntimeWarning, match="calls ours: the new callback stays"):
        h.detach()


def test_flags_that_are_disabled_after_attach_are_told_once():
    model = spec().compile()
    data = mujoco.MjData(model)
    off = mujoco.mjtDisableBit.mjDSBL_SPRING | mujoco.mjtDisableBit.mjDSBL_DAMPER
    with fj.attach(model):
        mujoco.mj_step(model, data, 10)
        model.opt.disableflags |= int(off)
        mujoco.mj_step(model, data, 10)
        told_once(model, data, "has not acted since .* flags are both disabled")
        rows = check(model)
    assert any("friction does not act" in text for text in rows[0]["outside"])
