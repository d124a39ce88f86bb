"""How small an effect may be: no law is exact, unless hardly anything remains beside it."""

import numpy as np
import pytest

from frictionjoint.diagnose.decisions import DISCREPANCY
from frictionjoint.diagnose.score import Scored
from frictionjoint.diagnose.state import needed
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.starts import fit
from tests.three_sines import INERTIA, A, T, V, logged

# squares come in blocks, each a little larger or smaller
BLOCKS = 1.0 + 0.1 * np.sin(np.arange(40.0))


@pytest.fixture(scope="module")
def base(tmp_path_factory) -> Fit:
    rng = np.random.default_rng(5)
    torque = INERTIA * A + 0.5 * np.clip(V / 0.02, -1.0, 1.0) + rng.normal(0.0, 0.01, len(T))
    return fit(logged(tmp_path_factory.mktemp("model"), torque))


def models(base: Fit, over_friction: float, left: float) -> tuple[Scored, Scored]:
    """A model and one without an effect of some torque over the friction's; squares it leaves."""
    friction = float(np.sum((base.friction * base.weight) ** 2)) / base.scale**2
    without = over_friction**2 * friction / (1.0 - left) * BLOCKS / BLOCKS.sum()
    return Scored(base, left * without), Scored(base, without)


@pytest.mark.parametrize(
    ("over_friction", "left", "needs"),
    [(2.0, 0.5, True), (0.5, 0.5, False), (0.5, 0.05, True), (2.0, 0.8, False), (0.5, 0.15, False)],
    ids=[
        "as large as what remains",
        "no larger than a law's error",
        "hardly anything remains",
        "most remains",
        "a little remains",
    ],
)
def test_an_effect_is_larger_than_the_laws_error(base, over_friction, left, needs):
    now, without = models(base, over_friction * DISCREPANCY, left)
    assert now.moved(without) == pytest.approx(over_friction * DISCREPANCY)
    assert needed(now, without) == needs
