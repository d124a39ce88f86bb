"""Every figure and sentence in the report of one joint, derived from report.json alone.

The terminal, the page and `Report.summary` print these, so no two of them can differ. Figures that
the logs do not support are withheld where they are made: here, in `error_figures`, in `evidence`
and in `numbers`.
"""

from frictionjoint.decisions import AT_THE_FLOOR, SIGNIFICANCE, SMALLEST_GAIN
from frictionjoint.identify.rms import Rms
from frictionjoint.report.entries import Content
from frictionjoint.report.error_figures import (
    STAGES,
    ErrorRow,
    Stage,
    arrow,
    compared,
    drive_of,
    errors_of,
    noise_of,
    units_of,
)
from frictionjoint.report.evidence import (
    Candidate,
    EffectRow,
    cause_title,
    smallest_of,
    step_of,
    threshold_of,
)
from frictionjoint.report.numbers import carried, friction_card, result_estimates
from frictionjoint.report.wording import listed, quantity, three, without_repetition


class Summary:
    """Content of the report of one joint: schema report-1, or a joint of report-2 with its logs.

    Attributes:
        units: of drive and position. drive: its name. role: of the logs in the headline.
        noise: a sentence; `noise_level` its value if plausible. errors: most important first.
        at_rest: fraction of the samples. position_first: whether it comes first, as for servos.
        shared: causes that act on other joints of the robot too.
        changed: whether the result differs from the base fit. friction: the main friction numbers.
        parameters: those in model.xml. steps: candidates of each step of the search.
        threshold: when an effect is normally added, in a sentence.
        unexplained: quantities that the residual depends on, with the fraction of its square that
            they explain. causes: likely ones of these, in a sentence.
        smallest: each further effect, and the smallest torque that these logs would have shown.
        law_errors: rms error in motion on fitted logs with each friction law.
        logs: as in report.json, with their errors of the drive, `before` and `after`.
    """

    def __init__(self, content: Content) -> None:
        law = content["base"]["law"]
        held_out = content["after"]["torque_rms"]["held_out"] is not None
        self.joint: str = content.get("joint", "")
        self.verdict: str = content["verdict"]
        self.role = "held_out" if held_out else "fit"
        self.laws: tuple[str, str] = law, content["after"].get("law", law)
        self.units = units_of(content)
        self.drive = drive_of(content, self.units[0])
        self.noise, self.noise_level = noise_of(content, self.units[0])
        self.smallest = smallest_of(content, self.units[0])
        self.effects = tuple(EffectRow(content, added) for added in content["added"])
        self.shared = tuple(map(cause_title, content.get("shared", ())))
        before, after = (content[stage]["torque_rms"] for stage in STAGES)
        differ = any(before[key] != after[key] for key in ("fit", "held_out"))
        self.changed = bool(self.effects) or self.laws[0] != self.laws[1] or differ
        self.errors = errors_of(content, self.units)
        closed = [e for e in self.errors if e.quantity.endswith("closed loop")]
        self.position_first = bool(closed)
        if closed:
            others = [e for e in self.errors if e not in closed]
            others.sort(key=lambda e: not e.quantity.startswith("position"))
            self.errors = (*closed, *others)
        if not self.changed:
            self.errors = tuple(e for e in self.errors if e.stage == "after")
        looks = [look for look in content.get("candidates", ()) if look["rows"]]
        self.steps = tuple(step_of(look, self.effects, content) for look in looks)
        self.threshold = threshold_of(content, self.effects)
        self.friction = friction_card(result_estimates(content))
        self.parameters = carried(content)
        self.law_errors: dict[str, float] = dict(content.get("law_errors", {}))
        self.unexplained = tuple((x["variable"], x["share"]) for x in content["unexplained"])
        self.causes: dict[str, str] = dict(content.get("unexplained_causes", {}))
        stated = set(self.causes.values())
        self.notes = without_repetition(x for x in content.get("notes", ()) if x not in stated)
        self.record_next = tuple(dict.fromkeys(content.get("proposals", ())))
        self.logs = _logs(content)
        self.at_rest: float = content.get("at_rest") or 0.0

    @property
    def verdict_lines(self) -> tuple[tuple[str, str], ...]:
        """Label and sentence of each line: missing, errors, rivals, what to record next."""
        robot = f"{listed(self.shared)}, see the robot's page; beyond this, " if self.shared else ""
        lines = (
            ("Missing", robot + _missing(self)),
            ("Error before and after" if self.changed else "Error", _error_line(self)),
            ("Could also be", _rivals_line(self)),
            ("Record next", self.record_next[0] if self.record_next else "nothing in particular."),
        )
        return tuple((label, text[0].upper() + text[1:]) for label, text in lines if text)

    @property
    def suspected(self) -> tuple[Candidate, ...]:
        """Candidates that are significant but too small to be added, if nothing was added."""
        if self.effects or not self.steps:
            return ()
        # mentioned from a tenth of the squared residual on
        return tuple(c for c in self.steps[-1] if c.gain >= 0.1 and c.p_value <= SIGNIFICANCE)

    @property
    def is_contradicted(self) -> bool:
        """Whether the error of the drive does not fall on held-out logs."""
        change = self.change(self.drive.split(" ", 1)[1])
        return self.role == "held_out" and change in ("rises", "no fall")

    def error(self, quantity: str, stage: Stage) -> ErrorRow | None:
        rows = (e for e in self.errors if e.quantity == quantity and e.stage == stage)
        return next(rows, None)

    def change(self, quantity: str) -> str:
        """How an error changes from before to after, see `compared`."""
        return compared(self.error(quantity, "before"), self.error(quantity, "after"), self.role)


