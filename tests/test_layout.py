"""Where each parameter of a model lies, and which of them the logs can speak of."""

from dataclasses import replace

import numpy as np
import pytest
from plants.spec import Controller, Effect, Motion
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.effects import measurement_delay
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm, delay_of

# The plants' controller holds its torque for a millisecond.
HALF_A_TICK, SIGMA2 = 0.5e-3, 0.1
# much inertia and little viscosity: what a delay makes of the one shows beside the other
HEAVY = replace(
    PENDULUM,
    **{"mass": 3.0, "length": 0.3, "inertia": 0.3, "armature": 0.1},
    controller=Controller(kp=300.0, kd=15.0),
    motions=(Motion("sines", 3, 0.4, 4.0, 24.0), Motion("multisine", 4, 0.3, 4.0, 24.0)),
    instrument=replace(PENDULUM.instrument, torque_noise=0.01),
)


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """A torque held between ticks acts half a tick later."""
    logs = prepared_logs(HEAVY, tmp_path_factory.mktemp("held"))
    return logs, fit(logs, forms=forms_of("lugre"))


def test_a_torque_held_between_ticks_is_allowed_for(held):
    logs, found = held
    error = np.sqrt(stated_covariance(logs, found)[-1, -1])
    assert delay_of(found.terms) == pytest.approx(HALF_A_TICK, abs=3.0 * error)
    assert error < 0.2 * HALF_A_TICK
    # the viscosity is not that of an inertia that lags
    at = found.names.index("sigma2")
    error = float(np.sqrt(stated_covariance(logs, found)[at, at]))
    assert error < 0.15 * SIGMA2
    assert found.coefficient("sigma2") == pytest.approx(SIGMA2, abs=3.0 * error)


def test_a_delay_of_several_samples_is_more_than_timing(tmp_path):
    late = replace(HEAVY, effects=(Effect("measurement-delay", {"delay": 8e-3}),))
    logs = prepared_logs(late, tmp_path, 1)
    found = fit(logs, forms=forms_of("lugre"))
    assert delay_of(found.terms) == pytest.approx(logs.segments[0].sample, rel=0.01)
    delay = EffectTerm(measurement_delay.EFFECT, (0.0,))
    better = fit(logs, (delay,), forms=forms_of("lugre"))
    assert delay_of(better.terms) == pytest.approx(8e-3 + HALF_A_TICK, abs=3e-4)
    assert better.rms < 0.7 * found.rms
