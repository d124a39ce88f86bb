"""Causes that hide: met in one log only, at the edge of a limit, or behind a bent law."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from plants.catalogue import also, quantities
from plants.draw import draw_trial
from plants.spec import Effect, PlantSpec
from trial_logs import prepared_logs

from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.trace import trace


def drawn(seed: int, kind: str) -> PlantSpec:
    return draw_trial(np.random.default_rng(seed), kind)


def traced(spec: PlantSpec, folder: Path) -> Trace:
    """The search on three of a plant's four logs, 15 s each at 250 Hz."""
    motions = tuple(replace(m, duration=min(m.duration, 15.0)) for m in spec.motions)
    instrument = replace(spec.instrument, rate=250.0)
    return trace(prepared_logs(replace(spec, motions=motions, instrument=instrument), folder, 3))


def of_those(spec: PlantSpec, found: Trace) -> bool:
    """Whether only quantities that may rightly be named are, and no effect is."""
    named = {f.term.name for f in found.findings}
    unnamed = {name for name, _ in found.unexplained}
    (cause,) = spec.effects
    return named <= also(cause.name) and unnamed <= {*quantities(cause.name), "log", "time"}


def test_an_end_stop_that_one_log_meets_is_named(tmp_path):
    """No other log can test it, so it is tested on stretches of that one."""
    spec = drawn(4, "none")
    far, *_ = (m.amplitude for m in spec.motions)
    short = [replace(m, amplitude=0.5 * m.amplitude) for m in spec.motions]
    stiffness = 4.0 * spec.friction.Fs / far
    stop = Effect("end-stop", {"at": 0.7 * far, "stiffness": stiffness})
    spec = replace(spec, motions=(spec.motions[0], *short[1:]), effects=(stop,))
    found = traced(spec, tmp_path)
    assert [s.term.name for s in found.findings] == ["end-stop"]
    assert found.final.terms[0].shape == pytest.approx((0.7 * far,), rel=0.01)
    assert found.final.term_coefficients(0)[0] == pytest.approx(stiffness, rel=0.1)


def test_a_drive_at_its_limit_is_no_wrong_gain(tmp_path):
    spec = drawn(97010, "unknown")
    assert spec.effects[0].name == "drive-saturation"
    assert of_those(spec, traced(spec, tmp_path))


def test_what_bends_a_law_is_found_though_a_curve_explains_more_beside_the_bent_one(tmp_path):
    """The Stribeck curve had taken the place of viscous friction that grows with a power of v."""
    spec = drawn(100002, "one")
    assert spec.effects[0].name == "nonlinear-viscous"
    found = traced(spec, tmp_path)
    assert [s.term.name for s in found.findings] == ["nonlinear-viscous"]
    assert found.unexplained == ()


def test_a_memory_of_seconds_is_no_warming(tmp_path):
    """A seal rubs through a soft spring: a lubricant warm within 1.5 s would explain that too."""
    spec = drawn(103007, "unknown:stick-slip-contact")
    found = traced(spec, tmp_path)
    assert of_those(spec, found)
    assert found.unexplained


def test_what_fades_as_fast_as_a_warming_may_is_none(tmp_path):
    """A level that settles within two seconds would pass for a warming within five."""
    spec = drawn(3, "one:warm-up-drift")
    (warming,) = spec.effects
    spec = replace(spec, effects=(replace(warming, parameters={**warming.parameters, "tau": 2.0}),))
    assert "warm-up-drift" not in [s.term.name for s in traced(spec, tmp_path).findings]


def test_of_what_explains_alike_beside_all_others_the_simplest_stays(tmp_path):
    """A gain and a gravity that are both off would make up an inertia that is."""
    spec = drawn(106072, "two")
    assert {e.name for e in spec.effects} == {"inertia-error", "spring"}
    found = traced(replace(spec, motions=spec.motions[:2]), tmp_path)
    names = {s.term.name for s in found.findings}
    assert {"inertia-error", "spring"} <= names
    assert not {"torque-gain", "gravity-error"} & names
