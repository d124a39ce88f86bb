"""Where each parameter of a model lies, and which of them the logs can speak of."""

from dataclasses import replace

import numpy as np
import pytest
from law_shapes import law_at
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.notes import timing_note
from frictionjoint.effects import back_emf, load_dependent, measurement_delay, spring
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.layout import layout_of
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.search import refit, timed
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm, delay_of
from frictionjoint.identify.timing import DriveTiming
from tests.plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

SPRING = EffectTerm(spring.EFFECT)
LOAD = EffectTerm(load_dependent.EFFECT, (1e-3,))
DELAY = EffectTerm(measurement_delay.EFFECT, (0.0,))
BACK_EMF = EffectTerm(back_emf.EFFECT)


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    return prepared_logs(PENDULUM, tmp_path_factory.mktemp("layout"), 1)


def test_every_parameter_has_one_place(logs):
    terms = (SPRING, LOAD)
    layout = layout_of(logs, INTEGRATED[0], terms)
    n = len(layout.names)
    places = [*range(len(layout.base)), *range(*layout.shape.indices(n))]
    for i in range(len(terms)):
        places += layout.of_term(i)
    assert sorted(places) == list(range(n))
    assert layout.names[layout.coefficients(0)] == tuple(
        f"0.{name}" for name in spring.EFFECT.coefficients
    )
    assert layout.names[layout.numbers(1)] == ("1.shape0",)
    assert layout.names[layout.shape] == tuple(f"law.{v}" for v in INTEGRATED[0].variables)
    assert layout.at("Fc") == layout.names.index("Fc")
    assert layout.at("nothing of the kind") is None


def test_a_fit_has_its_parameters_in_these_places(logs):
    found = refit(logs, (SPRING, LOAD), law_at(INTEGRATED[0], 0.02, 1e-05), steps=2)
    assert found.jacobian.shape == (len(found.residual), len(found.layout.names))
    assert found.bound.shape == (len(found.layout.names),)
    assert found.beta.shape == (found.layout.linear.stop,)
    assert found.names == found.layout.names[found.layout.linear]
    assert found.effects == found.terms[:-1]
    assert isinstance(found.terms[-1], DriveTiming)
    np.testing.assert_array_equal(
        found.term_coefficients(0), found.beta[found.layout.coefficients(0)]
    )


def test_the_jacobian_is_the_slope_of_the_model(logs):
    """By differences of the whole model, at two sizes that must agree."""
    from frictionjoint.identify.design import Balance

    # where a search begins, away from all bounds
    found = refit(logs, (SPRING, LOAD), law_at(forms_of("lugre")[0], 0.02, 1e-05), steps=1)
    balance = Balance(logs, found.shape, found.terms)
    first = found.layout.shape.start
    x = found.shape.vector()

    def left(k, h):
        moved = x.copy()
        moved[k] += h
        X, y = balance.columns(found.shape.moved(moved), found.terms)
        return X @ found.beta - y

    for k in range(len(x)):
        h = 1e-4
        slope = (left(k, h) - left(k, -h)) / (2.0 * h)
        own = found.jacobian[:, first + k]
        assert np.linalg.norm(own - slope) < 0.02 * np.linalg.norm(slope) + 1e-9


def test_of_a_voltage_viscous_friction_is_told_only_where_the_motor_is_let_go(logs):
    volts = replace(logs, drive="voltage")
    shape = replace(INTEGRATED[0], damped=True)
    assert layout_of(logs, INTEGRATED[0], ()).base == ("sigma2", "Fc")
    assert layout_of(logs, shape, ()).base == ("sigma2", "Fc", "sigma1")
    assert layout_of(volts, shape, ()).base == ("load", "Fc")
    assert layout_of(volts, shape, (BACK_EMF,)).base == ("load", "Fc", "sigma1")
    let_go = replace(volts, let_go=True)
    assert layout_of(let_go, shape, (BACK_EMF,)).base == ("load", "sigma2", "Fc", "sigma1")
    assert layout_of(replace(logs, drive="current"), shape, ()).base == (
        "load", "sigma2", "Fc", "sigma1",
    )  # fmt: skip


def test_the_timing_of_a_log_is_always_allowed_for_once(logs):
    (timing,) = timed(logs, (), INTEGRATED[0])
    assert timing.sample == logs.segments[0].sample
    assert timed(logs, (SPRING, timing), INTEGRATED[0]) == (SPRING, timing)
    assert timed(logs, (DELAY,), INTEGRATED[0]) == (DELAY,), "a delay found says when, too"


# The plants' controller holds its torque for a millisecond.
HALF_A_TICK, SIGMA2 = 0.5e-3, 0.1
# much inertia and little viscosity: what a delay makes of the one shows beside the other
HEAVY = PlantSpec(
    mass=3.0,
    length=0.3,
    inertia=0.3,
    armature=0.1,
    friction=Friction("lugre", Fs=0.6, Fc=0.5, Vs=0.1, sigma2=SIGMA2, presliding=2e-3),
    controller=Controller(kp=300.0, kd=15.0),
    motions=(Motion("sines", 3, 0.4, 4.0, 24.0), Motion("multisine", 4, 0.3, 4.0, 24.0)),
    instrument=Instrument(rate=500.0, counts=65536, torque_noise=0.01),
    seed=1,
)


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """A torque held between ticks acts half a tick later."""
    logs = prepared_logs(HEAVY, tmp_path_factory.mktemp("held"))
    return logs, fit(logs, forms=forms_of("lugre"))


def test_a_torque_held_between_ticks_is_allowed_for_and_told(held):
    logs, found = held
    cov = stated_covariance(logs, found)
    error = np.sqrt(cov[-1, -1])
    assert delay_of(found.terms) == pytest.approx(HALF_A_TICK, abs=3.0 * error)
    assert error < 0.2 * HALF_A_TICK
    (note,) = timing_note(found, cov)
    assert "torque leads" in note
    assert f"{1e3 * delay_of(found.terms):.2g} ±" in note


def test_the_viscosity_is_not_that_of_an_inertia_that_lags(held):
    logs, found = held
    at = found.layout.at("sigma2")
    error = float(np.sqrt(stated_covariance(logs, found)[at, at]))
    assert error < 0.15 * SIGMA2
    assert found.coefficient("sigma2") == pytest.approx(SIGMA2, abs=3.0 * error)


def test_a_delay_of_several_samples_is_more_than_timing(tmp_path):
    late = replace(HEAVY, effects=(Effect("measurement-delay", {"delay": 8e-3}),))
    logs = prepared_logs(late, tmp_path, 1)
    found = fit(logs, forms=forms_of("lugre"))
    assert delay_of(found.terms) == pytest.approx(logs.segments[0].sample, rel=0.01)
    better = fit(logs, (DELAY,), forms=forms_of("lugre"))
    assert delay_of(better.terms) == pytest.approx(8e-3 + HALF_A_TICK, abs=3e-4)
    assert better.rms < 0.7 * found.rms
