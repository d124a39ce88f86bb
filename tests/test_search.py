"""The search for what a model lacks, on small plants of MuJoCo's parts: what is there is found
alone, what is not there is not, and what the logs cannot distinguish is said to be a tie."""

from dataclasses import replace

import numpy as np
import pytest
from plants.plant import simulate, write
from plants.spec import Effect, Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.decisions import SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.diagnose.detection_limit import smallest
from frictionjoint.diagnose.library import effects
from frictionjoint.diagnose.outcome import finish_search
from frictionjoint.diagnose.trace import trace
from frictionjoint.effects.signals import Q
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_parameters, term_estimates
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.measured.readers import read_log
from tests.planting import planted

# 24 s at 250 Hz on a LuGre joint
PLANT = replace(PENDULUM, instrument=replace(PENDULUM.instrument, rate=250.0))
COGGING = Effect("position-periodic", {"amplitude": 0.15, "cycles": 14.0, "phase": 0.4})
BIAS = Effect("torque-bias", {"bias": 0.15})
DELAY = Effect("measurement-delay", {"delay": 0.012})
WARMTH = {"level": 0.4, "viscous": 0.2, "rise": 20.0, "tau": 8.0, "scale": 15.0}
# wide enough that a wave of the encoder is not a line
WIDE = tuple(Motion("multisine", seed, 1.2, 3.0, 12.0) for seed in (3, 4, 5))
# effects, as the plant has them, and numbers that the search must find, with a tolerance
HIDDEN = [
    ((BIAS,), {"bias": (-0.15, 0.02)}),
    ((COGGING, BIAS), {"N": (14.0, 0.01), "bias": (-0.15, 0.02)}),
    ((DELAY,), {"delay": (0.0125, 0.04)}),
    ((Effect("warm-up-drift", WARMTH),), {}),
]


def traced(folder, *effects, law=None, **changes):
    return trace(prepared_logs(replace(PLANT, effects=effects, **changes), folder), law=law)


@pytest.mark.parametrize(("effects", "expected"), HIDDEN, ids=["bias", "two", "delay", "warmth"])
def test_what_is_there_is_found_alone_with_its_size(effects, expected, tmp_path):
    found = traced(tmp_path, *effects)
    assert {step.term.name for step in found.findings} == {e.name for e in effects}
    assert found.unexplained == ()
    cov, values = stated_covariance(found.prepared, found.final), {}
    for i, step in enumerate(found.findings):
        assert SMALLEST_GAIN <= step.gain <= 1.0
        assert step.row.p_value <= SIGNIFICANCE
        if len(effects) == 1:
            # other levels for both directions are a bias while the joint slides
            may_be = {"direction-asymmetry"} if step.term.name == "torque-bias" else set()
            assert set(step.ties) <= may_be
        values |= {n: x.value for n, x in term_estimates(found.final, cov, i, slide=False).items()}
    if expected:  # where it warms up the level is another too
        assert found.final.coefficient("Fc") == pytest.approx(PLANT.friction.Fc, rel=0.02)
    for number, (value, tolerance) in expected.items():
        assert values[number] == pytest.approx(value, rel=tolerance)


@pytest.mark.parametrize(("size", "N"), [({"amplitude": 0.15}, 4.0), ({"level": 0.3}, 6.0)])
def test_a_wave_as_long_as_the_travel_is_named_and_not_a_curve(size, N, tmp_path, monkeypatch):
    def finish(state, *others):
        state.left_out["position-periodic"] = "another wave was in the model too"
        return finish_search(state, *others)

    monkeypatch.setattr("frictionjoint.diagnose.trace.finish_search", finish)
    found = traced(tmp_path, Effect("position-periodic", {**size, "cycles": N, "phase": 0.4}))
    assert found.prepared.span * N < 2.0 * np.pi  # not one wave in the longest log
    (step,) = found.findings
    assert step.term.name == "position-periodic"
    assert step.term.free_shape[0] == pytest.approx(N, rel=0.05)
    assert found.final.rms_in_motion < 0.05 * found.base.rms_in_motion


@pytest.mark.parametrize("friction", ["elasto-plastic", "gms"])
def test_where_nothing_is_missing_nothing_is_added(friction, tmp_path):
    nothing_is_missing(traced(tmp_path, friction=replace(PLANT.friction, law=friction)))


