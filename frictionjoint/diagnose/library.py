"""Candidates that these logs can test: effects, waves in position, unnamed dependences."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.decisions import LEAST_WARMING, SMALLEST_GAIN
from frictionjoint.diagnose.candidate import Candidate, columns_of, signals_of
from frictionjoint.diagnose.spectrum import (
    periodic_terms,
    short_waves,
    wave_terms,
    waves_like_curves,
)
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.effects.drive import DRIVE_EFFECTS
from frictionjoint.effects.effect import Effect
from frictionjoint.effects.signals import TEMP, parts_of_load
from frictionjoint.identify.basis import lengths, without
from frictionjoint.identify.blocks import Blocks
from frictionjoint.identify.early_checks import scale_is_determined
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.layout import term_bounds
from frictionjoint.identify.search import HEARD
from frictionjoint.identify.segment import Prepared
from frictionjoint.identify.smooth import (
    VARIABLES,
    EncoderTerm,
    ExcessTerm,
    HysteresisTerm,
    LogTerm,
    MissingTerm,
    SplineTerm,
    quantity,
)
from frictionjoint.identify.terms import (
    DriveTerm,
    DriveTiming,
    EffectTerm,
    TargetTiming,
    Term,
    swings_of,
)
from frictionjoint.threads import side_by_side


def library(prepared: Prepared, fitted: Fit, blocks: Blocks) -> list[Candidate]:
    """All candidates for a fit's residual."""
    signals = signals_of(prepared, fitted)
    grid = _of_known_size(prepared, fitted, effect_terms(prepared, signals, fitted.terms))
    grid += unnamed_terms(prepared, fitted, signals)
    waves = periodic_terms(prepared, signals, fitted, blocks), wave_terms(prepared, fitted)
    found = _with_waves(prepared, fitted, signals, blocks, grid, waves)
    return _beyond_itself(prepared, fitted, signals, found)


def _beyond_itself(
    prepared: Prepared, fitted: Fit, signals: list[Array], candidates: list[Candidate]
) -> list[Candidate]:
    """Candidates without a torque limit that explains no more than a scaled torque does.

    The residual contains the measured torque and correlates with it, whatever the model lacks.
    Torque that a drive did not deliver is missing only above the limit and is not proportional to
    the torque.
    """
    levels = [(c.term, c.columns) for c in candidates if isinstance(c.term, ExcessTerm)]
    if not levels:
        return candidates
    torque = columns_of(prepared, signals, replace(levels[0][0], at=0.0))
    columns = [*(x for _, x in levels), fitted.residual]
    known = [fitted.free_jacobian, fitted.begun, torque]
    U = np.column_stack([*columns, *known]) * fitted.weight[:, None]
    U /= lengths(U)
    *found, r = without(U[:, : len(columns)], U[:, len(columns) :]).T
    idle = {
        term
        for (term, _), x in zip(levels, found, strict=True)
        if (x @ r) ** 2 < SMALLEST_GAIN * (x @ x) * (r @ r)
    }
    return [c for c in candidates if c.term not in idle]


def effects(
    prepared: Prepared,
    fitted: Fit,
    blocks: Blocks,
    wanted: Callable[[Effect], bool] = lambda effect: True,
) -> list[Candidate]:
    """Candidates that are effects, all or some of them."""
    signals = signals_of(prepared, fitted)
    grid = _of_known_size(prepared, fitted, effect_terms(prepared, signals, fitted.terms, wanted))
    waves = periodic_terms(prepared, signals, fitted, blocks, wanted)
    return _with_waves(prepared, fitted, signals, blocks, grid, [waves])


def waves_in_position(prepared: Prepared, fitted: Fit, blocks: Blocks) -> list[Candidate]:
    """Candidates that are waves in position, however short."""
    signals = signals_of(prepared, fitted)
    terms, lines = periodic_terms(prepared, signals, fitted, blocks)
    return _candidates(prepared, fitted, signals, terms, [lines] * len(terms))


