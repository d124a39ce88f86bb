"""Every effect is told from all others on a plant, of MuJoCo's parts, that has exactly it."""

from dataclasses import replace

import numpy as np
import pytest
from plants.draw import draw_trial
from trial_logs import prepared_logs

from frictionjoint.diagnose.trace import trace

# A plant each, by the seed it is drawn from: the first of 1, 2, 3 with which the effect shows in
# two short logs. Concave or quadratic viscosity mostly looks like the law's own curve there.
PLANTS = {
    "backlash": 1,
    "dwell-time": 2,
    "end-stop": 1,
    "frictional-lag": 1,
    "gravity-error": 1,
    "inertia-error": 1,
    "joint-elasticity": 1,
    "load-dependent": 1,
    "measurement-delay": 2,
    "position-periodic": 1,
    "spring": 1,
    "temperature-dependent": 1,
    "torque-bias": 1,
    "torque-gain": 1,
    "warm-up-drift": 1,
}


def plant(name, seed, friction="lugre", seconds=None):
    spec = draw_trial(np.random.default_rng(seed), f"one:{name}")
    motions = tuple(replace(m, duration=seconds or m.duration) for m in spec.motions[:2])
    instrument = replace(spec.instrument, rate=250.0, jitter=0.0)
    law = replace(spec.friction, law=friction)
    return replace(spec, motions=motions, instrument=instrument, friction=law)


@pytest.mark.parametrize(("name", "seed"), PLANTS.items())
def test_it_is_named_first(name, seed, tmp_path):
    warm = name in ("temperature-dependent", "warm-up-drift")
    found = trace(prepared_logs(plant(name, seed, seconds=40.0 if warm else 12.0), tmp_path))
    assert [s.term.name for s in found.findings][:1] == [name]
