"""Several logs as one: the same columns, targets and derivatives as of each alone, in few calls."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from law_shapes import law_at
from servo_plant import KNOWN, PLANT, servo, sines, steps, swept

from frictionjoint import threads as workers
from frictionjoint.effects import command_rate, deadband, load_dependent, spring
from frictionjoint.identify.constraint_shape import ConstraintShape
from frictionjoint.identify.design import Balance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of, start_of
from frictionjoint.identify.search import Search, timed
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from frictionjoint.law.names import LAWS
from frictionjoint.rivals import StaticParameters

SPRING = EffectTerm(spring.EFFECT)
LOAD = EffectTerm(load_dependent.EFFECT, (1e-3,))
# the second one's numbers are no count of the encoder: which side of it an error is on is certain
DRIVE = (DriveTerm(command_rate.EFFECT, (2.5,)), DriveTerm(deadband.EFFECT, (0.0301,)))
SHAPES = {law: forms_of(law)[0] for law in LAWS}
SHAPES |= {"integrated, n = 4": INTEGRATED[4]}
SHAPES |= {"of MuJoCo": ConstraintShape(start_of(StaticParameters))}


@pytest.fixture(scope="module")
def logs() -> Prepared:
    """Of several lengths, two of them equally long; some began with what friction held."""
    made = [
        servo(f"{motion.__name__} {kp}", kp, motion, {}, duration)
        for motion, kp, duration in (
            (steps, 0.8, 4.0),
            (sines, 0.8, 3.0),
            (swept, 3.0, 4.0),
            (sines, 3.0, 5.3),
        )
    ]
    found = prepare(made, RigidBody(PLANT.format(""), "j"), controller=KNOWN)
    held = zip(found.segments, (0.4, 0.0, -1.2, 0.0), strict=True)
    return replace(found, segments=tuple(replace(s, held=x) for s, x in held))


def search(logs, terms, shape):
    found = Search(logs, timed(logs, terms, shape), shape)
    return found, found.vector(law_at(shape, 0.02 * found.vmax, 1e-3 * found.balance.span))


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("name", SHAPES)
def test_logs_together_are_what_they_are_alone(name, threads, logs, monkeypatch):
    monkeypatch.setattr(workers, "_allowed", threads)
    for terms in ((), (SPRING, LOAD), DRIVE):
        whole, x = search(logs, terms, SHAPES[name])
        law, moved = whole.split(x)
        X, y, beta, *_ = whole.solved(x)
        moves = whole.balance.moves(law, moved, beta)
        rows = np.cumsum([0, *(int(s.kept.sum()) for s in logs.segments)])
        for i, (first, end) in enumerate(itertools.pairwise(rows)):
            alone = Balance(logs.subset([i]), law, moved)
            alone.span = whole.balance.span
            own, target = alone.columns(law, moved, beta)
            np.testing.assert_allclose(X[first:end], own, rtol=0, atol=1e-12 * np.abs(X).max())
            np.testing.assert_allclose(y[first:end], target, rtol=0, atol=1e-12 * np.abs(y).max())
            its = alone.moves(law, moved, beta)
            np.testing.assert_allclose(moves[first:end], its, rtol=0, atol=1e-9 * np.abs(its).max())