def _logs(content: Content) -> tuple[Content, ...]:
    errors = {(e["name"], e["role"]): e for e in content.get("log_errors", ())}
    unknown = dict.fromkeys(STAGES)
    return tuple(unknown | x | errors.get((x["name"], x["role"]), {}) for x in content["logs"])


def _missing(s: Summary) -> str:
    """Effects that the model lacks, in a sentence."""
    noise = s.noise_level
    after = next((e for e in s.errors if e.unit == s.units[0] and e.stage == "after"), None)
    error, fitted = (after.values[s.role], after.values["fit"]) if after else (None, None)
    times = ""
    if error and fitted and Rms(fitted, error).only_fitted:
        times = (
            f" The error on held-out logs is {three(error / fitted, 2)} times that on fitted logs: "
            "fit logs with motion like theirs too."
        )
    elif noise and error is not None and error > AT_THE_FLOOR * noise:
        times = f" What remains is {three(error / noise, 2)} times the noise of the instruments."
    elif s.verdict == "partly-explained" and s.effects and not noise:
        times = " The remaining error is not noise: it is correlated in time."
    rest = _dependences(s)
    if s.verdict == "too-short-to-tell":
        return "these logs are too short for a verdict."
    if not s.effects:
        if s.unexplained:
            known = all(v in s.causes for v, _ in s.unexplained)
            what = "no effect of the catalogue" if known else "an unknown cause"
            return f"{what}.{rest}"
        if s.suspected:
            best = s.suspected[0]
            small = best.gain < SMALLEST_GAIN
            refitted = "but the complete model does not support it"
            why = "which is below the threshold" if small else refitted
            return (
                f"nothing for certain; {best.title} would explain {best.gain:.0%} of the squared "
                f"residual (p = {three(best.p_value)}), {why}.{times}"
            )
        if noise and error is not None and error <= AT_THE_FLOOR * noise:
            # a statement on logs that are at rest half of the time must mention it
            moving = f", in the {1.0 - s.at_rest:.0%} of the samples in which the joint moves"
            where = "" if s.at_rest < 0.5 else moving
            return f"nothing was found; the error is close to the noise{where}."
        return (
            "no effect was found; no known effect and no measured quantity explains a significant "
            "part of the error." + times
        )
    sure = [e.title for e in s.effects if not e.doubt]
    # what would be left out if held-out prediction did not need it
    unsized = [e.title for e in s.effects if "size" in e.doubt]
    unsure = [f"{e.title} ({e.doubt})" for e in s.effects if e.doubt and "size" not in e.doubt]
    change = s.change(s.drive.split(" ", 1)[1])
    if s.is_contradicted:
        held = "contradict" if change == "rises" else "do not confirm"
        suggested = listed(sure or unsure or unsized)
        return (
            f"not confirmed: fitted logs suggest {suggested}, held-out logs {held} it; the "
            f"friction below and model.xml contain it.{rest}"
        )
    text = listed(sure)
    if not sure and change == "falls" and all("size" in e.doubt for e in s.effects):
        names = [e.title for e in s.effects]
        text = f"{listed(names)}, but these logs do not determine its size"
        if len(names) > 1:
            which = "which of them, or how large each is"
            text = f"one or more of {listed(names)}, but these logs do not determine {which}"
    else:
        text = text or "nothing for certain"
        if unsized:
            also = "also " if sure else ""
            text += f"; probably {also}{listed(unsized)}, whose size these logs do not determine"
        if unsure:
            text += f"; also in the model, but not supported by these logs: {listed(unsure)}"
    if s.laws[0] != s.laws[1]:
        text += f"; the friction law is {s.laws[1]} instead of {s.laws[0]}"
    stated = {e.quantity for e in s.errors if not e.quantity.endswith(", rms")}
    falls = any(s.change(name) in ("falls", "falls by") for name in stated)
    if sure and s.role == "held_out" and not falls:
        text += "; on held-out logs the error falls by no more than chance explains"
    if sure and s.change("position") == "rises":
        text += "; the simulated position, however, gets worse"
    if rest:
        return f"{text}.{_explained(s) or rest}"
    return text + "." + (times if s.verdict == "partly-explained" else "")


