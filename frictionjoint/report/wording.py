"""Numbers, quantities and the verdict in words."""

import math
from typing import Literal

import numpy as np

from frictionjoint.diagnose.advice import quantity
from frictionjoint.diagnose.report_data import Report, Role
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.identify.result import Estimate

Stage = Literal["before", "after"]
STAGES: tuple[Stage, Stage] = ("before", "after")

# Up to this multiple of the torque's own noise nothing worth a word is left.
_NOISE_ALONE = 1.5
# beyond them a number is written with an exponent
_MOST_DECIMALS = 6
# decimals of a value without a standard error
_ROUNDING = 15

MEANINGS = {
    "Fs": "breakaway",
    "Fc": "Coulomb",
    "Vs": "Stribeck velocity",
    "delta": "Stribeck exponent",
    "sigma2": "viscous",
    "stiffness": "before sliding, at a turn",
    "sigma1": "damping before sliding",
    "n": "exponent of the transition",
    "gain": "torque per unit of drive",
}
_SIDES = {"pos": "positive motion", "neg": "negative motion"}


def title(effect: str) -> str:
    """What a person calls an effect, from its canonical name."""
    return next((e.title for e in CATALOGUE if e.name == effect and e.title), effect)


def known_as(effect: str, remark: str = "") -> str:
    """What a person calls an effect, with its canonical name and a remark in brackets."""
    plain = title(effect)
    name = "" if plain.lower().replace(" ", "-") == effect else effect
    inside = ", ".join(filter(None, (name, remark)))
    return f"{plain} ({inside})" if inside else plain


def drive(report: Report) -> str:
    """What a report's torques are."""
    own = "force" if report.slide else "torque"
    # in the unit of a position they are over a kp that is not known
    known = {"N m": own, "N": own, "A": "current", "V": "voltage"}
    return known.get(report.units[0], f"{own} over kp")


def whose(report: Report) -> str:
    """Where the drive comes from, before what it is."""
    return "controller's" if report.reconstructed else "measured"


def drive_rms(report: Report, role: Role, stage: Stage) -> float:
    """rms of the drive in motion on the logs of a role; NaN without such logs.

    Before, that of the controller as its file says; after, as effects of the drive have changed it.
    """
    drives = [
        (c.given if stage == "before" else c.measured)[c.in_motion]
        for c in report.curves
        if c.role == role
    ]
    return float(np.sqrt(np.mean(np.concatenate(drives) ** 2))) if drives else math.nan


def sentence(report: Report) -> str:
    """The verdict in a sentence."""
    unit, _ = report.units
    role: Role = "held-out" if report.after_torque.held_out is not None else "fit"
    where = "held-out" if role == "held-out" else "fitted"
    before = report.before_torque.held_out or report.before_torque.fit or 0.0
    after = report.after_torque.held_out or report.after_torque.fit or 0.0
    first = percentage(before, drive_rms(report, role, "before"))
    last = percentage(after, drive_rms(report, role, "after"))
    of_drive = f"of the {whose(report)} {drive(report)}"
    percent = f" ({last} {of_drive})"
    alone = f"{_law(report)} leaves {after:.3g} {unit}{percent} on {where} data"
    alone += _other_law(report, before)
    if report.verdict == "too-short-to-tell":
        return f"These logs are too short for a verdict: {alone}{_times_noise(report, after)}."
    if report.verdict == "no-effect-found":
        if _ratio(report, after) <= _NOISE_ALONE:
            return (
                f"Nothing is missing that these logs can show: {alone}, hardly more than the "
                "noise of the instruments."
            )
        return (
            f"No effect was found: {alone}{_times_noise(report, after)}, and neither a known "
            "effect nor a measured quantity accounts for a significant part of it."
        )
    left = ", ".join(quantity(v) for v, _ in report.unexplained)
    rest = f" The rest depends on {left}." if left else ""
    if not report.added:
        return (
            f"No known effect explains what is missing: {alone}{_times_noise(report, after)}.{rest}"
        )
    names = _listed([_with_ties(report, i) for i in range(len(report.added))])
    change = f"from {before:.3g} to {after:.3g} {unit} ({first} to {last} {of_drive})"
    change += f" on {where} data"
    unknown = (-math.inf, math.inf)
    (least_before, most_before), (least_after, most_after) = report.torque_interval or (
        unknown,
        unknown,
    )
    rises = least_after > most_before
    if rises:
        change = f"the error rises {change}" + (", which is no gain" if role == "held-out" else "")
    elif most_after < least_before:
        change = f"the error falls by {1.0 - after / before:.0%}, {change}"
    else:
        change = f"the error goes {change}, a change that may be chance"
    if report.verdict == "partly-explained" and not rest:
        rest = " The rest is not noise: it keeps its sign for longer than noise does."
        if _ratio(report, after) > _NOISE_ALONE:
            rest = f" The rest is more than noise{_times_noise(report, after)}."
    if report.after_torque.only_fitted:
        rest += " It is more than twice what the fitted logs have."
    it = "it" if len(report.added) == 1 else "them"
    own, law = (law.law for law in report.laws)
    if own != law:
        it += f", and the friction law {law} in place of {own},"
    if report.after_torque.worse_than(report.before_torque):
        held_out = "contradict it" if rises else "do not confirm it"
        ask = f"The fitted logs suggest {names}, but the held-out ones {held_out}"
    else:
        ask = f"The model lacked {names}"
    return f"{ask}: with {it} {change}.{rest}{_replay(report)}"


