"""When the joint fit of shared causes and laws ends."""

from types import SimpleNamespace

from frictionjoint.robot import settle
from frictionjoint.robot.settle import Settled


def joint(rms: float, left: float) -> SimpleNamespace:
    found = SimpleNamespace(rms=rms, left=left)
    found.corrected = lambda state: found
    return found


def test_it_ends_by_the_weighted_residual_that_it_reduces(monkeypatch):
    """The other one, which samples at rest rule, may rise while a mass comes to its value."""
    found = SimpleNamespace(causes=("payload",), state=None, steps=0)
    monkeypatch.setattr(settle, "Clock", lambda joints: None)
    monkeypatch.setattr(
        settle,
        "fitted_causes",
        lambda now, clock, found, own: SimpleNamespace(**vars(found) | {"steps": found.steps + 1}),
    )
    trials = iter([joint(0.3, 0.1), joint(0.31, 0.08), joint(0.31, 0.08)])
    monkeypatch.setattr(Settled, "_fitted_again", lambda self, joints, how: (next(trials),))
    assert Settled(found, (joint(1.0, 1.0),), None, map).refitted().found.steps == 2
