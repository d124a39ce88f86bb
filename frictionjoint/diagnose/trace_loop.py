"""dev"""
from collections.abc import Callable
from dataclasses import dataclass, replace
import numpy as np
from frictionjoint.diagnose.blocks import Blocks, make_blocks
from frictionjoint.diagnose.library import library
from frictionjoint.diagnose.moves import Look, Looked, Move, is_unnamed, look, moves
from frictionjoint.diagnose.score import Scored, scored
from frictionjoint.identify.fit import CLOSE, ROUGH, Fit, refit
from frictionjoint.identify.prepare import Prepared
from frictionjoint.identify.rival_shape import forms_of, prompt_maxwell_slip
from frictionjoint.identify.shape import Shape
from frictionjoint.identify.start import settled
from frictionjoint.identify.starts import fit
from frictionjoint.identify.terms import Term
from frictionjoint.identify.weights import weighted
from frictionjoint.parameters import FrictionParameters

SIGNIFICANCE = 0.05
SMALLEST_GAIN = 0.08
CLEARLY = 0.95
CLOSE_TO_BEST = 0.1
ENOUGH = 0.9
MOST_STEPS = 8
OTHERS = (*prompt_maxwell_slip(), *forms_of("lugre"), *forms_of("elastoplastic"))

@dataclass
class Step:
    term: Term
    row: Looked
    gain: float
    ties: tuple
    runner_up: str | None

def reweighed(prepared, fitted, closeness=CLOSE):
    prepared = weighted(prepared, fitted)
    return prepared, refit(prepared, fitted.terms, fitted.shape, closeness)

def trace(prepared, seed=0, progress=lambda t: None, law=None, log=None):
    say = log or (lambda *a: None)
    rng = np.random.default_rng(seed)
    forms = forms_of(law or FrictionParameters.law)
    base = fit(prepared, forms=forms)
    prepared, base = reweighed(prepared, base)
    prepared, base = settled(prepared, base)
    prepared, base = reweighed(prepared, base)
    say("base", base.rms, base.drive_rms)
    current = base
    pool = {}
    for form_set in (prompt_maxwell_slip(), forms_of("lugre"), forms_of("elastoplastic")):
        other = fit(prepared, (), form_set)
        pool[other.shape.variables] = other.shape
        say("   other law", type(other.shape).__name__, other.shape.variables[-1], other.drive_rms)
        if other.drive_rms < CLEARLY * current.drive_rms:
            current = other
    pool[base.shape.variables] = base.shape
    if current is not base:
        prepared, current = reweighed(prepared, current)
    steps = []
    while len(steps) < MOST_STEPS:
        blocks = make_blocks(prepared, current)
        candidates = library(prepared, current, blocks)
        found, screened = look(current, blocks, candidates, rng)
        say(f"step {len(steps)+1}: rms {current.rms:.4g} weighted {current.drive_rms:.4g} law {current.shape.variables[-1]} blocks {blocks.count}")
        for r in found.rows[:7]:
            say(f"      {r.name:24s} {r.candidate.kind[1]:14s} gain {found.gain(r):.3f} p {r.p_value:.3f} freq {r.frequency:.2f} {r.candidate.term.shape}")
        now = scored(current, blocks)
        tried = []
        for m in moves(current, found, screened, candidates):
            f = refit(prepared, m.terms, current.shape, ROUGH)
            tried.append((m, scored(f, blocks)))
        chosen = choose(now, tried, found, say)
        if chosen is None:
            # another law
            better = None
            for shape in pool.values():
                if shape.variables == current.shape.variables: continue
                f = refit(prepared, current.terms, shape, ROUGH)
                if f.drive_rms < CLEARLY * (better or current).drive_rms: better = f
            if better is not None:
                say("   law ->", better.shape.variables, better.drive_rms, current.drive_rms)
                prepared, current = reweighed(prepared, better)
                continue
            break
        m, s, ties, runner = chosen
        say("   ->", [t.name for t in m.terms], f"gain {s.gain(now):.3f} ties {ties}")
        for c in m.added:
            steps.append(Step(c.term, found.find(c), s.gain(now), ties, runner))
        prepared, current = reweighed(prepared, s.fit)
        prepared, current = dropped(prepared, current, say)
        steps = [st for st in steps if any(t.name == st.term.name for t in current.effects)]
    # curves away
    named = tuple(t for t in current.effects if not is_unnamed(t))
    unexplained = {}
    blocks = make_blocks(prepared, current)
    for t in current.effects:
        if is_unnamed(t):
            rest = tuple(x for x in current.effects if x is not t)
            w = scored(refit(prepared, rest, current.shape, ROUGH), blocks)
            unexplained[t.name] = max(unexplained.get(t.name, 0), scored(current, blocks).gain(w))
    final = current
    if len(named) < len(current.effects):
        prepared, final = reweighed(prepared, refit(prepared, named, current.shape))
        prepared, final = dropped(prepared, final, say)
    return prepared, base, steps, final, unexplained, found

