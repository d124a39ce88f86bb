"""A delay of less than a sample: found, allowed for and told, and never taken for an effect."""

from dataclasses import replace

import pytest
from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec
from trial_logs import prepared_logs

from frictionjoint.diagnose.intervals import stated_covariance
from frictionjoint.diagnose.notes import timing_note
from frictionjoint.diagnose.timing import Delay, timed, timing_of
from frictionjoint.identify.fit import fit
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.terms import delay_of

# The plants' controller holds its torque for a millisecond.
HALF_A_TICK = 0.5e-3
SIGMA2 = 0.1
# much inertia and little viscosity: what a delay makes of the one shows beside the other
PLANT = PlantSpec(
    mass=3.0,
    length=0.3,
    inertia=0.3,
    armature=0.1,
    friction=Friction("lugre", Fs=0.6, Fc=0.5, Vs=0.1, sigma2=SIGMA2, presliding=2e-3),
    controller=Controller(kp=300.0, kd=15.0),
    motions=(Motion("sines", 3, 0.4, 4.0, 20.0), Motion("multisine", 4, 0.3, 4.0, 20.0)),
    instrument=Instrument(rate=500.0, counts=65536, torque_noise=0.01),
    seed=1,
)


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """Logs of a torque held between ticks, and the fit of the law alone."""
    logs = prepared_logs(PLANT, tmp_path_factory.mktemp("held"))
    return logs, fit(logs, forms=forms_of("lugre"))


def test_a_torque_held_between_ticks_acts_half_a_tick_later(held):
    logs, alone = held
    found = timed(logs, alone)
    delay = timing_of(found, stated_covariance(logs, found))
    assert delay.value == pytest.approx(HALF_A_TICK, abs=3.0 * delay.stderr)
    assert delay.stderr < 0.2 * HALF_A_TICK
    assert found.rms < alone.rms


def test_the_viscosity_is_no_longer_that_of_an_inertia_that_lags(held):
    logs, alone = held
    before, after = (f.coefficient("sigma2") / SIGMA2 - 1.0 for f in (alone, timed(logs, alone)))
    assert before < -0.03
    assert abs(after) < 0.2 * abs(before)


def test_where_the_torque_is_on_time_nothing_is_added(held):
    logs, _ = held
    on_time = replace(
        logs,
        segments=tuple(replace(s, drive=s.drive_before(HALF_A_TICK)) for s in logs.segments),
    )
    alone = fit(on_time, forms=forms_of("lugre"))
    assert timed(on_time, alone) is alone
    assert timing_of(alone, stated_covariance(on_time, alone)) is None


def test_a_delay_of_more_than_a_sample_is_left_to_the_effect_of_that_name(tmp_path):
    late = replace(PLANT, effects=(Effect("measurement-delay", {"delay": 5e-3}),))
    logs = prepared_logs(late, tmp_path)
    alone = fit(logs, forms=forms_of("lugre"))
    assert timed(logs, alone) is alone


def test_a_fit_that_was_timed_is_not_timed_again(held):
    logs, alone = held
    found = timed(logs, alone)
    assert timed(logs, found) is found
    assert delay_of(found.terms) > 0.0


@pytest.mark.parametrize(
    ("delay", "words"),
    [
        (0.5e-3, "a position belongs to the torque logged 0.5 ms earlier"),
        (-2e-4, "a torque belongs to the"),
    ],
)
def test_the_report_says_which_channel_is_late_and_by_how_much(delay, words):
    (note,) = timing_note(Delay(delay, 2e-5))
    assert words in note
    assert "0.02" in note
    assert timing_note(None) == ()
