"""Friction holds what stands on it, at any stiffness and damping, and only ever brakes."""

import itertools

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import frictionjoint as fj
from frictionjoint.effects import nonlinear_viscous, warm_up_drift
from frictionjoint.effects.friction_level import DWELL_TIME
from frictionjoint.joint_friction import SimulatedEffect
from tests.standing import LINKAGE, law, one_joint, plain_mass, random_tree, table, with_friction

STEPPING = ["Euler", "implicit", "implicitfast"] + (
    ["discrete"] if hasattr(mujoco.mjtIntegrator, "mjINT_DISCRETE") else []
)


def speed_of_linkage(model, seconds=4.0, steps=()):
    """Largest velocity in the last tenth under a load of 0.6 of the breakaway torque, rad/s."""
    data, found = mujoco.MjData(model), 0.0
    with fj.attach(model):
        while data.time < seconds:
            data.qfrc_applied[0] = 0.3 * min(1.0, data.time)
            model.opt.timestep = next(steps) if steps else model.opt.timestep
            mujoco.mj_step(model, data)
            if data.time > 0.9 * seconds:
                found = max(found, float(np.abs(data.qvel).max()))
    return found


def speed_of_table(model, seconds=4.0):
    """Joint velocity in the last fifth, rad/s rms, and how far the body sank meanwhile, m."""
    data, squares, high = mujoco.MjData(model), [], 0.0
    with fj.attach(model):
        while data.time < seconds:
            mujoco.mj_step(model, data)
            if data.time > 0.8 * seconds:
                high = high or data.qpos[2]
                squares.append(np.mean(data.qvel[6:] ** 2))
    assert 0.35 < data.qpos[2] < 0.43, "it does not stand"
    return np.mean(squares) ** 0.5, abs(data.qpos[2] - high)


@pytest.mark.parametrize("damping", [2.5, 25.0])
@pytest.mark.parametrize("integrator", STEPPING)
def test_viscous_friction_never_turns_a_joint_round(damping, integrator):
    """h sigma2 / J: an explicit torque would diverge from 2 on."""
    spec = mujoco.MjSpec.from_string(one_joint(1e-3))
    fj.install(spec, {"j": law(1e-6, 1e-3, sigma2=damping)})
    model = spec.compile()
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    data, v = mujoco.MjData(model), [1.0]
    data.qvel[0] = 1.0
    with fj.attach(model):
        for _ in range(40):
            mujoco.mj_step(model, data)
            v.append(float(data.qvel[0]))
    assert min(v) > -1e-6
    # exactly it is exp(-damping); MuJoCo's own damping leaves this
    assert np.exp(-damping) < v[1] < 1.0 / (1.0 + damping)


def pushed(effect, stiffness, top, v=0.0):
    """Position and velocity of a joint with an effect, under a load from 2 s on."""
    spec = mujoco.MjSpec.from_string(one_joint(0.1))
    fj.install(spec, {"j": law(1.0, stiffness)}, {"j": [effect]})
    data, found = mujoco.MjData(model := spec.compile()), []
    data.qvel[0] = v
    with fj.attach(model):
        while data.time < 10.0:
            data.qfrc_applied[0] = top * min(1.0, max(0.0, data.time - 2.0))
            mujoco.mj_step(model, data)
            found.append((data.qpos[0], data.qvel[0]))
    return np.array(found).T


@pytest.mark.parametrize("exponent", [0.1, 0.5, 0.9])
def test_concave_viscous_friction_neither_turns_a_joint_round_nor_lets_it_creep(exponent):
    """Its slope at rest is infinite: an explicit torque vibrates there, and friction ratchets."""
    concave = SimulatedEffect(nonlinear_viscous.EFFECT, (exponent,), (6.0,))
    q, v = pushed(concave, 1e4, 0.4, 1.0)
    # the elastic contact swings back once
    assert min(v[:100]) > -0.02
    assert np.ptp(q[6000:]) < 1e-10


COLD = (SimulatedEffect(warm_up_drift.EFFECT, (1e6,), (2.1, 0.0)), 9e7, 2.4)
AGED = (SimulatedEffect(DWELL_TIME, (0.5, 1e-3, 3e-6), (4.0,)), 1e4, 4.0)


@pytest.mark.parametrize("raised", [COLD, AGED], ids=["cold", "aged"])
def test_a_joint_holds_what_its_friction_bears_which_is_four_times_that_of_its_law(raised):
    q, _ = pushed(*raised)
    assert np.ptp(q[6000:]) < 1e-10


def test_the_first_step_after_a_velocity_is_set_only_brakes_whatever_the_posture():
    """A mass far out on a rail makes the inertia 1 kg m^2; at qpos0 it is 0.002."""
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia=".001 .001 .001"/>'
    rail = f'<body><joint type="slide" axis="1 0 0"/>{inertial}</body></body>'
    spec = mujoco.MjSpec.from_string(one_joint(1e-3, 1e-2).replace("</body>", rail))
    fj.install(spec, {"j": law(1.0, 1e4)})
    data = mujoco.MjData(model := spec.compile())
    data.qpos[1] = data.qvel[0] = 1.0
    with fj.attach(model):
        mujoco.mj_step(model, data)
    assert 0.98 < data.qvel[0] < 1.0