def _of_known_size(prepared: Prepared, fitted: Fit, terms: Sequence[Term]) -> list[Term]:
    """The terms, without inertia effects if the logs do not determine the torque scale.

    Without a scale, the size of an inertia effect would be arbitrary.
    """
    known = scale_is_determined(prepared, fitted)
    return [t for t in terms if known or not t.effect.of_inertia]


def _with_waves(
    prepared: Prepared,
    fitted: Fit,
    signals: list[Array],
    blocks: Blocks,
    grid: list[Term],
    waves: Iterable[tuple[list[Term], float]],
) -> list[Candidate]:
    """Candidates of a grid and the largest lines of spectra, each with the number of lines
    searched."""
    terms, among = list(grid), [1.0] * len(grid)
    for found, lines in waves:
        terms += found
        among += [lines] * len(found)
    made = _candidates(prepared, fitted, signals, terms, among)
    short = short_waves(prepared, made)
    if not short:
        return made
    curves = [c for c in made if isinstance(c.term, SplineTerm) and c.term.name == "position"]
    if not curves:  # where effects alone are wanted
        splines: list[Term] = _curves(prepared, signals, "position")
        curves = _candidates(prepared, fitted, signals, splines, [1.0] * len(splines))
    nearly = {id(c) for c in waves_like_curves(fitted, blocks, short, curves)}
    return [c for c in made if id(c) not in nearly]


def other_forms(prepared: Prepared, fitted: Fit, term: Term) -> list[Candidate]:
    """Other forms of the same effect, with the shape numbers they share."""
    if not isinstance(term, EffectTerm):
        return []
    signals = signals_of(prepared, fitted)
    own = term.effect
    known = dict(zip(own.shape, term.shape, strict=True))
    forms = [e for e in CATALOGUE if e.name == own.name and e.effect_id != own.effect_id]
    terms: dict[Term, None] = {}
    for t in _on_grid(prepared, forms, signals):
        named = zip(t.effect.shape, t.shape, strict=True)
        terms[replace(t, shape=tuple(known.get(name, x) for name, x in named))] = None
    return _candidates(prepared, fitted, signals, list(terms), [1.0] * len(terms))


def _candidates(
    prepared: Prepared, fitted: Fit, signals: list[Array], terms: list[Term], among: list[float]
) -> list[Candidate]:
    """Terms with their columns, without terms that contribute nothing in these logs."""
    with side_by_side() as each:
        columns = list(each(partial(columns_of, prepared, signals), terms))
    return [
        Candidate(
            term,
            x,
            tuple((lo * fitted.gain, hi * fitted.gain) for lo, hi in term_bounds(prepared, term)),
            lines,
            swings_of(prepared, term) if term.effect.free else None,
        )
        for term, x, lines in zip(terms, columns, among, strict=True)
        if np.all(np.isfinite(x)) and np.any(x)
    ]


def effect_terms(
    prepared: Prepared,
    signals: list[Array],
    taken: tuple[Term, ...],
    wanted: Callable[[Effect], bool] = lambda effect: True,
) -> list[EffectTerm]:
    """Every requested effect that the logs can test and the model lacks, on its grid of shapes."""
    names = {term.name for term in taken}
    # a second delay would be that of the torque's own noise
    timed = any(isinstance(t, DriveTiming | TargetTiming) and not t.at_its_end for t in taken)
    new = [e for e in CATALOGUE if e.name not in names and not (timed and e.delays)]
    return _on_grid(prepared, list(filter(wanted, new)), signals)


def _on_grid(prepared: Prepared, effects: list[Effect], signals: list[Array]) -> list[EffectTerm]:
    """Some effects on their grids, where the logs can test them."""
    everything = np.concatenate(signals)
    return [
        EffectTerm(effect, shape)
        for effect in effects
        if effect.proposed_by == "grid" and testable(prepared, effect, everything)
        for shape in effect.shapes(everything)
        if _in_band(prepared, effect, shape)
    ]