def _explained(s: Summary) -> str:
    """What the result removes of the squared error, and what the rest depends on; empty if the
    error does not fall."""
    name = s.drive.split(" ", 1)[1]
    pair = [s.error(name, stage) for stage in STAGES]
    first, last = (e.values[s.role] if e else None for e in pair)
    if not first or last is None or last >= first:
        return ""
    removed = f" The resulting model removes {1.0 - (last / first) ** 2:.0%} of the squared error."
    return removed + _dependences(s, "What remains")


def _dependences(s: Summary, residual: str = "The residual") -> str:
    """Quantities that the residual still depends on, with their causes; empty for none."""
    parts = [f"{quantity(v)} ({x:.0%})" for v, x in s.unexplained if v not in s.causes]
    texts = [f"{residual} still depends on {listed(parts)}, which no known effect explains."]
    texts = texts if parts else []
    for v, share in s.unexplained:
        if v in s.causes:
            texts.append(f"{s.causes[v].rstrip('.')} ({share:.0%} of the squared residual).")
    return "".join(f" {text}" for text in texts)


def _error_line(s: Summary) -> str:
    """The errors before and after in one sentence."""
    parts = []
    where = "held-out" if s.role == "held_out" else "fitted"
    shown = [e.quantity for e in s.errors if not e.quantity.endswith(", rms")]
    for name in dict.fromkeys(shown):
        before, after = s.error(name, "before"), s.error(name, "after")
        if after is None or after.values[s.role] is None:
            continue
        if not s.changed or before is None or before.values[s.role] is None:
            parts.append(f"{name} {after.text(s.role)}")
            continue
        text = f"{name} {arrow(before, after, s.role)}"
        change = s.change(name)
        if change == "rises" or (change == "no fall" and not before.interval):
            text += ", which is worse"
        elif change in ("may be chance", "no fall"):
            text += ", which may be chance"
        parts.append(text)
    if not parts:
        return ""
    drive = f"; per cent of the {s.drive}" if "%" in parts[0] + parts[-1] else ""
    return f"{'; '.join(parts)} ({where} logs{drive})."


def _rivals_line(s: Summary) -> str:
    """Effects that these logs cannot distinguish from the named ones."""
    tied = [f"{listed(e.rivals)} instead of {e.title}" for e in s.effects if e.rivals]
    if tied:
        return f"{'; '.join(tied)}: these logs do not distinguish them."
    best = [(e, e.next_best) for e in s.effects if e.next_best]
    if not best:
        return ""
    e, (name, gain) = best[0]
    return (
        f"no other effect explains as much; the next candidate, {name}, explains {gain:.1%} where "
        f"{e.title} explains {e.gain:.1%}."
    )
