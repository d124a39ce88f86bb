"""Descents of a fit: where a number hardly shows, rounding does not move it."""

from dataclasses import replace

import numpy as np
import pytest
from law_shapes import law_at
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.score import scored
from frictionjoint.effects import direction_asymmetry, position_periodic
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.design import Balance
from frictionjoint.identify.search import CLOSE, ROUGH, Search, refit
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm
from frictionjoint.identify.tracks import Tracks


@pytest.fixture(scope="module")
def logs(tmp_path_factory) -> Prepared:
    return prepared_logs(PENDULUM, tmp_path_factory.mktemp("pendulum"), 1)


@pytest.mark.parametrize("closeness", [CLOSE, ROUGH])
@pytest.mark.parametrize("shown", [0.0, 1e-14, 1e-9])
def test_a_number_that_hardly_shows_stays_where_it_is(logs, monkeypatch, closeness, shown):
    """Where the first steps are too long, so that a trust region shortens them."""
    search = Search(logs, (), replace(INTEGRATED[0], excess=0.3, Vs=0.1 * logs.top_speed))
    start = search.start

    def left(x):
        seen = shown * (x[1] - start[1])
        return np.array([np.arctan(8.0 * (x[0] - 1.0)) + seen, 0.1 - 2.0 * seen, seen])

    def slopes(x):
        J = np.zeros((3, len(x)))
        J[0, 0] = 8.0 / (1.0 + (8.0 * (x[0] - 1.0)) ** 2)
        J[:, 1] = shown, -2.0 * shown, shown
        return J

    monkeypatch.setattr(search, "residual", left)
    monkeypatch.setattr(search, "derivative", slopes)
    found = search.run(start, 30, closeness).x
    assert found[0] == pytest.approx(1.0, abs=0.02)
    assert abs(found[1] - start[1]) < 0.1  # of its scale
    assert found[2:] == pytest.approx(start[2:])


def test_a_fit_that_stops_short_is_not_scored_by_where_it_might_have_come_to(logs):
    law = law_at(INTEGRATED[0], 0.02 * logs.top_speed, 1e-2 * logs.span)
    short, long = (refit(logs, (), law, ROUGH, steps) for steps in (1, 20))
    assert long.drive_rms < 0.9 * short.drive_rms
    for fitted in (short, long):
        left = float(np.sum((fitted.residual * fitted.weight) ** 2)) / fitted.error_unit**2
        assert scored(fitted, make_blocks(logs, fitted)).total == pytest.approx(left, rel=1e-6)


def test_a_wave_in_position_stays_one(logs):
    """From search to search it could else grow longer, until it is an offset and a spring."""
    fewest = 2.0 * np.pi / logs.usual_travel
    law = law_at(INTEGRATED[0], 0.02 * logs.top_speed, 1e-2 * logs.span)
    for waves in (1.05 * fewest, fewest):
        search = Search(logs, (EffectTerm(position_periodic.EFFECT, (waves,)),), law)
        place = list(search.start).index(pytest.approx(waves, rel=1e-5))
        assert search.bounds[0][place] == pytest.approx(fewest)
    # one that was longer already, as in a file of parameters, is not lengthened either
    longer = Search(logs, (EffectTerm(position_periodic.EFFECT, (0.5 * fewest,)),), law)
    assert min(longer.bounds[0]) <= longer.start[-1]
    assert longer.bounds[0][-1] == pytest.approx(0.5 * fewest)


def test_a_law_that_hardly_moves_the_torque_moves_nothing_that_follows_it(logs, monkeypatch):
    """A direction of 1e-320 asks for a step without end, and no torque is that times nothing."""
    law = law_at(INTEGRATED[0], 0.02 * logs.top_speed, 1e-2 * logs.span)
    terms = (EffectTerm(direction_asymmetry.EFFECT, (0.003,)),)
    fitted = refit(logs, terms, law, ROUGH)

    def hardly(self, shape, of_rate):
        track = self.along(shape)
        nothing = np.zeros((len(shape.variables), len(track[0])))
        return track, nothing + 1e-320, nothing if of_rate else None

    monkeypatch.setattr(Tracks, "tangents", hardly)
    moves = Balance(logs, fitted.shape, fitted.terms).moves(fitted.shape, fitted.terms, fitted.beta)
    assert np.isfinite(moves).all()
