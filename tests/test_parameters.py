"""Validation and packing of the law's parameters."""

import pytest

from frictionjoint.errors import ParameterError
from frictionjoint.parameters import FrictionParameters

GOOD = dict(Fs=5.0, Fc=3.0, Vs=0.01, knots=((1e-5, 4.0), (1e-4, 12.0)))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("Fs", 0.0),
        ("Fs", "1"),
        ("Fc", None),
        ("Fc", 5.1),
        ("Fc", 0.0),
        ("Vs", 0.0),
        ("delta", 0.0),
        ("delta", 11.0),
        ("sigma2", -1.0),
        ("sigma1", -1.0),
        ("n", 0.9),
        ("n", 1001.0),
        ("n", float("nan")),
        ("Vs", float("inf")),
        ("n", True),
        ("variant", "dahl"),
        ("virgin", "none"),
        ("knots", ()),
        ("knots", ((1e-5, 4.0), (1e-4, 9.0))),
        ("knots", ((1e-5, 1.0), (2e-5, 12.0))),
        ("knots", ((1e-5, 4.0), (1e-5, 12.0))),
        ("knots", (1.0, 2.0)),
    ],
)
def test_refused_by_name_in_one_line(name, value):
    with pytest.raises(ParameterError) as error:
        FrictionParameters.symmetric(**(GOOD | {name: value}))
    assert name in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("variant", ["ganseman1997", "lampaert2002"])
@pytest.mark.parametrize("virgin", ["literal", "masing"])
def test_packs_and_writes_both_ways(variant, virgin):
    p = FrictionParameters.symmetric(**GOOD, n=3.0, sigma1=2.0, variant=variant, virgin=virgin)
    assert FrictionParameters.unpack(p.pack()) == p
    assert FrictionParameters.from_dict(p.to_dict()) == p
    assert p.stiffness == pytest.approx(4e5)
    assert "<td>Fs_pos</td><td>5</td>" in p._repr_html_()


def test_unknown_key_and_damaged_block():
    p = FrictionParameters.symmetric(**GOOD)
    with pytest.raises(ParameterError, match="Fx"):
        FrictionParameters.from_dict(p.to_dict() | {"Fx": 1.0})
    with pytest.raises(ParameterError, match="damaged"):
        FrictionParameters.unpack(p.pack()[:-1])


@pytest.mark.parametrize("given", [{}, {"Fs_pos": 5.0, "Fs_neg": 5.0}])
def test_a_missing_argument_is_named_with_the_fix(given):
    with pytest.raises(ParameterError, match=r"missing parameter .*knots .*: add it"):
        FrictionParameters(**given)
