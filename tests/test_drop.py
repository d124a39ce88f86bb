"""Which effects a model keeps: by what they explain beside each other, and together."""

from types import SimpleNamespace

import pytest

from frictionjoint.diagnose import drop
from frictionjoint.diagnose.decisions import DRIVE_DISCREPANCY
from frictionjoint.effects.catalogue import CATALOGUE, DRIVE_EFFECTS
from frictionjoint.identify.terms import DriveTerm, EffectTerm
from tests.leaving import leaving, model

TERMS = {
    name: EffectTerm(next(e for e in CATALOGUE if e.name == name))
    for name in ("motor-saturation", "spring", "torque-bias")
}
DROP = next(e for e in DRIVE_EFFECTS if e.name == "duty-drop")
TERMS[DROP.name] = DriveTerm(DROP, (0.1, 0.5))


def kept(monkeypatch, left: dict[str, float], drive: float = 1.0) -> set[str]:
    """Names that stay of a model with all the effects in `left`.

    Args:
        left: fraction of the squares that models leave, by initials of their effects.
        drive: see `model`.
    """

    def scored(fit, blocks):
        return leaving(fit, left["".join(sorted(t.name[0] for t in fit.effects))])

    monkeypatch.setattr(drop, "scored", scored)
    monkeypatch.setattr(drop, "with_fewer", lambda state, terms: model(terms, drive))
    monkeypatch.setattr(drop, "reweighed", lambda prepared, fit: (prepared, fit))
    all_ones = tuple(t for t in TERMS.values() if t.name[0] in max(left, key=len))
    state = SimpleNamespace(prepared=None, fit=model(all_ones, drive), either_way=(None,))
    drop.drop_idle(state)
    return {t.name for t in state.fit.effects}


@pytest.mark.parametrize(
    ("left", "expected"),
    [
        # each of its own
        ({"": 1.0, "m": 0.5, "s": 0.5, "ms": 0.1}, {"motor-saturation", "spring"}),
        # either explains all of it
        ({"": 1.0, "m": 0.3, "s": 0.32, "ms": 0.29}, {"motor-saturation"}),
        # a little each
        ({"": 1.0, "m": 0.9, "s": 0.9, "ms": 0.8}, set()),
    ],
)
def test_what_explains_nothing_beside_the_rest_goes(monkeypatch, left, expected):
    assert kept(monkeypatch, left) == expected


def test_small_losses_do_not_add_up(monkeypatch):
    """Two that come in together, for neither explains enough alone: not both go again."""
    left = {"": 1.0, "m": 0.7, "s": 0.9, "ms": 0.56}
    assert kept(monkeypatch, left) == {"motor-saturation"}
    three = {"": 1.0, "m": 0.9, "s": 0.88, "t": 0.86, "ms": 0.75, "mt": 0.74, "st": 0.73}
    assert kept(monkeypatch, three | {"mst": 0.6}) == {"torque-bias"}


@pytest.mark.parametrize(("times", "expected"), [(1.2, {"duty-drop", "spring"}), (0.8, {"spring"})])
def test_an_effect_of_the_drive_stays_for_what_it_moves_of_the_drive(monkeypatch, times, expected):
    """However much of what is left: beside a better law less of it may be left to explain."""
    left = {"": 1.0, "d": 0.5, "s": 0.2, "ds": 0.04}
    moved = (left["s"] - left["ds"]) ** 0.5
    assert kept(monkeypatch, left, moved / DRIVE_DISCREPANCY / times) == expected
