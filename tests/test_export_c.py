"""The C header gives the torque of the law it was made from, and compiles without a word."""

import itertools

import cancel_stick_slip as example
import numpy as np
import pytest
from acting import acting
from acting import name as effect_name
from c_header import COMPILER, Header

from frictionjoint import rivals
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ModelError
from frictionjoint.export.c import header, lost_effects
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.parameters import FrictionParameters
from frictionjoint.simulate.carrier import load_model, read_friction
from frictionjoint.simulate.joint_effects import effects_torque
from frictionjoint.simulate.row import row_size, torque_now
from frictionjoint.simulate.stick_slip import kuka_model

needs_c = pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")
KNOTS = ((1e-4, 1.1), (3e-4, 2.2), (2e-3, 3.4))
LEVELS = {
    **{"Fs_pos": 1.5, "Fs_neg": 1.3, "Fc_pos": 1.0, "Fc_neg": 1.1, "Vs_pos": 0.05},
    **{"Vs_neg": 0.08, "delta_pos": 2.0, "delta_neg": 0.8, "sigma2_pos": 0.4, "sigma2_neg": 0.3},
}
INTEGRATED = [
    FrictionParameters(**LEVELS, knots=KNOTS, sigma1=2.0, n=n, variant=variant, virgin=virgin)
    for n, variant, virgin in itertools.product(
        (1.0, 1.3, 2.0, 3.0, 4.0, 7.5, 60.0),
        ("ganseman1997", "lampaert2002"),
        ("literal", "masing"),
    )
]
DAHL = {"Fc_pos": 1.0, "Fc_neg": 1.2, "sigma2_pos": 0.4, "sigma0": 1e4}
LUGRE = rivals.LuGreParameters(**LEVELS, sigma0=1e4, sigma1=10.0)
RIVALS = [
    rivals.StaticParameters(**LEVELS, V0=1e-3),
    rivals.ArmstrongParameters(**LEVELS, sigma0=1e4),
    *(rivals.DahlParameters(**DAHL, i=i) for i in (0.0, 0.7, 1.0, 2.0)),
    rivals.DahlStribeckParameters(**LEVELS, sigma0=1e4, i=1.3),
    LUGRE,
    rivals.ElastoplasticParameters(**LEVELS, sigma0=1e4, sigma1=10.0, breakaway=0.7),
    rivals.MaxwellSlipParameters(**LEVELS, elements=((5e3, 0.2), (3e3, 0.3), (2e3, 0.5)), C=100.0),
]