def dropped(prepared, current, say):
    while current.effects:
        blocks = make_blocks(prepared, current)
        now = scored(current, blocks)
        worst = None
        for i, t in enumerate(current.effects):
            rest = current.effects[:i] + current.effects[i+1:]
            f = scored(refit(prepared, rest, current.shape, ROUGH), blocks)
            g = now.gain(f)
            if not now.better(f) or g < SMALLEST_GAIN:
                if worst is None or g < worst[0]: worst = (g, t, f)
        if worst is None: break
        say("   drop", worst[1].name, worst[0])
        prepared, current = reweighed(prepared, worst[2].fit)
    return prepared, current

def numbers(term):
    return len(term.coefficients) + len(term.shape)

def choose(now, tried, found, say):
    ok = []
    for m, s in tried:
        gain = s.gain(now)
        rows = [found.find(c) for c in m.added]
        p = max((r.p_value for r in rows), default=0)
        good = s.better(now) and gain >= SMALLEST_GAIN
        if len(m.added) == 1: good = good and p <= SIGNIFICANCE
        else: good = good and min(r.p_value for r in rows) <= SIGNIFICANCE
        say(f"        try {[t.name for t in m.terms]} gain {gain:.3f} ok {good}")
        if good: ok.append((m, s))
    if not ok: return None
    named = [x for x in ok if not x[0].unnamed]
    unnamed = [x for x in ok if x[0].unnamed]
    singles = [x for x in named if len(x[0].terms) <= len(now.fit.effects) + 1]
    pairs = [x for x in named if len(x[0].terms) == len(now.fit.effects) + 2]
    best = min(singles, key=lambda x: x[1].total, default=None)
    if pairs:
        pair = min(pairs, key=lambda x: x[1].total)
        if best is None or (pair[1].better(best[1]) and pair[1].gain(best[1]) > 0.3): best = pair
    if unnamed:
        curve = min(unnamed, key=lambda x: x[1].total)
        if best is None or (curve[1].better(best[1]) and best[1].gain(now) < ENOUGH * curve[1].gain(now)):
            return curve[0], curve[1], (), None
    if best is None: return None
    gain = best[1].gain(now)
    near = [x for x in singles if len(best[0].added) == 1 and len(x[0].terms) == len(best[0].terms)
            and (x is best or (not best[1].better(x[1]) and x[1].gain(now) >= (1 - CLOSE_TO_BEST) * gain))]
    if near:
        winner = min(near, key=lambda x: numbers(x[0].added[0].term))
        ties = tuple(x[0].added[0].term.name for x in near if x is not winner)
    else:
        winner, ties = best, ()
    runner = next((r.name for r in found.rows if not r.candidate.unnamed and r.name not in {c.term.name for c in winner[0].added}), None)
    return winner[0], winner[1], ties, runner
