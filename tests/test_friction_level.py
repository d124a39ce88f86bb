"""A change of the friction level reaches the torque by motion: effects that change it obey."""

import math

import numpy as np
import pytest
from acting import acting, name, torques

from frictionjoint.effects import warm_up_drift
from frictionjoint.effects.friction_level import DWELL_TIME
from frictionjoint.effects.gear import BACKLASH
from frictionjoint.effects.kernel import columns, scales_level
from frictionjoint.effects.signals import DT, GEAR, N_SIGNALS, ONSET, TIME, H, Q, V


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


def test_stiction_grows_with_the_rest_before_it_and_is_slid_off():
    """Breakaway after a rest is c (1 - exp(-rest/tau)) above steady sliding, as the form says."""
    tau, slip, reach = 0.5, 0.05, 1e-5
    peaks = []
    for rest in (0.1, 0.5, 3.0):
        torque = columns(DWELL_TIME.effect_id, (tau, slip, reach), 1, slid_rested_slid(rest))
        steady = (1.0 / tau) / (1.0 / tau + 0.5 / slip)
        after = torque[-1000:, 0]
        peaks.append(after.max() - steady)
        assert after[-1] == pytest.approx(steady, abs=1e-3)
        assert peaks[-1] == pytest.approx((1.0 - steady) * -math.expm1(-rest / tau), abs=0.02)
    assert peaks[0] < peaks[1] < peaks[2]


@pytest.mark.parametrize("effect", [e for e in torques() if scales_level(e.effect_id)], ids=name)
def test_in_sliding_a_simulated_level_is_that_of_a_log(effect):
    signals = slid_rested_slid(0.1)
    signals[1000:, [V, H]] *= -1.0
    signals[:, Q] = np.cumsum(signals[:, V] * signals[:, DT])
    along = [effect.effect_id, acting(effect).shape, len(effect.coefficients), signals]
    log = columns(*along)
    signals[:, ONSET] = 1e-7
    np.testing.assert_allclose(columns(*along)[[999, -1]], log[[999, -1]], rtol=1e-6, atol=1e-7)


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


def test_viscous_loss_warms_too():
    """At constant speed w = tau |v| (1 + ratio |v|) (1 - exp(-t/tau))."""
    tau, scale, ratio = 0.8, 0.3, 4.0
    by_whole_loss = warm_up_drift.BY_WHOLE_LOSS.effect_id
    level = columns(by_whole_loss, (scale, ratio, tau), 2, slid_rested_slid(0.1))[:, 0]
    warmest = tau * 0.5 * (1.0 + ratio * 0.5) * -math.expm1(-1.0 / tau)
    assert -scale * np.log(level[999]) == pytest.approx(warmest, rel=5e-3)


def test_a_link_falls_freely_through_its_gap():
    """Under a torque that changes sign once, the gap p is crossed in sqrt(2 p/torque)."""
    dt, gap, pull = 1e-4, 2e-3, 1.0
    signals = np.zeros((4000, N_SIGNALS))
    signals[:, TIME] = np.arange(len(signals)) * dt
    signals[1:, DT] = dt
    signals[:, GEAR] = np.where(signals[:, TIME] < 0.1, -pull, pull)
    shape = (gap, 200.0, 0.7, 0.0)
    transmitted = columns(BACKLASH.effect_id, shape, 1, signals)[:, 0] + signals[:, GEAR]
    assert transmitted[950] == pytest.approx(-pull, rel=1e-3)
    turned = int(np.argmax(signals[:, GEAR] > 0.0))
    impact = turned + int(np.argmax(transmitted[turned:] > pull))
    assert np.abs(transmitted[turned + 20 : impact - 20]).max() < 1e-12
    assert (impact - turned) * dt == pytest.approx(math.sqrt(2.0 * gap / pull), rel=0.05)
    assert transmitted[-1] == pytest.approx(pull, rel=1e-2)
