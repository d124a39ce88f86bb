"""A wrong type at a public function is a TypeError that says what to give instead."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from scope import Scope

import frictionjoint as fj
from frictionjoint.files import toml_text
from frictionjoint.joint_friction import JointFriction
from frictionjoint.measured.log import JointLog
from frictionjoint.simulate.check import check

FRICTION = fj.FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
JOINT = "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"
SPEC = mujoco.MjSpec.from_string(JOINT)
fj.install(SPEC, {"j": FRICTION})
MODEL = SPEC.compile()
DATA = mujoco.MjData(MODEL)


# what dm_control and Gymnasium hand out: a model within
PHYSICS = SimpleNamespace(ptr=MODEL)
ENVIRONMENT = SimpleNamespace(unwrapped=SimpleNamespace(model=MODEL))


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda: fj.attach("arm.xml"), "load 'arm.xml' with frictionjoint.load_model"),
        (lambda: fj.attach(SPEC), r"give spec\.compile\(\)"),
        (lambda: fj.attach(DATA), "give the model that this data belongs to"),
        (lambda: fj.attach(PHYSICS), r"give its \.ptr"),
        (lambda: fj.attach(ENVIRONMENT), r"give its \.unwrapped\.model"),
        (lambda: fj.attach(None), "give an MjModel"),
        (lambda: fj.install("arm.xml", {"j": FRICTION}), r"MjSpec\.from_file"),
        (lambda: fj.install(MODEL, {"j": FRICTION}), "give the spec that it was compiled from"),
        (lambda: fj.install(SPEC, FRICTION), r'give \{"joint name": parameters\}'),
        (lambda: fj.install(SPEC, {0: FRICTION}), "joint 0 is no name"),
        (lambda: fj.install(SPEC, {"j": FRICTION.to_dict()}), r"FrictionParameters\.from_dict"),
        (lambda: fj.install(SPEC, {"j": "j.toml"}), "read_parameters"),
        (lambda: fj.install(SPEC, {"j": JointFriction(FRICTION)}), r"give its \.parameters"),
        (lambda: fj.install(SPEC, {"j": fj.FrictionParameters}), r"FrictionParameters\(\.\.\.\)"),
        (lambda: fj.uninstall(MODEL), "uninstall takes a mujoco.MjSpec"),
        (lambda: fj.load_model(MODEL), "load_model takes the path of a file"),
        (lambda: fj.torque(MODEL, MODEL), r"give mujoco\.MjData\(model\)"),
        (lambda: fj.remembered(DATA, DATA), "remembered takes a mujoco.MjModel"),
        (lambda: check("arm.xml"), "check takes a mujoco.MjModel"),
        (lambda: Scope("arm.xml", "j"), "Scope takes a mujoco.MjModel"),
        (lambda: fj.friction_torque({}, [0], [0]), r"FrictionParameters\.from_dict"),
        (lambda: fj.friction_torque(FRICTION, "a.csv", [0]), "time is no array of numbers"),
        (lambda: fj.friction_torque(FRICTION, [0], {}), "position is no array of numbers"),
        (lambda: fj.FrictionParameters.from_dict("j.toml"), "read_parameters"),
        (lambda: fj.FrictionParameters.from_dict(toml_text(FRICTION)), "read_parameters"),
    ],
)
def test_wrong_types_name_the_mend(act, words):
    with pytest.raises(TypeError, match=words) as refused:
        act()
    assert "\n" not in str(refused.value)
    assert mujoco.get_mjcb_passive() is None


def test_slices_and_single_precision_are_logs_too():
    table = np.random.default_rng(0).standard_normal((400, 2)).astype(np.float32)
    log = JointLog(
        name="a",
        joint="j",
        time=np.arange(1200.0)[::3],
        position=table[:, 0],
        torque=table[:, 1],
        other_positions={"k": table[:, 1]},
        signals={"load": table[::-1, 0]},
    )
    for name, x in log.arrays().items():
        assert x.flags.c_contiguous, name
        assert x.dtype == np.float64, name
    np.testing.assert_array_equal(log.position, table[:, 0])
