"""Two effects of one quantity are not lost behind a curve that takes what both explain."""

from dataclasses import replace

import numpy as np
from plants.spec import Effect
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.pairs import first_of_two
from frictionjoint.diagnose.ranking import rank_all
from frictionjoint.identify.fit import fit
from frictionjoint.identify.start import settled


def behind_the_curve(folder, *effects):
    """The best curve, and the effect that is preferred to it, by name."""
    logs = prepared_logs(replace(PENDULUM, effects=effects), folder)
    logs, alone = settled(logs, fit(logs))
    ranking = rank_all(logs, alone, np.random.default_rng(0))
    curve = next(r for r in ranking.ranked if r.candidate.smooth)
    first = first_of_two(logs, alone, ranking, curve)
    return curve.name, first and first.name


def test_a_stop_beside_a_bias_is_found_behind_a_curve(tmp_path):
    stop = Effect("end-stop", {"at": 0.2, "stiffness": 8.0})
    bias = Effect("torque-bias", {"bias": 0.5})
    curve, first = behind_the_curve(tmp_path, stop, bias)
    assert curve == "torque"
    assert first == "end-stop"


def test_what_no_two_effects_explain_stays_with_the_curve(tmp_path):
    contact = Effect("stick-slip-contact", {"level": 0.2, "reach": 0.1})
    _, first = behind_the_curve(tmp_path, contact)
    assert first is None