def drive_terms(prepared: Prepared, taken: tuple[Term, ...]) -> list[EffectTerm]:
    """Every effect of the drive, if the drive is computed by a controller from commands.

    So are delays of a measurement, which shift the drive as a whole.
    """
    if not prepared.commanded:
        return []
    names = {term.name for term in taken}
    logs = [s.commanded.commands for s in prepared.segments if s.commanded]
    of_drive = [
        DriveTerm(effect, shape)
        for effect in DRIVE_EFFECTS
        if effect.name not in names and prepared.drive in effect.drives
        for shape in (effect.drive_shapes(logs) if effect.drive_shapes else [])
    ]
    sample = min(s.sample for s in prepared.segments)
    delays = [
        EffectTerm(effect, (k * sample,))
        for effect in CATALOGUE
        if effect.delays and effect.name not in names
        for k in (-3.0, -1.0, 1.0, 3.0)
    ]
    return [*of_drive, *delays]


def testable(prepared: Prepared, effect: Effect, signals: Array) -> bool:
    """Whether the logs can test an effect."""
    if prepared.drive not in effect.drives:
        return False
    return all(_varies(signals[:, c], LEAST_WARMING * (c == TEMP)) for c in effect.needs)


def _in_band(prepared: Prepared, effect: Effect, shape: tuple[float, ...]) -> bool:
    """Whether the torque band contains all its frequencies."""
    units = effect.shape_units[: len(shape)]
    top = HEARD * prepared.band.balance
    return all(x <= top for x, unit in zip(shape, units, strict=True) if unit == "Hz")


def _varies(x: Array, least: float) -> bool:
    low, high = np.quantile(x, (0.01, 0.99))
    return bool(high - low > max(least, 1e-9 * (1.0 + np.abs(x).max())))


def unnamed_terms(prepared: Prepared, fitted: Fit, signals: list[Array]) -> list[Term]:
    """Dependences without a physical name, on every measured quantity.

    They are: a spline, alone and times the direction of friction; hysteresis in position over 1% to
    a third of the travel; a friction level per log; artefacts of the instruments.
    """
    terms: list[Term] = []
    for variable in [*VARIABLES, *prepared.segments[0].others]:
        terms += _curves(prepared, signals, variable)
    reaches = tuple(prepared.span * part for part in (0.01, 0.03, 0.1, 0.3))
    terms.append(HysteresisTerm("position", reaches))
    if prepared.drive == "torque" and not prepared.commanded:
        size = np.concatenate([np.abs(s.drive[s.mask]) for s in prepared.segments])
        # fractions of the samples above which a logged torque may not have acted
        levels = np.quantile(size, (0.2, 0.35, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98)).tolist()
        excess = [ExcessTerm("torque", x, (levels[0], levels[-1])) for x in levels]
        motion_hz = prepared.band.motion
        terms += [term for term in excess if term.shows(prepared.segments, motion_hz)]
    if any(s.saturated is not None for s in prepared.segments):
        terms.append(MissingTerm("torque"))
    if not prepared.slide:
        x = np.concatenate([s.signals[s.mask] for s in prepared.segments])
        inertia, *arms = parts_of_load(x).tolist()
        _, viscosity = fitted.levels
        of_joint = (inertia, (arms[0], arms[1]), viscosity)
        taken = {term.order for term in fitted.terms if isinstance(term, EncoderTerm)}
        orders = [N for N in (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0) if N not in taken]
        terms += [EncoderTerm("position", N, *of_joint) for N in orders]
    names = tuple(s.name for s in prepared.segments)
    if len(names) > 1:
        terms.append(LogTerm("log", names))
    return terms


def _curves(prepared: Prepared, signals: list[Array], variable: str) -> list[Term]:
    """Splines in a quantity that varies, alone and times the direction of friction."""
    try:
        x = np.concatenate(
            [quantity(s, g, variable) for s, g in zip(prepared.segments, signals, strict=True)]
        )
    except KeyError:
        return []  # another joint that only some logs have
    if not _varies(x, LEAST_WARMING * (VARIABLES.get(variable) == TEMP)):
        return []
    low, high = (float(v) for v in np.quantile(x, (0.005, 0.995)))
    pair = [SplineTerm(variable, low, high, odd) for odd in (False, True)]
    return [curve.centred(prepared.segments, signals) for curve in pair]
