"""dm_control: the same trajectory as plain mj_step, to the bit, through resets and compiling."""

import os

import mujoco
import numpy as np
import pytest
from test_state import FRICTION, KNOTS

import frictionjoint as fj
from frictionjoint.errors import ModelError

# no windows: dm_control looks for OpenGL when it is imported
os.environ.setdefault("MUJOCO_GL", "disable")
try:
    from dm_control import composer, mjcf
    from dm_control import mujoco as dm_mujoco
    from dm_control.composer.observation import observable
    from dm_control.rl import control
    from dm_control_joint import Track
except Exception as error:
    # dm_control 1.0.50 fails on MuJoCo 4 with a KeyError or AttributeError, not an ImportError
    pytest.skip(
        f"dm_control does not import on MuJoCo {mujoco.__version__}: {error}",
        allow_module_level=True,
    )

from frictionjoint.simulate import dm_control as dm
from frictionjoint.simulate.carrier import read_friction

LEVELS = (0.5, 1.0, 1.5)
SAMPLES = [
    fj.FrictionParameters.symmetric(Fs=Fs, Fc=0.7 * Fs, Vs=0.01, sigma2=0.4, n=2, knots=KNOTS)
    for Fs in LEVELS
]
ARM = """
<mujoco model="robot">
  <default><geom contype="0" conaffinity="0"/></default>
  <option timestep="0.001" integrator="{integrator}"/>
  <worldbody>
    <body name="upper"><joint name="shoulder" type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.4" size=".03"/>
      <body name="lower" pos="0 0 -.4"><joint name="elbow" type="hinge" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/></body></body>
  </worldbody>
  <actuator><motor name="a" joint="shoulder"/><motor name="b" joint="elbow"/></actuator>
</mujoco>
"""
EPISODE = 120
SUB_STEPS = 5


def spec(integrator: str = "implicitfast") -> mujoco.MjSpec:
    spec = mujoco.MjSpec.from_string(ARM.format(integrator=integrator))
    fj.install(spec, {"shoulder": FRICTION, "elbow": FRICTION})
    return spec


def action(k: int) -> np.ndarray:
    """Enough for the joints to break away now and then, and to nest presliding loops."""
    t = k * SUB_STEPS * 1e-3
    return np.array([1.3 * np.sin(9 * t) + 0.7 * np.sin(41 * t), 1.1 * np.sin(23 * t)])


def plain(model: mujoco.MjModel, episodes: int = 1) -> list[np.ndarray]:
    """What MuJoCo's own loop makes of the actions, one array of positions an episode."""
    results = []
    with fj.attach(model):
        data = mujoco.MjData(model)
        for _ in range(episodes):
            mujoco.mj_resetData(model, data)
            positions = []
            for k in range(EPISODE):
                data.ctrl[:] = np.resize(action(k), model.nu)
                mujoco.mj_step(model, data, nstep=SUB_STEPS)
                positions.append(data.qpos[:2].copy())
            results.append(np.array(positions))
    return results


class Follow(Track):
    """A task that does nothing but pass the action on."""

    def get_observation(self, physics):
        return {"position": physics.data.qpos.copy()}

    def get_reward(self, physics):
        return 0.0


def episodes(environment, count: int) -> list[np.ndarray]:
    results = []
    for _ in range(count):
        environment.reset()
        positions = []
        for k in range(EPISODE):
            positions.append(np.ravel(environment.step(action(k)).observation["position"]))
        results.append(np.array(positions))
    return results


def assert_same(ours, theirs):
    assert len(ours) == len(theirs)
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("legacy_step", [True, False])
@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "RK4"])
def test_control_environment_equals_plain_steps(integrator, legacy_step):
    physics = dm_mujoco.Physics.from_xml_string(spec(integrator).to_xml())
    environment = control.Environment(
        physics, Follow(), n_sub_steps=SUB_STEPS, legacy_step=legacy_step
    )
    expected = plain(spec(integrator).compile(), 3)
    with dm.attach(environment):
        assert_same(episodes(environment, 3), expected)
    # and the friction matters: without it the arm goes elsewhere
    assert np.abs(episodes(environment, 1)[0] - expected[0]).max() > 0.1


def robot() -> mjcf.RootElement:
    return mjcf.from_xml_string(ARM.format(integrator="implicitfast"))


