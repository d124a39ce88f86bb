"""Numbers, quantities and the verdict in words."""

import math

from frictionjoint.diagnose.advice import quantity
from frictionjoint.diagnose.report_data import Report
from frictionjoint.identify.result import Estimate

# Up to this multiple of the torque's own noise nothing worth a word is left.
_NOISE_ALONE = 1.5

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


def sentence(report: Report) -> str:
    """The verdict in a sentence."""
    unit, _ = report.units
    where = "held-out" if report.after_torque.held_out is not None else "fitted"
    before = report.before_torque.held_out or report.before_torque.fit or 0.0
    after = report.after_torque.held_out or report.after_torque.fit or 0.0
    alone = f"{_law(report)} leaves {after:.3g} {unit} on {where} data"
    if report.verdict == "too-short-to-tell":
        return f"These logs are too short to tell: {alone}{_times_noise(report, after)}."
    if report.verdict == "no-effect-found":
        if _ratio(report, after) <= _NOISE_ALONE:
            return (
                f"Nothing is missing that these logs can show: {alone}, hardly more than the "
                "torque's own noise."
            )
        return (
            f"No effect was found: {alone}{_times_noise(report, after)}, and neither a known "
            "effect nor a measured quantity accounts for a significant part of it."
        )
    left = ", ".join(quantity(v) for v, _ in report.unexplained)
    rest = f" What is left depends on {left}." if left else ""
    if not report.added:
        return (
            f"No known effect explains what is missing: {alone}{_times_noise(report, after)}.{rest}"
        )
    names = _listed([_with_ties(report, i) for i in range(len(report.added))])
    change = f"the error goes from {before:.3g} to {after:.3g} {unit} on {where} data"
    if report.torque_interval[0][0] <= report.torque_interval[1][1]:
        change += ", a change that may be chance"
    elif after < before:
        change = (
            f"the error falls by {1.0 - after / before:.0%}, from {before:.3g} to {after:.3g} "
            f"{unit} on {where} data"
        )
    if report.verdict == "partly-explained" and not rest:
        rest = f" What is left is not noise alone{_times_noise(report, after)}."
    it = "it" if len(report.added) == 1 else "them"
    own, law = (law.law for law in report.laws)
    if own != law:
        it += f", and the friction law {law} in place of {own},"
    if report.after_torque.worse_than(report.before_torque):
        ask = f"The fitted logs ask for {names}, but the held-out ones do not bear that out"
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
    if own == law:
        return "the law alone"
    before = report.before_torque.held_out or report.before_torque.fit or 0.0
    return f"the friction law {law}, in place of {own} which leaves {before:.3g},"


def _listed(names: list[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _with_ties(report: Report, i: int) -> str:
    added = report.added[i]
    ties = "".join(f" or {name}" for name in added.evidence.ties)
    cause = f" ({added.cause})" if len(report.added) == 1 else ""
    return added.effect + ties + cause


def _ratio(report: Report, error: float) -> float:
    return error / report.noise_floor if report.noise_floor else math.inf


def _times_noise(report: Report, error: float) -> str:
    ratio = _ratio(report, error)
    return f", {ratio:.2g} times the torque's own noise" if ratio < math.inf else ""


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
    stderr = "–" if x.stderr is None else _plain(f"{x.stderr:.2g}")
    # the spaces do not break a line
    behind = f"\u00a0±\u00a0{stderr}" if spread else ""
    if not x.stderr or not math.isfinite(x.stderr):
        return _plain(f"{x.value:.5g}") + behind
    decimals = 1 - math.floor(math.log10(x.stderr))
    # adding zero takes the sign off a zero
    return _plain(f"{round(x.value, decimals) + 0.0:.8g}") + behind


def _plain(text: str) -> str:
    """Without exponent where the number is not far from one, with a minus sign."""
    number = float(text)
    if "e" in text and 1e-4 <= abs(number) < 1e7:
        text = f"{number:f}".rstrip("0").rstrip(".") if abs(number) < 1.0 else f"{number:.0f}"
    return text.replace("-", "−", 1) if text.startswith("-") else text
