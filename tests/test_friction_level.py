"""A change of the friction level reaches the torque by motion: effects that change it obey."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frictionjoint.effects import (
    backlash,
    direction_asymmetry,
    dwell_time,
    frictional_lag,
    load_dependent,
    position_periodic,
    warm_up_drift,
)
from frictionjoint.effects.friction_level import approached
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import DT, GEAR, N_SIGNALS, TIME, H, Q, V
from frictionjoint.identify.terms import EffectTerm
from tests import three_sines

LEVELS = st.floats(-10.0, 10.0)
REACHES = st.floats(1e-6, 1.0)
SHAPES = {
    dwell_time.EFFECT: (0.5, 0.01, 1e-3),
    frictional_lag.EFFECT: (0.05, 0.2, 1e-3),
    load_dependent.EFFECT: (1e-3,),
    load_dependent.COULOMB: (1e-3,),
    load_dependent.STRIBECK: (1e-3, 0.1),
    position_periodic.PERIODIC_LEVEL: (20.0, 1e-3),
}


@given(LEVELS, LEVELS, REACHES)
def test_nothing_changes_without_motion(E, target, reach):
    assert approached(E, target, 0.0, reach) == pytest.approx(E, abs=1e-14)


@given(LEVELS, LEVELS, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), REACHES)
def test_steps_of_any_size_end_alike_and_never_beyond_the_target(E, target, a, b, reach):
    at_once = approached(E, target, abs(a) + abs(b), reach)
    assert approached(approached(E, target, a, reach), target, b, reach) == pytest.approx(
        at_once, abs=1e-12
    )
    assert min(E, target) - 1e-12 <= at_once <= max(E, target) + 1e-12


def slid_rested_slid(rest: float) -> np.ndarray:
    """Signals of a joint that slides at 0.5 rad/s, rests, and slides on."""
    dt = 1e-3
    v = np.concatenate([np.full(1000, 0.5), np.zeros(int(rest / dt)), np.full(1000, 0.5)])
    signals = np.zeros((len(v), N_SIGNALS))
    signals[:, TIME] = np.arange(len(v)) * dt
    signals[1:, DT] = dt
    signals[:, V], signals[:, Q], signals[:, H] = v, np.cumsum(v) * dt, 1.0
    signals[:, GEAR] = np.where(np.arange(len(v)) < 1000, 1.0, 3.0)  # loaded at rest
    return signals


@pytest.mark.parametrize("effect", SHAPES, ids=lambda e: f"{e.name} {e.effect_id}")
def test_a_joint_at_rest_keeps_its_torque(effect):
    signals = slid_rested_slid(1.0)
    n = len(effect.coefficients)
    torque = columns(effect.effect_id, SHAPES[effect], n, signals)[:, 0]
    assert np.ptp(torque[1001:1999]) == 0.0
    assert np.ptp(torque[2000:2100]) > 0.05


def test_a_reversal_takes_a_difference_between_the_directions_along():
    """As a bristle does: at once nothing changes; in sliding either way the form is the same."""
    dt, reach = 1e-4, 1e-3
    signals = np.zeros((4000, N_SIGNALS))
    signals[1:, DT] = dt
    signals[:, V] = np.where(np.arange(4000) < 2000, 0.5, -0.5)
    signals[:, Q] = np.cumsum(signals[:, V]) * dt
    back = (signals[:, Q].max() - signals[:, Q]) * (signals[:, V] < 0.0)
    signals[:, H] = 1.0 - 2.0 * -np.expm1(-back / reach)
    effect = direction_asymmetry.BY_MOTION
    torque = columns(effect.effect_id, (reach,), 2, signals)[:, 0]
    plain = columns(direction_asymmetry.EFFECT.effect_id, (), 2, signals)[:, 0]
    assert np.abs(np.diff(torque)).max() < 0.15  # two steps of the bristle
    assert torque[[1999, 3999]] == pytest.approx(plain[[1999, 3999]], abs=1e-3)
    # E' = 1 - 2 exp(-x) - E over x = distance / reach, from E = 1
    assert torque.min() == pytest.approx(1.0 - 2.0 / math.e, abs=0.05)


def test_stiction_grows_with_the_rest_before_it_and_is_slid_off():
    """Breakaway after a rest is c (1 - exp(-rest/tau)) above steady sliding, as the form says."""
    tau, slip, reach = 0.5, 0.05, 1e-5
    peaks = []
    for rest in (0.1, 0.5, 3.0):
        torque = columns(dwell_time.EFFECT.effect_id, (tau, slip, reach), 1, slid_rested_slid(rest))
        steady = (1.0 / tau) / (1.0 / tau + 0.5 / slip)
        after = torque[-1000:, 0]
        peaks.append(after.max() - steady)
        assert after[-1] == pytest.approx(steady, abs=1e-3)
        assert peaks[-1] == pytest.approx((1.0 - steady) * -math.expm1(-rest / tau), abs=0.02)
    assert peaks[0] < peaks[1] < peaks[2]


@pytest.mark.parametrize(
    ("effect", "level"), [*zip(load_dependent.FORMS, (1.5, 1.0, 1.0), strict=True)]
)
def test_friction_of_a_load_is_proportional_to_it_in_sliding(effect, level):
    """With a Stribeck level of 1.5 Fc all of it grows, or the Coulomb part alone."""
    signals = slid_rested_slid(1.0)
    signals[:, H] = 1.5
    torque = columns(effect.effect_id, SHAPES[effect], 1, signals)[:, 0]
    assert torque[[999, -1]] == pytest.approx([level, 3.0 * level], rel=1e-9)


def test_a_load_may_have_a_stribeck_curve_of_its_own():
    """cs falls off with speed as exp(-|v|/vs): at 0.5 rad/s and vs = 0.1 rad/s by exp(-5)."""
    effect = load_dependent.STRIBECK
    torque = columns(effect.effect_id, SHAPES[effect], 2, slid_rested_slid(1.0))
    assert torque[999] == pytest.approx([1.0, math.exp(-5.0)], rel=1e-9)


def test_rubbing_warms_and_rest_cools():
    """w = tau |v| (1 - exp(-t/tau)) while it slides, then it falls by exp(-rest/tau)."""
    tau, scale, rest = 0.8, 0.3, 1.5
    signals = slid_rested_slid(rest)
    shape = (tau, scale)
    level = columns(warm_up_drift.BY_LOSS.effect_id, shape, 2, signals)[:, 0]
    warmth = -scale * np.log(level)
    warmest = 0.5 * tau * (1.0 - math.exp(-1.0 / tau))
    assert warmth[[999, 2499]] == pytest.approx(
        [warmest, warmest * math.exp(-rest / tau)], rel=5e-3
    )
    assert warmth[-1] > warmth[2499]


def test_a_link_falls_freely_through_its_gap():
    """Under a torque that changes sign once, the gap p is crossed in sqrt(2 p/torque)."""
    dt, gap, pull = 1e-4, 2e-3, 1.0
    signals = np.zeros((4000, N_SIGNALS))
    signals[:, TIME] = np.arange(len(signals)) * dt
    signals[1:, DT] = dt
    signals[:, GEAR] = np.where(signals[:, TIME] < 0.1, -pull, pull)
    shape = (gap, 200.0, 0.7, 0.0)
    transmitted = columns(backlash.EFFECT.effect_id, shape, 1, signals)[:, 0] + signals[:, GEAR]
    assert transmitted[950] == pytest.approx(-pull, rel=1e-3)
    turned = int(np.argmax(signals[:, GEAR] > 0.0))
    impact = turned + int(np.argmax(transmitted[turned:] > pull))
    assert np.abs(transmitted[turned + 20 : impact - 20]).max() < 1e-12
    assert (impact - turned) * dt == pytest.approx(math.sqrt(2.0 * gap / pull), rel=0.05)
    assert transmitted[-1] == pytest.approx(pull, rel=1e-2)


@pytest.mark.parametrize("form", load_dependent.FORMS)
def test_noise_of_the_acceleration_is_no_load(form, tmp_path):
    """Of a load that comes and goes the size counts, and the size of noise has no mean of zero."""
    prepared = three_sines.logged(tmp_path, three_sines.INERTIA * three_sines.A)
    (log,) = prepared.segments
    term = EffectTerm(form, SHAPES[form])

    def friction(gear):
        signals = log.signals.copy()
        signals[:, GEAR], signals[:, H] = gear, np.sign(signals[:, V])
        loaded = replace(log, signals=signals)
        return log.smooth(term.columns(loaded, signals)[:, 0])[log.mask]

    gear = log.signals[:, GEAR]
    noise = np.std(gear) * np.random.default_rng(0).standard_normal(len(gear))
    without = friction(gear)
    assert np.std(friction(gear + noise) - without) < 0.15 * np.std(without)
