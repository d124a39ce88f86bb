"""Effects that a model predicts as well without."""

from functools import partial

from frictionjoint.diagnose.blocks import make_blocks
from frictionjoint.diagnose.library import comes_first
from frictionjoint.diagnose.score import scored
from frictionjoint.diagnose.state import State, needed, without
from frictionjoint.identify.weights import reweighed
from frictionjoint.threads import side_by_side


def drop_idle(state: State) -> None:
    """Leave out, one after the other, what the model predicts as well without."""
    while state.fit.effects:
        blocks = make_blocks(state.prepared, state.fit)
        now = scored(state.fit, blocks)
        with side_by_side() as each:
            others = list(each(partial(without, state), state.fit.effects))
        scores = [scored(other, blocks) for other in others]
        pairs = zip(state.fit.effects, scores, strict=True)
        idle = [(now.gain(s), s.fit) for t, s in pairs if not needed(now, s, comes_first(t))]
        if not idle:
            return
        state.prepared, state.fit = reweighed(state.prepared, min(idle, key=lambda x: x[0])[1])