def motion(seed, n=4000):
    """Random turns from far below presliding to sliding; times that repeat and go back, too."""
    rng = np.random.default_rng(seed)
    dt = rng.choice([1e-3, 2.5e-4], n)
    dq = rng.normal(size=n) * 10 ** rng.uniform(-7, -2, n)
    run = np.repeat(rng.choice([-1.0, 1.0], n // 20), 20)
    dq = np.where(rng.random(n) < 0.7, np.abs(dq) * run, dq)
    dq[rng.random(n) < 0.05] = 0.0
    t, q, v = np.cumsum(dt), np.cumsum(dq), dq / dt + 1e-3 * rng.normal(size=n)
    again = rng.random(n) < 0.2
    again[0] = False
    t[again] = t[np.flatnonzero(again) - 1]
    t[n // 2 :] -= t[n // 2] * (1.0 - 0.3)
    return t, q, v


def python_torque(carried, t, q, v, around):
    """The same calls of the library's kernels."""
    law = carried.parameters.pack()
    effects = [e.pack() for e in carried.effects]
    P = np.concatenate([law, [float(len(effects))], *effects])
    X = np.zeros(row_size(int(law_row_size(law, 0)), len(effects)))
    F = np.empty(len(t))
    for k in range(len(t)):
        F[k] = torque_now(P, 0, len(law), X, 0, t[k], q[k], v[k], np.inf)
        if effects:
            F[k] += effects_torque(P, 0, len(law), X, 0, t[k], q[k], v[k], *around[k])
    return F, X


def compared(friction, folder, around=None, seed=0):
    """Largest difference of a joint's torques over the largest torque, for all joints."""
    made = Header(header(friction, "friction.h"), folder)
    worst = {}
    for i, (name, carried) in enumerate(friction.items()):
        t, q, v = motion(seed + i)
        expected, state = python_torque(carried, t, q, v, around)
        own = np.zeros(made.room)
        got = made.torque(i, t, q, v, around, own)
        assert np.abs(expected).max() > 0.5
        worst[name] = np.abs(got - expected).max() / np.abs(expected).max()
        np.testing.assert_allclose(own[: len(state)], state, rtol=1e-9, atol=1e-12)
    return worst


def name(parameters):
    values = parameters.to_dict()
    keys = ("law", "n", "variant", "virgin", "i")
    return "-".join(str(values[key]) for key in keys if key in values)


@needs_c
@pytest.mark.parametrize("laws", [INTEGRATED, RIVALS], ids=["integrated", "rivals"])
def test_each_law_is_the_same(tmp_path, laws):
    worst = compared({name(p): JointFriction(p) for p in laws}, tmp_path)
    assert max(worst.values()) < 1e-12, worst


@needs_c
def test_effects_are_the_same(tmp_path):
    rng = np.random.default_rng(1)
    friction = {}
    for effect in CATALOGUE:
        friction[effect_name(effect)] = JointFriction(INTEGRATED[8], (acting(effect),))
    friction["two"] = JointFriction(LUGRE, (acting(CATALOGUE[-1]), acting(CATALOGUE[0])))
    around = rng.normal(size=(4000, 6)) * (1.0, 0.1, 0.1, 9.81, 9.81, 1.0)
    worst = compared(friction, tmp_path, around)
    assert max(worst.values()) < 1e-12, worst


@needs_c
def test_a_joint_that_asks_for_its_surroundings_says_so(tmp_path):
    effect = next(e for e in CATALOGUE if e.name == "load-dependent")
    friction = {"a b": JointFriction(INTEGRATED[0], (SimulatedEffect(effect, (1e-3,), (0.2,)),))}
    made = Header(header(friction, "friction.h"), tmp_path)
    state = np.zeros(made.room)
    assert np.isnan(made.torque(0, [1.0], [0.0], [0.0], state=state)[0])
    assert not state.any()
    assert np.isfinite(made.torque(0, [1.0], [0.0], [0.0], np.ones((1, 6)), state)[0])


def test_what_only_a_log_knows_is_named():
    effect = next(e for e in CATALOGUE if e.name == "temperature-dependent")
    carried = JointFriction(INTEGRATED[0], (SimulatedEffect(effect, (30.0, 20.0), (0.1, 0.1)),))
    said = "j: temperature-dependent, at its reference temperature"
    assert lost_effects({"j": carried}) == [said]
    assert said in header({"j": carried}, "friction.h")


def test_joints_that_c_cannot_tell_apart_are_refused():
    carried = JointFriction(INTEGRATED[0])
    with pytest.raises(ModelError, match="'a b' and another are both a_b in C"):
        header({"a_b": carried, "a b": carried}, "friction.h")


@needs_c
def test_fed_forward_it_ends_the_stick_slip_of_the_kuka_joint(tmp_path):
    text = header(read_friction(load_model(kuka_model())), "friction.h")
    made, wanted = Header(text, tmp_path), example.one_way()
    ways = example.forwards(made, wanted)
    late = wanted.time > 4.0
    error, slowest = {}, {}
    for way in ("nothing", "header, measured motion"):
        # the joint has a fifth more friction than the header says
        found = example.track(example.plant(example.other_numbers()), wanted, ways[way], True)
        error[way] = np.ptp(found[late, 0] - wanted.position[late])
        slowest[way] = found[late, 1].min()
    assert slowest["nothing"] < 1e-3
    assert slowest["header, measured motion"] > 0.09
    assert error["header, measured motion"] < 0.02 * error["nothing"]
