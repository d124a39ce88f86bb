"""When the joint fit of shared causes and laws ends."""

from types import SimpleNamespace

import pytest

from frictionjoint.robot import settle
from frictionjoint.robot.settle import Settled


def joint(squares: float) -> SimpleNamespace:
    found = SimpleNamespace(rms=squares**0.5)
    found.corrected = lambda state: found
    return found


@pytest.mark.parametrize(("last", "steps"), [(0.9997, 2), (1.01, 1)])
def test_the_last_step_counts_unless_it_is_worse(monkeypatch, last, steps):
    """It hardly changes the residual of an arm, but the tilt of its base by 2%."""
    found = SimpleNamespace(causes=("tilt",), state=None, steps=0)
    monkeypatch.setattr(settle, "Clock", lambda joints: None)
    monkeypatch.setattr(
        settle,
        "descended",
        lambda now, clock, found, own: SimpleNamespace(**vars(found) | {"steps": found.steps + 1}),
    )
    left = iter((0.1, 0.1 * last))
    monkeypatch.setattr(Settled, "_fitted_again", lambda self, joints, how: (joint(next(left)),))
    assert Settled(found, (joint(1.0),), None, map).refitted().found.steps == steps
