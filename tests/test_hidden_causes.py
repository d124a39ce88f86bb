"""Causes that hide: met in one log only, at the edge of a limit, or behind a bent law."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from frictionjoint.diagnose.loop import Trace, trace
from plants.draw import draw_trial
from plants.spec import Effect, PlantSpec
from trial_logs import prepared_logs


def drawn(seed: int, kind: str) -> PlantSpec:
    return draw_trial(np.random.default_rng(seed), kind)


def traced(spec: PlantSpec, folder: Path) -> Trace:
    """The loop on three of a plant's four logs."""
    return trace(prepared_logs(spec, folder, 3))


def test_an_end_stop_that_one_log_meets_is_named(tmp_path):
    """No other log can test it, so it is tested on stretches of that one."""
    spec = drawn(4, "none")
    far, *_ = (m.amplitude for m in spec.motions)
    short = [replace(m, amplitude=0.5 * m.amplitude) for m in spec.motions]
    stiffness = 4.0 * spec.friction.Fs / far
    stop = Effect("end-stop", {"at": 0.7 * far, "stiffness": stiffness})
    spec = replace(spec, motions=(spec.motions[0], *short[1:]), effects=(stop,))
    found = traced(spec, tmp_path)
    assert [s.term.name for s in found.steps] == ["end-stop"]
    assert found.final.terms[0].shape == pytest.approx((0.7 * far,), rel=0.01)
    assert found.final.term_coefficients(0)[0] == pytest.approx(stiffness, rel=0.1)


def test_the_limit_of_a_drive_is_fitted(tmp_path):
    """A limit a little off leaves what passes for a wrong gain of the torque."""
    spec = drawn(97010, "unknown")
    assert spec.effects[0].name == "drive-saturation"
    found = traced(spec, tmp_path)
    assert found.steps == ()
    assert found.unexplained[0].name == "torque"


def test_what_bends_a_law_is_found_though_a_curve_explains_more_beside_the_bent_one(tmp_path):
    """The Stribeck curve had taken the place of viscous friction that grows with a power of v."""
    spec = drawn(100002, "one")
    assert spec.effects[0].name == "nonlinear-viscous"
    found = traced(spec, tmp_path)
    assert [s.term.name for s in found.steps] == ["nonlinear-viscous"]
    assert found.unexplained == ()


def test_a_memory_of_seconds_is_no_warming(tmp_path):
    """A seal rubs through a soft spring: a lubricant warm within 1.5 s would explain that too."""
    found = traced(drawn(103007, "unknown:stick-slip-contact"), tmp_path)
    assert [s.term.name for s in found.steps] == []
    assert "position" in [r.name for r in found.unexplained]


def test_what_fades_as_fast_as_a_warming_may_is_none(tmp_path):
    """A level that settles within two seconds would pass for a warming within five."""
    spec = drawn(3, "one:warm-up-drift")
    (warming,) = spec.effects
    spec = replace(spec, effects=(replace(warming, parameters={**warming.parameters, "tau": 2.0}),))
    assert "warm-up-drift" not in [s.term.name for s in traced(spec, tmp_path).steps]


def test_of_what_explains_alike_beside_all_others_the_simplest_stays(tmp_path):
    """A gain and a gravity that are both off would make up an inertia that is."""
    spec = drawn(106072, "two")
    assert {e.name for e in spec.effects} == {"inertia-error", "spring"}
    instrument = replace(spec.instrument, rate=250.0)
    found = traced(replace(spec, instrument=instrument, motions=spec.motions[:2]), tmp_path)
    names = {s.term.name for s in found.steps}
    assert {"inertia-error", "spring"} <= names
    assert not {"torque-gain", "gravity-error"} & names