@pytest.mark.parametrize("ratio", [0.3, 1.0, 3.0, 8.0, 20.0, 1000.0])
def test_a_closed_linkage_does_not_creep(ratio):
    assert speed_of_linkage(with_friction(LINKAGE, 0.5, ratio), 7.0) < 1e-9


@pytest.mark.parametrize("steps", [(1e-3, 1e-2), (1e-3, 1e-3, 4e-3)])
def test_a_time_step_that_varies_from_step_to_step_holds(steps):
    model = with_friction(LINKAGE, 0.5, 20.0)
    assert speed_of_linkage(model, 7.0, itertools.cycle(steps)) < 1e-9


@pytest.mark.parametrize("ratio", [1.0, 4.0, 10.0, 30.0, 1000.0])
def test_legs_stand_still_on_contacts(ratio):
    speed, sunk = speed_of_table(with_friction(table(), 8.0, ratio), 6.0)
    assert speed < 1e-8
    assert sunk < 1e-8


@pytest.mark.parametrize("integrator", STEPPING)
@pytest.mark.parametrize("ratio", [1.0, 8.0])
def test_every_integrator_with_whole_steps_holds(integrator, ratio):
    assert speed_of_linkage(with_friction(LINKAGE, 0.5, ratio, integrator=integrator)) < 1e-9
    assert speed_of_table(with_friction(table(), 8.0, ratio, integrator=integrator))[0] < 1e-7


@pytest.mark.parametrize("solver", ["Newton", "CG", "PGS"])
@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
@pytest.mark.parametrize("islands", [True, False])
def test_every_solver_holds(solver, cone, islands):
    """As far as the solver's own tolerance: 1e-8 of the mean inertia leaves 1e-5 rad/s."""
    model = with_friction(table(), 8.0, 8.0)
    model.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver.upper()}")
    model.opt.cone = getattr(mujoco.mjtCone, f"mjCONE_{cone.upper()}")
    if not islands:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
    speed, sunk = speed_of_table(model, 3.0)
    assert speed < (1e-8 if solver == "Newton" else 1e-6)
    assert sunk < 1e-6


@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_noslip_iterations_hold(ratio):
    model = with_friction(table(), 8.0, ratio)
    model.opt.noslip_iterations = 5
    speed, sunk = speed_of_table(model, 3.0)
    assert speed < 1e-4
    assert sunk < 1e-5


@pytest.mark.skipif(not hasattr(mujoco.mjtEnableBit, "mjENBL_SLEEP"), reason="MuJoCo cannot sleep")
def test_what_stands_on_friction_falls_asleep_and_wakes_as_it_was():
    model = with_friction(table(), 8.0, 4.0)
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    data = mujoco.MjData(model)
    with fj.attach(model):
        mujoco.mj_step(model, data, 2000)
        high = data.qpos[2]
        assert (data.qvel == 0.0).all(), "it does not sleep"
        mujoco.mj_step(model, data, 500)
        assert data.qpos[2] == high
        data.xfrc_applied[1, 2] = -5.0
        mujoco.mj_step(model, data)
        assert (data.qvel != 0.0).any(), "it does not wake"
        mujoco.mj_step(model, data, 500)
    assert abs(high - data.qpos[2]) < 1e-4


trees = {
    "seed": st.integers(0, 2**32 - 1),
    "ratio": st.floats(-1.0, 2.0).map(lambda x: 10.0**x),
    "damping": st.floats(-2.0, 3.0).map(lambda x: 10.0**x),
}


@settings(max_examples=12, deadline=None)
@given(**trees)
def test_any_tree_comes_to_rest_under_half_the_breakaway_torque(seed, ratio, damping):
    """With equality constraints and contacts."""
    rng = np.random.default_rng(seed)
    model = with_friction(random_tree(rng), 1.0, ratio, damping)
    data = mujoco.MjData(model)
    data.qfrc_applied[:] = 0.5 * rng.choice([-1.0, 1.0], model.nv)
    # a soft spring with a strong damper takes this long to be pulled, in truth as well, s
    slow = 30.0 * model.opt.timestep * damping / ratio**2
    with fj.attach(model):
        mujoco.mj_step(model, data, round((5.0 + min(slow, 30.0)) / model.opt.timestep))
        if np.abs(data.qvel).max() > 1e-8:  # a soft loop that hardly damps rings, springs too
            mujoco.mj_step(model, data, round(20.0 / model.opt.timestep))
    assert np.abs(data.qvel).max() < 1e-8 or slow > 30.0


@settings(max_examples=12, deadline=None)
@given(**trees)
def test_no_tree_gains_energy(seed, ratio, damping):
    """From a velocity that its constraints admit: a soft one that is violated drives a mechanism
    when a joint brakes, with MuJoCo's own damping as well."""
    rng = np.random.default_rng(seed)
    model = with_friction(random_tree(rng), 1.0, ratio, damping)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rows = data.efc_J.reshape(data.nefc, model.nv)
    data.qvel[:] = rng.normal(size=model.nv)
    data.qvel -= np.linalg.pinv(rows) @ (rows @ data.qvel)
    assume(np.abs(data.qvel).max() > 1e-6)
    energies = []
    with fj.attach(model):
        for _ in range(200):
            energies.append(0.5 * data.qvel @ plain_mass(model, data.qpos) @ data.qvel)
            mujoco.mj_step(model, data)
    assert max(energies) <= energies[0] * (1.0 + 1e-9)
