"""A delay between the channels: the whole model is late, edges of friction and all."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import prepared_logs

from frictionjoint.effects.measurement_delay import EFFECT
from frictionjoint.effects.signals import TIME
from frictionjoint.identify.design import balance, full_signals
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.sensitivity import driven, sensitivities
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from tests.plants.draw import draw_trial

DELAY = 8e-3


@pytest.fixture(scope="module")
def late(tmp_path_factory):
    """A LuGre joint whose position is logged 8 ms late."""
    folder = tmp_path_factory.mktemp("late")
    spec = draw_trial(np.random.default_rng(31), "one:measurement-delay")
    effect = replace(spec.effects[0], parameters={"delay": DELAY})
    spec = replace(spec, friction=replace(spec.friction, law="lugre"), effects=(effect,))
    return prepared_logs(spec, folder, 2), spec


def test_the_drive_of_an_earlier_time(late):
    segment = late[0].segments[0]
    t = segment.signals[:, TIME]
    wave = replace(segment, drive=np.sin(2.0 * t))
    inside = t > t[0] + DELAY
    assert wave.drive_before(DELAY)[inside] == pytest.approx(
        np.sin(2.0 * (t - DELAY))[inside], abs=1e-7
    )
    assert np.all(wave.drive_before(0.0) == wave.drive)


def test_a_delay_and_the_law_are_found_together(late):
    prepared, spec = late
    found = fit(prepared, (EffectTerm(EFFECT, (0.0,)),), forms=forms_of("lugre"))
    assert found.terms[0].shape[0] == pytest.approx(DELAY, abs=1.0 / spec.instrument.rate)
    assert found.coefficient("Fc") == pytest.approx(spec.friction.Fc, rel=0.03)
    assert found.coefficient("sigma2") == pytest.approx(spec.friction.sigma2, rel=0.1)
    without = fit(prepared, forms=forms_of("lugre"))
    assert found.rms < 0.5 * without.rms


def test_the_slope_by_a_delay_is_the_rate_of_the_torque(late):
    """u(t - T) falls by u'(t - T) for every second more, so the model late by T rises by it."""
    prepared, _ = late
    found = fit(prepared, (EffectTerm(EFFECT, (0.0,)),), forms=forms_of("lugre"))
    slope = found.jacobian[:, -1]
    segment = prepared.segments[0]
    delay = found.terms[0].shape[0]
    h = 1e-5
    rate = (segment.balanced_drive(delay - h) - segment.balanced_drive(delay + h)) / (2.0 * h)
    own = slope[found.log_index == 0]
    np.testing.assert_allclose(own, rate[segment.kept], atol=1e-4 * own.std())
    np.testing.assert_allclose(sensitivities(prepared, found)[:, -1], slope)


def test_a_planned_motion_has_no_drive_of_its_own(late):
    """The delay's sensitivity is then that to the torque which the model asks for."""
    prepared, _ = late
    found = fit(prepared, (EffectTerm(EFFECT, (0.0,)),), forms=forms_of("lugre"))
    silent = tuple(replace(s, drive=np.zeros_like(s.drive)) for s in prepared.segments)
    planned = driven(replace(prepared, segments=silent), found)
    # what the model asks for, without the noise that is in the measured torque
    signals = full_signals(prepared, found.shape, *found.levels)
    asked = [
        s.lowpass(np.gradient(balance(x, *found.levels), s.dt))
        for s, x in zip(prepared.segments, signals, strict=True)
    ]
    rate = np.concatenate([x[s.kept] for x, s in zip(asked, prepared.segments, strict=True)])
    assert np.corrcoef(sensitivities(planned, found)[:, -1], rate)[0, 1] > 0.99
