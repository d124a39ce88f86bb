"""Threads: one for linear algebra, several for the points of a search, and the same numbers."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info
from trial_logs import PENDULUM, prepared_logs

from frictionjoint import threads as workers
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
from frictionjoint.threads import one_thread

FORMS = (*INTEGRATED[:2], *forms_of("lugre"))


@pytest.fixture(scope="module")
def prepared(tmp_path_factory) -> Prepared:
    return prepared_logs(PENDULUM, tmp_path_factory.mktemp("pendulum"))


def test_linear_algebra_takes_one_thread_and_gives_the_others_back(prepared):
    def blas():
        return [x["num_threads"] for x in threadpool_info() if x["user_api"] == "blas"]

    before = blas()
    assert one_thread(blas)() == [1] * len(before)
    seen = []
    fit(prepared, progress=lambda _: seen.append(blas()), forms=FORMS[:1])
    assert seen
    assert all(threads == [1] * len(before) for threads in seen)
    assert blas() == before


def test_any_number_of_threads_gives_the_same_fit(prepared, monkeypatch):
    found = []
    for threads in (1, 2, 7):
        monkeypatch.setattr(workers, "_allowed", threads)
        found.append(fit(prepared, forms=FORMS))
    alone, *others = found
    for other in others:
        assert other.shape == alone.shape
        np.testing.assert_array_equal(other.beta, alone.beta)
        np.testing.assert_array_equal(other.jacobian, alone.jacobian)
