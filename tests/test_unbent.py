"""A law that bent for want of an effect: together with that it is fitted from everywhere."""

from dataclasses import replace

import numpy as np
import pytest
from trial_logs import PENDULUM, prepared_logs

from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.moves import look
from frictionjoint.diagnose.other_laws import OtherLaws, forms_like
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import compared
from frictionjoint.diagnose.unbent import bends, candidates_to_refit_jointly, unbent
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.shape import INTEGRATED
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import EffectTerm
from tests.plants.spec import Effect, Motion

EFFECTS = {effect.name: effect for effect in CATALOGUE}
LAG = EffectTerm(EFFECTS["frictional-lag"], (0.03, 0.15, 1e-3))
FRICTION = replace(PENDULUM.friction, Fs=1.6 * PENDULUM.friction.Fc, Vs=0.12)


def test_a_law_that_bent_is_left(tmp_path):
    hidden = Effect("frictional-lag", {"tau": 0.04})
    motions = tuple(
        Motion(kind, seed, 0.8, 0.8, 12.0) for kind, seed in (("sines", 1), ("multisine", 2))
    )
    plant = replace(PENDULUM, friction=FRICTION, effects=(hidden,), motions=motions)
    prepared = prepared_logs(plant, tmp_path)
    alone = fit(prepared)
    bent = replace(alone.shape, Vs=0.01, delta=3.0, length=0.02, excess=0.02)
    stuck = compared(prepared, (LAG,), bent)
    free = unbent(prepared, (LAG,), [INTEGRATED])
    assert free.drive_rms < 0.95 * stuck.drive_rms
    assert free.drive_rms < 0.7 * alone.drive_rms
    (term,) = free.effects
    assert term.shape[0] == pytest.approx(0.04, rel=0.1)
    chosen = unbent(prepared, (LAG,), [forms_of("static"), forms_of("lugre")])
    assert chosen.shape.variables == forms_of("lugre")[0].variables
    assert chosen.drive_rms < 0.7 * alone.drive_rms


def test_what_acts_on_the_friction_level_or_on_speed_bends_a_law():
    assert bends(LAG)
    assert bends(EffectTerm(EFFECTS["nonlinear-viscous"], (0.5,)))
    assert not bends(EffectTerm(EFFECTS["torque-bias"]))


@pytest.mark.parametrize("hidden", [(), (Effect("torque-bias", {"bias": 0.45}),)])
def test_what_explains_more_where_nothing_has_bent_the_law_is_tried_from_everywhere(
    tmp_path, hidden
):
    prepared = prepared_logs(replace(PENDULUM, effects=hidden), tmp_path)
    alone = fit(prepared)
    blocks = make_blocks(prepared, alone)
    candidates = library(prepared, alone, blocks)
    seen, _ = look(alone, blocks, candidates, np.random.default_rng(0))
    # as if the law had bent so that the offset does not show
    unseen = seen._replace(rows=tuple(r._replace(p_value=1.0) for r in seen.rows))
    laws = OtherLaws(prepared, alone)
    tried = candidates_to_refit_jointly(scored(alone, blocks), unseen, prepared, laws)
    names = [move.added[0].term.name for move, _ in tried]
    assert ("torque-bias" in names) == bool(hidden)
    assert all(forms == [forms_like(alone.shape)] for _, forms in tried)
