"""The search with a linear law (`lab/linear_search`): what is there is named, what is not there is
not, and nothing hangs on the last bit. Logs are computed here, from equations of their own."""

import numpy as np
import pytest
from linear_search.columns import WiderFall, causes
from linear_search.decisions import DETERMINED
from linear_search.experiment import experiment
from linear_search.final_law import squares_of
from linear_search.find import find
from linear_search.law_basis import LawBasis, elements
from linear_search.score import gain
from linear_search.sight import smallest
from linear_search.traced import traced
from servo_plant import KNOWN, PLANT
from servo_plant import logs as servo_logs

from frictionjoint.identify.bodies import Bodies
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.log import JointLog

INERTIA, GRAVITY, NOISE = 0.05, 2.0, 0.004
ARM = GRAVITY / 9.81
OWN = INERTIA - ARM**2
MODEL = f"""<mujoco><option timestep="0.004"/><worldbody><body><joint name="j" axis="0 1 0"/>
<inertial mass="1" pos="0 0 {-ARM}" diaginertia="{OWN} {OWN} {OWN}"/>
</body></worldbody></mujoco>"""
RATE, SECONDS = 200.0, 15.0


def motion(seed):
    """Position, velocity and acceleration of some waves, slow and fast, with rests in between."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, SECONDS, 1.0 / RATE)
    q, v, a = np.zeros((3, len(t)))
    for f in rng.uniform(0.07, 0.8, 5):
        size, phase, w = rng.uniform(0.1, 0.4), rng.uniform(0.0, 6.0), 2.0 * np.pi * f
        q += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w * w * np.sin(w * t + phase)
    return t, q, v, a


def friction(q, v):
    """Maxwell-slip of five elements whose level falls with speed, and viscous friction."""
    reach = np.array([2e-4, 5e-4, 1e-3, 3e-3, 8e-3])
    part = np.array([0.3, 0.25, 0.2, 0.15, 0.1])
    held = np.zeros(5)
    out = np.empty(len(q))
    for i in range(len(q)):
        if i:
            held = np.clip(held + (q[i] - q[i - 1]) / reach, -1.0, 1.0)
        out[i] = part @ held * (0.4 + 0.12 * np.exp(-abs(v[i] / 0.05)))
    return out + 0.08 * v


def logs(effect=lambda q, v, a, gravity, f: 0.0, factor=1.0, drive="torque"):
    """Two logs of the joint with an effect of its own torque, the drive a factor times that."""
    found = []
    for seed in (3, 4):
        t, q, v, a = motion(seed)
        f = friction(q, v)
        gravity = GRAVITY * np.sin(q)
        torque = INERTIA * a + gravity + f + effect(q, v, a, gravity, f)
        torque += NOISE * np.random.default_rng(10 * seed).standard_normal(len(t))
        found.append(
            JointLog(name=f"log{seed}", joint="j", time=t, position=q, **{drive: torque * factor})
        )
    return prepare(found, RigidBody(MODEL, "j"))


def grows_with_load(q, v, a, gravity, f):
    return 0.25 * np.abs(INERTIA * a + gravity) * f / 0.5


def wave(q, v, a, gravity, f):
    return 0.1 * np.sin(23.0 * q + 0.4)


EFFECTS = {
    "torque-bias": lambda q, v, a, gravity, f: 0.1,
    "load-dependent": grows_with_load,
}
# what explains as much in these logs
ALIKE = {"torque-bias": {"direction-asymmetry"}}


@pytest.fixture(scope="module")
def nothing_hidden():
    return logs()


@pytest.fixture(scope="module")
def found():
    return {name: find(logs(effect)) for name, effect in EFFECTS.items()}


def test_elements_keep_a_memory_of_reversals():
    reach = np.array([1.0])
    q = np.array([0.0, 0.4, 0.1, 0.4, 3.0, 2.5, 3.0])
    z = elements(q, reach, 0.0)[:, 0]
    # a small loop closes, slipping stays at the level, and the way back is as stiff
    assert z == pytest.approx([0.0, 0.4, 0.1, 0.4, 1.0, 0.5, 1.0])


def test_the_columns_take_a_law_out_that_they_are_not(nothing_hidden):
    own = experiment(nothing_hidden)
    n = len(own.target)
    left = np.sqrt(np.mean(own.residual[:n] ** 2))
    floor = np.sqrt(np.mean([sum(s.noise.left(s.bandwidth_hz)) for s in nothing_hidden.segments]))
    assert left < 2.0 * floor
    # what the law holds is gone, and nothing else
    X, _ = LawBasis(nothing_hidden).columns
    out = own.out(X[:, :3])
    assert np.linalg.norm(out[:n]) < 0.1 * np.linalg.norm(X[:, :3] * own.weight[:, None])
    assert np.abs(own.orthonormal.T @ out).max() < 1e-9 * np.linalg.norm(X[:, :3])


def test_nothing_is_named_where_nothing_is_hidden(nothing_hidden):
    assert find(nothing_hidden).chosen.names == ()


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_is_named_alone(found, name):
    own = found[name]
    said = {n for names in (own.chosen.names, *own.ties) for n in names}
    assert name in said
    assert said <= {name} | ALIKE.get(name, set())
    assert len(own.chosen.names) == 1


def test_two_effects_are_named_together():
    both = find(logs(lambda *x: wave(*x) + grows_with_load(*x)))
    assert both.chosen.names == ("load-dependent", "position-periodic")


def test_every_effect_that_is_named_is_determined(found):
    for own in found.values():
        over = own.sets.over_errors(own.chosen)
        assert min(over[c] for c in causes(own.chosen.models)) >= DETERMINED


def test_the_smallest_effect_is_stated_by_what_the_law_does_not_hold_of_it(nothing_hidden):
    own = find(nothing_hidden)
    (bias,) = own.sets.by_name["torque-bias"]
    least = smallest(own.sets, own.chosen, bias)
    larger, lesser = (
        find(logs(lambda q, v, a, gravity, f, size=size: size * np.ones_like(q)))
        for size in (1.5 * least, 0.5 * least)
    )
    assert "torque-bias" in {n for names in (larger.chosen.names, *larger.ties) for n in names}
    assert lesser.chosen.names == ()
    # of curved viscous friction the law holds most
    curved = own.sets.by_name["nonlinear-viscous"][0]
    assert smallest(own.sets, own.chosen, curved) > 3.0 * least


def test_what_is_not_determined_does_not_hold(found):
    own = found["torque-bias"]
    (bias,) = causes(own.chosen.models)
    spring = next(c for c in own.sets.by_name["spring"])
    together = own.sets.best((bias, spring))
    over = own.sets.over_errors(together)
    assert (min(over.values()) >= DETERMINED) or not own.sets.holds(together)
    assert not own.sets.holds(own.sets.best((WiderFall(),)))


def test_a_tie_holds_in_both_directions(found):
    own = found["torque-bias"]
    for other in own.alike:
        there = gain(other.squares, own.chosen.squares, own.experiment.friction)
        back = gain(own.chosen.squares, other.squares, own.experiment.friction)
        assert not (there.errors > 1.0 and there.part > 0.5)
        assert not (back.errors > 1.0 and back.part > 0.5)


def test_the_last_bit_changes_nothing(found):
    before = found["load-dependent"]
    after = find(logs(grows_with_load, 1.0 + 1e-11))
    assert after.chosen.names == before.chosen.names
    assert after.ties == before.ties
    assert after.chosen.total == pytest.approx(before.chosen.total, rel=1e-3)


def test_the_result_is_the_integrated_law_with_the_named_effect():
    prepared = logs(grows_with_load)
    result = traced(prepared)
    (step,) = result.findings
    assert step.term.name == "load-dependent"
    assert step.gain > 0.9
    assert step.row.p_value <= 0.01
    assert result.unexplained == ()
    assert type(result.final.shape).__name__ == "IntegratedShape"
    assert squares_of(result.final) < 0.05 * squares_of(result.base)
    assert result.final.coefficient("Fc") == pytest.approx(0.4, rel=0.1)


def test_a_wave_of_the_encoder_is_no_effect_of_the_joint():
    found = []
    for seed in (3, 4):
        t, q, v, a = motion(seed)
        torque = INERTIA * a + GRAVITY * np.sin(q) + friction(q, v)
        torque += NOISE * np.random.default_rng(seed).standard_normal(len(t))
        read = q + 0.02 * np.sin(q + 0.7)
        found.append(JointLog(name=f"log{seed}", joint="j", time=t, position=read, torque=torque))
    own = find(prepare(found, RigidBody(MODEL, "j")))
    assert own.chosen.names == ("position",)


def test_the_gain_of_a_voltage_is_found_along_with_what_is_missing():
    found = find(logs(grows_with_load, 12.0, "voltage"))
    assert found.experiment.gain == pytest.approx(12.0, rel=0.1)
    # viscous friction of a voltage is not told from back-EMF
    assert found.chosen.names == ("back-emf", "load-dependent")


@pytest.mark.parametrize(
    "hidden", [{"delay": 0.03}, {"limit": 0.5}, {"deadband": 0.06}, {}], ids=lambda x: str(*x)
)
def test_what_a_controller_does_is_named_with_its_number(hidden):
    bodies = Bodies(PLANT.format(""), "j", None)
    recorded = servo_logs(hidden)
    found = find(prepare(recorded, bodies.of(recorded), controller=KNOWN))
    name = {"delay": "command-delay", "limit": "drive-limit"}
    assert found.chosen.names == ("back-emf", *(name.get(x, x) for x in hidden))
    numbers = [x for term in causes(found.chosen.models) for x in term.shape]
    assert numbers == pytest.approx(list(hidden.values()), rel=0.05)
