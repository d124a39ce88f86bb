"""Effects whose own size the logs do not determine are not named."""

from types import SimpleNamespace

import numpy as np
import pytest

from frictionjoint.diagnose.determined import standard_errors, undetermined
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import COMMAND_DELAY, GAIN_ERROR
from frictionjoint.effects.gear import BACKLASH
from frictionjoint.effects.temperature_dependent import EFFECT as FALLING
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import term_estimates
from frictionjoint.identify.search import refit
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from frictionjoint.report.numbers import size_of
from tests.three_sines import INERTIA, A, Q, T, V, logged

TERMS = {e.name: EffectTerm(e) for e in CATALOGUE}
SPRING, BIAS, GAIN = (TERMS[name] for name in ("spring", "torque-bias", "torque-gain"))


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    """A spring of 3 N m/rad and no bias."""
    rng = np.random.default_rng(5)
    friction = np.sign(V) * np.minimum(np.abs(V) / 0.02, 1.0)
    torque = INERTIA * A + friction + 3.0 * Q + rng.normal(0.0, 0.05, len(T))
    return logged(tmp_path_factory.mktemp("model"), torque)


def test_of_several_effects_the_one_with_no_size_is_told(prepared):
    alone = fit(prepared, (SPRING,))
    both = refit(prepared, (SPRING, BIAS), alone.shape)
    assert [term.name for term in undetermined(prepared, both)] == [BIAS.name]
    assert not undetermined(prepared, alone)


SIZES = [
    (DriveTerm(COMMAND_DELAY, (84e-6,)), 4.7e-3, 0.018),
    (DriveTerm(GAIN_ERROR, (1.25,)), 0.6, 0.417),
    (EffectTerm(BACKLASH, (1e-6, 6.0, 0.3, 0.03)), 2e-5, 0.05),  # next to a certain resonance
]


@pytest.mark.parametrize(("term", "error", "expected"), SIZES)
def test_what_has_no_size_of_its_own_is_far_by_a_number(term, error, expected):
    layout = SimpleNamespace(coefficients=lambda i: slice(3, 3))
    layout.numbers = lambda i: slice(4, 4 + len(term.shape))
    fitted = SimpleNamespace(terms=(term,), layout=layout)
    for variance, far in ((error**2, expected), (np.inf, 0.0)):
        found = standard_errors(fitted, np.diag([0.0] * 4 + [variance] + [1e-6] * 3), 0)
        assert found == pytest.approx(far, rel=0.01)


def test_a_slow_change_is_stated_by_what_the_logs_determine(tmp_path):
    """Over a rise of 3 K they determine only the level over the scale: its fall per kelvin."""
    warm = 25.0 + 3.0 * T / T[-1]
    friction = (2.0 - 0.07 * (warm - 28.0)) * np.clip(V / 0.02, -1.0, 1.0)
    noise = np.random.default_rng(5).normal(0.0, 0.05, len(T))
    log = logged(tmp_path, INERTIA * A + friction + noise, temperature=warm)
    fitted = fit(log, (EffectTerm(FALLING, (28.0, 300.0)),))
    found = term_estimates(fitted, stated_covariance(log, fitted), 0, slide=False)
    slope = found["slope"]
    assert (found["level"].is_loose, slope.unit) == (True, "N m/K")
    assert slope.value == pytest.approx(0.07, abs=3.0 * slope.stderr)
    assert slope.stderr < 0.1 * slope.value
    assert not undetermined(log, fitted)
    stated = "".join(size_of(FALLING.name, found, slide=False))
    assert "fall of Coulomb friction" in stated
    assert "that falls with temperature" not in stated


def test_a_motor_constant_that_leaves_no_load_in_the_torque_has_no_size():
    layout = SimpleNamespace(coefficients=lambda i: slice(0, 1))
    fitted = SimpleNamespace(terms=(GAIN,), layout=layout, beta=np.array([-0.998]))
    assert standard_errors(fitted, np.array([[0.065**2]]), 0) == pytest.approx(0.002 / 0.065)
