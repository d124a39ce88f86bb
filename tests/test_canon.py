"""Key cells of the canon, quick ones."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "scripts"))
import canon

INTEGRATED = ("integrated 1997", "integrated 2002")


@pytest.mark.parametrize("name", INTEGRATED)
@pytest.mark.parametrize("experiment", ["drift", "memory", "steady sliding", "lag", "energy"])
def test_the_integrated_law_passes(name, experiment):
    value, passes = canon.EXPERIMENTS[experiment](canon.LAWS[name], 1e-3)
    assert passes, value


@pytest.mark.parametrize(
    ("name", "experiment"),
    [
        ("lugre", "drift"),
        ("lugre", "memory"),
        ("dahl", "drift"),
        ("dahl", "memory"),
        ("dahl", "steady sliding"),
        ("static", "drift"),
        ("static", "lag"),
    ],
)
def test_what_simpler_laws_are_known_to_lack(name, experiment):
    value, passes = canon.EXPERIMENTS[experiment](canon.LAWS[name], 1e-3)
    assert not passes, value


@pytest.mark.parametrize("experiment", ["drift", "memory"])
def test_elastoplastic_and_maxwell_slip_do_not_drift(experiment):
    for name in ("elastoplastic", "maxwell_slip"):
        value, passes = canon.EXPERIMENTS[experiment](canon.LAWS[name], 1e-3)
        assert passes, (name, value)


def test_every_law_of_the_package_is_judged():
    from frictionjoint.rivals import RIVALS

    assert {type(p) for p in canon.LAWS.values()} >= set(RIVALS)