@pytest.mark.parametrize(
    ("joints", "words"), [(["wrist"], "no joint 'wrist': the model has"), (["base"], "free joint")]
)
def test_unfit_joints_are_refused_and_nothing_is_written(joints, words):
    root = robot()
    root.worldbody.add("body", name="box").add("freejoint", name="base")
    before = root.to_xml_string()
    with pytest.raises(ModelError, match=words):
        dm.install(root, {"elbow": FRICTION} | dict.fromkeys(joints, FRICTION))
    assert root.to_xml_string() == before


class Robot(composer.Entity):
    """The arm as an entity."""

    def _build(self, name):
        self._root = robot()
        self._root.model = name

    @property
    def mjcf_model(self):
        return self._root

    @property
    def actuators(self):
        return self._root.find_all("actuator")


class TwoRobots(composer.Task):
    """Two arms, told apart by their scopes; only the first is watched."""

    def __init__(self, draw=lambda random_state: FRICTION):
        self._arena = composer.Arena()
        self._arena.mjcf_model.option.timestep = 0.001
        self._arena.mjcf_model.option.integrator = "implicitfast"
        self.robots = [Robot(name) for name in ("left", "right")]
        for entity in self.robots:
            self._arena.attach(entity)
        self._draw = draw
        self.set_timesteps(SUB_STEPS * 1e-3, 1e-3)
        self._install(FRICTION)
        left = self.robots[0].mjcf_model
        self._position = observable.MJCFFeature("qpos", left.find_all("joint"))
        self._position.enabled = True

    def _install(self, parameters):
        names = [f"{side}/{joint}" for side in ("left", "right") for joint in ("shoulder", "elbow")]
        dm.install(self._arena.mjcf_model, dict.fromkeys(names, parameters))

    @property
    def root_entity(self):
        return self._arena

    @property
    def task_observables(self):
        return {"position": self._position}

    def initialize_episode_mjcf(self, random_state):
        self._install(self._draw(random_state))

    def before_step(self, physics, action, random_state):
        physics.set_control(np.tile(action, 2))

    def get_reward(self, physics):
        return 0.0


@pytest.mark.parametrize("legacy_step", [True, False])
@pytest.mark.parametrize("recompile", [True, False])
def test_composer_equals_plain_steps_through_compiling_resets(legacy_step, recompile):
    task = TwoRobots()
    environment = composer.Environment(
        task, legacy_step=legacy_step, recompile_mjcf_every_episode=recompile
    )
    expected = plain(mujoco.MjModel.from_xml_string(task.root_entity.mjcf_model.to_xml_string()), 3)
    with dm.attach(environment):
        assert_same(episodes(environment, 3), expected)
    assert mujoco.get_mjcb_passive() is None
    environment.close()


def test_a_composer_task_draws_friction_anew_every_episode():
    queue = list(SAMPLES)
    environment = composer.Environment(TwoRobots(lambda random_state: queue.pop(0)))
    with dm.attach(environment):
        ours = episodes(environment, 3)
    for positions, parameters in zip(ours, SAMPLES, strict=True):
        task = TwoRobots(lambda _, same=parameters: same)
        task.initialize_episode_mjcf(None)
        text = task.root_entity.mjcf_model.to_xml_string()
        assert_same([positions], plain(mujoco.MjModel.from_xml_string(text)))
    assert np.abs(ours[0] - ours[2]).max() > 0.01


def arms() -> composer.Environment:
    return composer.Environment(TwoRobots())


def one_arm() -> control.Environment:
    physics = dm_mujoco.Physics.from_xml_string(spec().to_xml())
    return control.Environment(physics, Follow(), n_sub_steps=SUB_STEPS)


@pytest.mark.parametrize(("make", "joint"), [(arms, "left/elbow"), (one_arm, "elbow")])
def test_each_episode_draws_its_friction_from_samples(make, joint):
    def levels(seed: int) -> list[float]:
        environment = make()
        found = []
        with dm.attach(environment, samples={joint: SAMPLES}, seed=seed):
            for _ in range(6):
                environment.reset()
                law = read_friction(environment.physics.model.ptr)[joint].parameters
                found.append(law.Fs_pos)
        environment.reset()
        assert mujoco.get_mjcb_passive() is None
        return found

    first = levels(1)
    assert first == levels(1)
    assert len(set(first)) > 1
    assert set(first) <= set(LEVELS)