def _replay(report: Report) -> str:
    """A warning where the simulated motion contradicts, beyond chance."""
    if report.replay_interval is None:
        return ""
    (_, most), (least, _) = report.replay_interval
    return " The replayed position is further off than before." if least > most else ""


def _law(report: Report) -> str:
    """The law of a result without effects."""
    own, law = (law.law for law in report.laws)
    return "the law alone" if own == law else f"the friction law {law}"


def _other_law(report: Report, error: float) -> str:
    """What the law of the base fit leaves, where the result has another."""
    own, law = (law.law for law in report.laws)
    return "" if own == law else f", where {own} leaves {error:.3g} {report.units[0]}"


def _listed(names: list[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _with_ties(report: Report, i: int) -> str:
    added = report.added[i]
    ties = " or ".join(added.evidence.ties)
    remark = f"which these logs cannot distinguish from {ties}" if ties else ""
    return known_as(added.effect, remark)


def _ratio(report: Report, error: float) -> float:
    return error / report.noise_floor if report.noise_floor else math.inf


def _times_noise(report: Report, error: float) -> str:
    ratio = _ratio(report, error)
    return f", {ratio:.2g} times the noise of the instruments" if ratio < math.inf else ""


def axis(variable: str, slide: bool) -> str:
    """A quantity with its unit."""
    torque, x = ("N", "m") if slide else ("N m", "rad")
    unit = {"position": x, "velocity": f"{x}/s", "acceleration": f"{x}/s²", "load": torque}
    unit |= {"time": "s", "temperature_c": "°C"}
    found = unit.get(variable)
    return f"{quantity(variable)}, {found}" if found else quantity(variable)


def meaning(name: str) -> str:
    """What a parameter of the law is."""
    base, _, side = name.rpartition("_")
    if side in _SIDES and base in MEANINGS:
        return f"{MEANINGS[base]}, {_SIDES[side]}"
    return MEANINGS.get(name, "")


def percentage(value: float, whole: float) -> str:
    """A part of a whole to two figures."""
    part = 100.0 * value / whole if whole else math.nan
    return f"{part:.0f}%" if part >= 9.95 else f"{part:.2g}%"


def stated(value: float | None, unit: str, whole: float = math.nan) -> str:
    """A figure with its unit, and per cent of a whole where that is known."""
    if value is None:
        return "not stated"
    percent = "" if math.isnan(whole) else f" ({percentage(value, whole)})"
    return f"{three(value)}\u00a0{unit}{percent}"


def unit(text: str) -> str:
    """A unit as it is written for people."""
    return "none" if text == "1" else text.replace("^2", "²")


def three(value: float | None) -> str:
    """Three figures, or a dash."""
    return "–" if value is None else _plain(f"{value:.3g}")


def interval(pair: tuple[float, float] | None) -> str:
    """Low to high."""
    return f"{three(pair[0])} to {three(pair[1])}" if pair else "–"


def value(x: Estimate | None, spread: bool = False) -> str:
    """A value to the second figure of its standard error, else to five figures.

    With `spread` the error stands behind it; a dash there: the logs do not determine the value.
    """
    if x is None:
        return "–"
    if not x.stderr or not math.isfinite(x.stderr):
        # what is smaller in any unit of a joint is the rounding of a zero
        number = round(x.value, _ROUNDING) + 0.0
        return _plain(f"{number:.5g}") + ("\u00a0±\u00a0–" if spread else "")
    decimals = 1 - math.floor(math.log10(x.stderr))
    # adding zero takes the sign off a zero
    texts = [
        f"{round(number, decimals) + 0.0:.{max(decimals, 0)}f}"
        if decimals <= _MOST_DECIMALS
        else _plain(f"{round(number, decimals) + 0.0:.8g}")
        for number in (x.value, x.stderr)
    ]
    # the spaces do not break a line
    return "\u00a0±\u00a0".join(texts if spread else texts[:1]).replace("-", "−", 1)


def _plain(text: str) -> str:
    """Without exponent where the number is not far from one, with a minus sign."""
    number = float(text)
    if "e" in text and 1e-4 <= abs(number) < 1e7:
        text = f"{number:f}".rstrip("0").rstrip(".") if abs(number) < 1.0 else f"{number:.0f}"
    return text.replace("-", "−", 1) if text.startswith("-") else text
