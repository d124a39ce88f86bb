"""An exported joint in mjlab: its friction acts in every world, and a policy is trained on it.

It asks for an environment of its own, Python 3.12 and mjlab 1.6.0; elsewhere it is skipped.
"""

# imports stand behind the skip
# ruff: noqa: E402

from dataclasses import asdict

import mujoco
import numpy as np
import pytest
from exported import carrying, module_of

import frictionjoint as fj

pytest.importorskip("mjlab", reason="mjlab is not installed")
torch = pytest.importorskip("torch")

from mjlab.entity import EntityCfg
from mjlab.envs import ManagerBasedRlEnv, ManagerBasedRlEnvCfg
from mjlab.envs.mdp import joint_pos_rel, joint_vel_rel, reset_joints_by_offset, time_out
from mjlab.envs.mdp.actions import JointEffortActionCfg
from mjlab.managers.event_manager import EventTermCfg
from mjlab.managers.observation_manager import ObservationGroupCfg, ObservationTermCfg
from mjlab.managers.reward_manager import RewardTermCfg
from mjlab.managers.termination_manager import TerminationTermCfg
from mjlab.rl import (
    MjlabOnPolicyRunner,
    RslRlModelCfg,
    RslRlOnPolicyRunnerCfg,
    RslRlPpoAlgorithmCfg,
    RslRlVecEnvWrapper,
)
from mjlab.scene import SceneCfg
from mjlab.sim import MujocoCfg, SimulationCfg

WORLDS, STEP, DECIMATION = 4, 0.002, 5
BREAKAWAY = 1.5
LAW = fj.FrictionParameters.symmetric(
    Fs=BREAKAWAY, Fc=1.0, Vs=0.05, sigma2=0.2, n=2.0, knots=((2e-3, 1.5), (8e-3, 3.0))
)
ARM = """<mujoco><compiler angle="radian"/><worldbody>
<body name="base"><body name="link"><joint name="elbow" axis="0 0 1" armature="0.05"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0" mass="1" contype="0" conaffinity="0"/>
</body></body></worldbody><actuator><motor name="drive" joint="elbow"/></actuator></mujoco>"""


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    """What the export to mjlab defines, and the MJCF."""
    path = carrying(ARM, LAW, tmp_path_factory.mktemp("mjlab"))
    return module_of(path, "mjlab"), path


def nearness(env):
    """1 where the elbow is at 0.3 rad, shape (worlds,)."""
    return torch.exp(-((env.scene["robot"].data.joint_pos[:, 0] - 0.3) ** 2) / 0.02)


def environment(module):
    terms = {
        "position": ObservationTermCfg(func=joint_pos_rel, params={}),
        "velocity": ObservationTermCfg(func=joint_vel_rel, params={}),
    }
    entity = EntityCfg(
        spec_fn=module["robot_spec"],
        articulation=module["ARTICULATION"],
        init_state=EntityCfg.InitialStateCfg(joint_pos={"elbow": 0.0}, joint_vel={".*": 0.0}),
    )
    config = ManagerBasedRlEnvCfg(
        scene=SceneCfg(entities={"robot": entity}, num_envs=WORLDS, env_spacing=2.0),
        observations={
            "actor": ObservationGroupCfg(terms),
            "critic": ObservationGroupCfg({**terms}),
        },
        actions={
            "effort": JointEffortActionCfg(
                entity_name="robot", actuator_names=("elbow",), scale=1.0
            )
        },
        events={
            "reset": EventTermCfg(
                func=reset_joints_by_offset,
                mode="reset",
                params={"position_range": (0.0, 0.0), "velocity_range": (0.0, 0.0)},
            )
        },
        rewards={"near": RewardTermCfg(func=nearness, weight=1.0)},
        terminations={"time_out": TerminationTermCfg(func=time_out, time_out=True)},
        sim=SimulationCfg(mujoco=MujocoCfg(timestep=STEP, disableflags=("contact",))),
        decimation=DECIMATION,
        episode_length_s=2.0,
    )
    return ManagerBasedRlEnv(cfg=config, device="cpu")


def test_worlds_stick_and_slip_as_natively(robot):
    module, path = robot
    env = environment(module)
    env.reset()
    efforts = torch.tensor([[0.4], [0.6], [0.9], [2.5]])
    for _ in range(30):
        env.step(efforts)
    found = env.scene["robot"].data.joint_pos[:, 0].numpy().copy()
    model = fj.load_model(path)
    model.opt.timestep = STEP
    model.opt.integrator = env.sim.mj_model.opt.integrator
    expected = []
    with fj.attach(model):
        for effort in efforts[:, 0].tolist():
            data = mujoco.MjData(model)
            data.ctrl[0] = effort
            mujoco.mj_step(model, data, 30 * DECIMATION)
            expected.append(data.qpos[0])
    np.testing.assert_allclose(found, expected, atol=2e-6)
    assert np.all(np.abs(found[:3]) < 0.02)
    assert found[3] > 0.3
    # a reset forgets what the friction held
    env.reset()
    env.step(torch.zeros(WORLDS, 1))
    assert np.abs(env.scene["robot"].data.joint_pos[:, 0].numpy()).max() < 1e-6


def test_a_policy_is_trained_on_it(robot):
    module, _ = robot
    env = RslRlVecEnvWrapper(environment(module))
    network = {"hidden_dims": (16,), "activation": "elu", "obs_normalization": False}
    noise = {"class_name": "GaussianDistribution", "init_std": 1.0, "std_type": "scalar"}
    config = RslRlOnPolicyRunnerCfg(
        seed=0,
        actor=RslRlModelCfg(**network, distribution_cfg=noise),
        critic=RslRlModelCfg(**network),
        algorithm=RslRlPpoAlgorithmCfg(),
        num_steps_per_env=16,
        max_iterations=3,
        logger="tensorboard",
        upload_model=False,
    )
    runner = MjlabOnPolicyRunner(env, asdict(config), log_dir=None, device="cpu")
    before = [p.detach().clone() for p in runner.alg.get_policy().parameters()]
    runner.learn(num_learning_iterations=3)
    after = list(runner.alg.get_policy().parameters())
    assert all(bool(torch.isfinite(p).all()) for p in after)
    assert any(not torch.equal(a, b) for a, b in zip(before, after, strict=True))
    friction = env.unwrapped.sim.wp_model.callback.passive.__self__
    assert isinstance(friction, fj.simulate.warp.WarpFriction)
    assert np.isfinite(friction.torque().numpy()).all()
    assert np.abs(friction.torque().numpy()).max() > 0.1