def nothing_is_missing(found):
    """Whatever law the joint has."""
    assert found.findings == ()
    assert found.final is found.base  # nothing changed: no error before and another after
    assert found.unexplained == ()
    # the others are compared with it
    assert law_parameters(found.final).law == "integrated"
    assert "lugre" in dict(found.other_laws.errors)
    assert 0.0 < found.detection_limit.torque < 0.1 * PLANT.friction.Fc
    # what the law imitates has to be larger than what it cannot
    sizes = {x.name: x for x in found.detection_limit.of_each}
    assert sizes["torque-bias"].least < 2.0 * found.detection_limit.torque
    assert sizes["torque-bias"].most < 0.5 * sizes["nonlinear-viscous"].most
    assert all(x.least <= x.most for x in sizes.values())


def test_the_smallest_effect_that_is_stated_would_have_been_shown(tmp_path):
    """Half as much again is found, a third of it is not, in logs that hide nothing."""
    logs = [read_log(path, "joint") for path in write(simulate(PLANT), tmp_path)]
    body = RigidBody(tmp_path / "joint.xml", "joint")
    found = trace(prepare(logs, body))
    nothing_is_missing(found)
    name, blocks = "load-dependent", make_blocks(found.prepared, found.final)
    known = effects(found.prepared, found.final, blocks)
    candidate = next(c for c in known if c.term.name == name)
    (stated,) = smallest(found.final, blocks, [candidate], found.detection_limit.torque)
    kind = next(x for x in found.detection_limit.of_each if x.name == name)
    assert 0.99 * kind.least <= stated <= 1.01 * kind.most
    for times, shown in ((1.5, True), (0.3, False)):
        rng = np.random.default_rng(1)
        with_it = planted(found, logs, candidate, times * stated, rng)
        names = {n for f in trace(prepare(with_it, body)).findings for n in (f.term.name, *f.ties)}
        assert (name in names) == shown


def named_by_its_quantity(folder, effect, quantity, said):
    """An effect that the catalogue lacks: what it acts through is found, and nothing named."""
    found = traced(folder, effect, law="integrated", motions=WIDE)
    assert found.findings == ()
    assert [variable for variable, _ in found.unexplained] == [quantity]
    (hint,) = found.hints
    assert said in hint
    assert found.causes == {quantity: hint}
    return found


def test_what_has_no_name_is_told_by_the_quantity_it_acts_through(tmp_path):
    gust = Effect("gust", {"amplitude": 0.25, "frequency": 0.7, "phase": 1.0})
    named_by_its_quantity(tmp_path, gust, "time", "at 0.7 Hz")


def test_an_effect_is_named_beside_a_larger_one_without_a_name(tmp_path):
    gust = Effect("gust", {"amplitude": 0.4, "frequency": 0.7, "phase": 1.0})
    small = Effect("torque-bias", {"bias": 0.1})
    found = traced(tmp_path, gust, small, motions=WIDE)
    (step,) = found.findings
    assert "torque-bias" in (step.term.name, *step.ties)
    assert [variable for variable, _ in found.unexplained] == ["time"]


def test_spring_and_gravity_over_a_small_range_are_a_tie(tmp_path):
    """Over 0.15 rad a sine is a straight line to a third of a per cent."""
    motions = (Motion("sines", 3, 0.15, 0.5, 12.0), Motion("multisine", 4, 0.12, 0.5, 12.0))
    spring = Effect("spring", {"stiffness": 2.0, "rest": 0.0})
    found = traced(tmp_path, spring, motions=motions)
    (step,) = found.findings
    assert {"spring", "gravity-error"} <= {step.term.name, *step.ties}


def test_an_end_stop_that_one_log_meets_is_named(tmp_path):
    """No other log can test it, so it is tested on stretches of that one."""
    stop = Effect("end-stop", {"at": 0.35, "stiffness": 5.0})
    far, near = PLANT.motions
    found = traced(tmp_path, stop, motions=(far, replace(near, amplitude=0.2)))
    assert found.prepared.segments[1].signals[:, Q].max() < 0.35
    assert [f.term.name for f in found.findings] == ["end-stop"]
    assert found.final.terms[0].shape == pytest.approx((0.35,), rel=0.01)
    assert found.final.term_coefficients(0)[0] == pytest.approx(5.0, rel=0.1)
