"""How closely a change of the model is fitted before it is compared."""

from types import SimpleNamespace

import pytest

from frictionjoint.diagnose import trace
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.search import CLOSE, ROUGH
from frictionjoint.identify.terms import EffectTerm

TERMS = {e.name: EffectTerm(e) for e in CATALOGUE}


@pytest.mark.parametrize(
    ("names", "closeness"),
    [
        (("backlash",), ROUGH),
        (("spring", "inertia-error"), ROUGH),
        (("backlash", "measurement-delay"), CLOSE),
    ],
)
def test_a_pair_with_an_impact_is_fitted_to_its_end(monkeypatch, names, closeness):
    """Derivatives leave four times the squares that a pair of backlash and delay may have."""
    asked = []
    monkeypatch.setattr(trace, "compared", lambda *how: asked.append(how[-1]))
    added = tuple(SimpleNamespace(term=TERMS[name], begun=None) for name in names)
    move = SimpleNamespace(added=added, terms=tuple(c.term for c in added))
    trace._compared(None, SimpleNamespace(shape=None), move)
    assert asked == [closeness]
