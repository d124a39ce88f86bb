"""An early choice is looked at again: a rival that explains more takes its place, no other does."""

from dataclasses import replace

import numpy as np
import pytest
from plants.draw import draw_trial
from plants.spec import Effect
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.choice import Choice, choose
from frictionjoint.diagnose.ranking import rank_all
from frictionjoint.diagnose.revision import exchanged, reconsidered
from frictionjoint.diagnose.step import step_of
from frictionjoint.identify.fit import fit
from frictionjoint.identify.rest import resolved
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.start import settled

# shares of what is left that the next addition would take away
LITTLE, NEARLY_ALL = 0.1, 0.99


def first_look(effect, folder):
    """Logs of a plant that has `effect`, the fit of the law alone, and what explains its rest."""
    logs = prepared_logs(replace(PENDULUM, effects=(effect,)), folder)
    rng = np.random.default_rng(0)
    alone = fit(logs)
    return logs, alone, rank_all(logs, alone, rng), rng


def looked_again(effect, folder, taken, rival, gain):
    """What is made of `taken`, chosen on a plant that has `effect`, beside a rival of it."""
    logs, alone, ranking, rng = first_look(effect, folder)
    rows = {r.name: r for r in ranking.ranked if not r.candidate.smooth}
    current = fit(logs, (rows[taken].candidate.term,), start=alone.shape)
    choice = Choice(rows[taken], rivals=(rows[rival],))
    steps = [step_of(choice, current, ranking, rng)]
    return current, exchanged(logs, current, steps, gain, rng)


@pytest.fixture
def hanging(tmp_path):
    """A mass that hangs to one side, which a bias explains in part."""
    effect = Effect("gravity-error", {"mass": 0.15, "angle": 1.2})
    return lambda gain: looked_again(effect, tmp_path, "torque-bias", "gravity-error", gain)


def test_a_rival_that_explains_as_much_as_an_addition_takes_the_place(hanging):
    current, found = hanging(LITTLE)
    fitted, (step,) = found
    assert [t.name for t in fitted.terms] == ["gravity-error"]
    assert fitted.rms < current.rms
    assert step.term.name == "gravity-error"
    assert [r.name for r in step.rivals] == ["torque-bias"]


def test_an_addition_that_explains_more_than_the_rival_is_not_held_up(hanging):
    _, found = hanging(NEARLY_ALL)
    assert found is None


def test_beside_a_curve_of_its_quantity_an_effect_does_not_give_way_to_a_lesser_one(tmp_path):
    # a curve in the position takes over what gravity stands for, and a bias does for the rest
    logs = prepared_logs(draw_trial(np.random.default_rng(108194), "one"), tmp_path, 3)
    logs, alone = resolved(*settled(logs, fit(logs)), INTEGRATED)
    rng = np.random.default_rng(0)
    current, steps = alone, []
    for name, kind in (("gravity-error", "EffectTerm"), ("position", "SplineTerm")):
        ranking = rank_all(logs, current, rng)
        rows = {(r.name, r.candidate.kind): r for r in ranking.ranked}
        row = rows[name, kind]
        start = current.shape if steps else None
        current = fit(logs, (*current.terms, row.candidate.term), start=start)
        steps.append(step_of(Choice(row), current, ranking, rng))
    _, kept = reconsidered(logs, current, steps, 1, rng)
    assert kept[0].term.name == "gravity-error"


def test_what_explained_nearly_as_much_stays_a_rival_though_chance_does_not_make_the_gap(tmp_path):
    _, alone, ranking, rng = first_look(Effect("torque-bias", {"bias": 0.2}), tmp_path)
    rows = list(ranking.ranked)
    second = next(r for r in rows if r.name == "gravity-error")
    # a little less on every block
    first = rows[0]
    less = 0.03 * first.held_out_gain * ranking.base_squares
    gain = 0.97 * first.held_out_gain
    lesser = replace(second, held_out_gain=gain, squares=first.squares + less)
    rows[rows.index(second)] = lesser
    chosen = choose(replace(ranking, ranked=tuple(rows)), alone, rng)
    assert chosen.winner is first
    assert not chosen.ties
    assert lesser in chosen.rivals


def test_a_right_choice_stays(tmp_path):
    bias = Effect("torque-bias", {"bias": 0.2})
    _, found = looked_again(bias, tmp_path, "torque-bias", "gravity-error", LITTLE)
    assert found is None
