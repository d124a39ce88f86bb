"""What was made of logs is made once: who asks again gets the same numbers, and no stale ones."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.kernel import columns
from frictionjoint.effects.signals import DT, MOTOR, N_SIGNALS, RATE, H
from frictionjoint.identify.cache import Cache
from frictionjoint.identify.design import Balance
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import EffectTerm

FIXED = [e for e in CATALOGUE if not (EffectTerm(e).follows_law or e.on_motor or e.delays)]


def test_the_latest_stay_as_far_as_there_is_room():
    known, made = Cache(100 * 8), []

    def make(k):
        made.append(k)
        return np.full(40, float(k))

    for k in (1, 2, 1, 3, 1, 2):  # room for two
        assert known.get(k, lambda k=k: make(k))[0] == k
    assert made == [1, 2, 3, 2]
    assert pickle.loads(pickle.dumps(known)).get(1, lambda: make(7))[0] == 7


@pytest.mark.parametrize("effect", FIXED, ids=lambda e: f"{e.name}-{e.effect_id}")
def test_columns_that_are_remembered_without_a_law_know_nothing_of_it(effect):
    rng = np.random.default_rng(0)
    signals = rng.normal(size=(50, N_SIGNALS))
    signals[:, DT] = np.where(np.arange(50) > 0, 0.01, 0.0)
    other = signals.copy()
    other[:, [H, RATE, MOTOR]] += 1.0
    shape = (0.5,) * len(effect.shape)
    made, again = (columns(effect.effect_id, shape, len(effect.coefficients), x)
                   for x in (signals, other))  # fmt: skip
    np.testing.assert_array_equal(made, again)


def test_logs_with_other_weights_share_it_and_logs_that_begin_otherwise_do_not(tmp_path):
    logs = prepared_logs(PENDULUM, tmp_path, 1)
    law = INTEGRATED[0]
    X, _ = Balance(logs, law, ()).columns(law, ())
    half = logs.weighed([np.full(len(s.drive), 0.5) for s in logs.segments])
    assert half.weight == pytest.approx(0.5)
    assert half.bundles(1) is logs.bundles(1)
    begun = replace(logs, segments=tuple(replace(s, held=0.5) for s in logs.segments))
    Y, _ = Balance(begun, law, ()).columns(law, ())
    assert not np.array_equal(X, Y)
