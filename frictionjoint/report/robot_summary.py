"""Every figure and sentence in the report of a whole robot, from report.json alone."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from frictionjoint.decisions import SIGNIFICANCE
from frictionjoint.effects.catalogue import title
from frictionjoint.effects.quantities import quantity_of
from frictionjoint.identify.result import Estimate
from frictionjoint.report.entries import Content
from frictionjoint.report.error_figures import STAGES, Stage, units_of
from frictionjoint.report.evidence import cause_title
from frictionjoint.report.joints import joint_content
from frictionjoint.report.numbers import estimates, with_unit
from frictionjoint.report.summary import Summary
from frictionjoint.report.wording import listed, percentage, three, without_repetition

_NONE = "–"
_NO_MOTION = "no trajectory was found that stays within the limits of the robot without contact."
_FRICTION = ("Fc", "Fs", "sigma2", "stiffness")


class SharedRow:
    """A shared cause: place, numbers, and the torque error of each joint it acts on."""

    def __init__(self, content: Content, joints: Mapping[str, Summary], found: Content) -> None:
        rows = []
        for name, errors in found["joints"].items():
            if name in joints:
                rms = content["joints"][name].get("drive", {}).get("rms", {})
                before, after = (
                    _fraction(errors[stage]["torque_rms"], rms.get("after", {}), joints[name].role)
                    for stage in ("before", "after")
                )
                rows.append((name, before, after))
        evidence = found["evidence"]
        self.title = cause_title(found)
        self.size = tuple(
            f"{quantity_of(found['cause'], name)} {with_unit(x)}"
            for name, x in estimates(found["parameters"]).items()
        )
        self.gain: float = evidence["held_out_gain"]
        self.p_value: float = evidence["p_value"]
        self.rivals = tuple(title(x) for x in evidence.get("ties", ()))
        self.joints = tuple(rows)

    @property
    def doubt(self) -> str:
        """Why the logs do not support it by itself, in brackets; empty if they do."""
        return f" (p = {three(self.p_value)})" if self.p_value > SIGNIFICANCE else ""


class JointRow:
    """A joint in a table: effects, errors before and after, verdict; `friction` by symbol."""

    def __init__(
        self, content: Content, name: str, s: Summary, role: str, shared: Sequence[SharedRow]
    ) -> None:
        own = [x for x in shared if name in [row[0] for row in x.joints]]
        names = [x.title for x in s.effects if not x.doubt]
        names += [x.title for x in own if not x.doubt]
        unsure = [f"{x.title} ({x.doubt})" for x in s.effects if x.doubt]
        unsure += [x.title + x.doubt for x in own if x.doubt]
        if s.laws[0] != s.laws[1]:
            names.append(f"law {s.laws[1]}")
        torque = [e for e in s.errors if e.unit == s.units[0] and e.quantity in s.drive]
        position = [
            e for e in s.errors if e.quantity.startswith("position") and e.quantity[-3:] != "rms"
        ]
        worse = content["joints"][name].get("worse") or ()
        kinds = {"torque_rms": "torque", "replay_rms": "position"}
        verdict = s.verdict.replace("-", " ")
        if names and not s.effects and s.verdict == "no-effect-found":
            verdict = "no further effect found"
        if worse:
            verdict += f", worse on held-out logs ({listed([kinds[x] for x in worse])})"
        by_symbol = {x.name: x for x in s.friction}
        self.joint = name
        self.effects = ", ".join(names) or "none"
        if unsure:
            self.effects += f"; in the model, but not supported: {', '.join(unsure)}"
        self.torque = _change({e.stage: e.fractions.get(role) or e.text(role) for e in torque}, s)
        self.position = _change({e.stage: e.text(role) for e in position}, s)
        self.verdict = verdict
        self.friction = tuple(_cell(by_symbol, symbol) for symbol in _FRICTION)


class RobotSummary:
    """Content of a robot's report, schema report-2: a summary and a row of each joint, and why a
    joint has no result; gears between motor and link and logs by the keys of report.json."""

    # headings of the columns of friction numbers
    friction_head: ClassVar = ("Coulomb", "breakaway", "viscous", "presliding stiffness")

    def __init__(self, content: Content) -> None:
        by_joint = content["joints"]
        held_out = content["after"]["torque_percent"]["held_out"] is not None
        self.verdict: str = content["verdict"]
        self.role = "held_out" if held_out else "fit"
        self.joints = {name: Summary(joint_content(content, name)) for name in by_joint}
        shared = [SharedRow(content, self.joints, x) for x in content["shared"]]
        self.shared = tuple(sorted(shared, key=lambda r: -r.gain))
        self.rows = tuple(
            JointRow(content, name, s, self.role, self.shared) for name, s in self.joints.items()
        )
        self.failed: dict[str, str] = dict(content["failed"])
        geared = {name: x["torsion"] for name, x in by_joint.items() if "torsion" in x}
        self.torsion = tuple(_torsion(name, x) for name, x in geared.items())
        self.undetermined = tuple(x["text"] for x in content["undetermined"])
        self.notes = without_repetition(content.get("notes", ()))
        self.record_next = tuple(dict.fromkeys(content.get("proposals", ())))
        self.logs = tuple(content["logs"])
        changed = bool(self.shared) or any(s.changed for s in self.joints.values())
        error = _errors(content, self.role, changed)
        doubted = {n for n, s in self.joints.items() if s.effects and s.is_contradicted}
        doubted |= {n for n, x in by_joint.items() if x.get("worse")}
        lines = (
            ("Missing", self._missing(doubted)),
            ("Error before and after" if changed else "Error", error),
            ("Could also be", self._rivals(doubted)),
            ("Record next", self.record_next[0] if self.record_next else _NO_MOTION),
        )
        self.verdict_lines = tuple((x, line[0].upper() + line[1:]) for x, line in lines if line)

    def _missing(self, doubted: set[str]) -> str:
        """Causes and effects that the model lacks, and what held-out logs do not confirm: effects
        of the joints `doubted`."""
        by_effect: dict[str, list[str]] = {}
        for name, s in self.joints.items():
            for x in s.effects:
                if not x.doubt and name not in doubted:
                    by_effect.setdefault(x.title, []).append(name)
        missing = [f"{effect} ({', '.join(names)})" for effect, names in by_effect.items()]
        causes = [x.title for x in self.shared if not x.doubt]
        unsure = [x.title + x.doubt for x in self.shared if x.doubt]
        text = listed(causes + missing) or "nothing for certain"
        if unsure:
            text += f"; also in the model, but not supported by these logs: {listed(unsure)}"
        if doubted:
            text += f"; held-out logs do not confirm what was found of {listed(sorted(doubted))}"
        if self.failed:
            text += f"; without a result: {listed(list(self.failed))}"
        return text + "."

    def _rivals(self, doubted: set[str]) -> str:
        """What could be instead of the causes and effects that are missing; empty for nothing."""
        rivals = [
            f"{listed(x.rivals)} instead of {x.title}"
            for x in self.shared
            if x.rivals and not x.doubt
        ]
        rivals += [
            f"in {name}, {listed(x.rivals)} instead of {x.title}"
            for name, s in self.joints.items()
            for x in s.effects
            if x.rivals and not x.doubt and name not in doubted
        ]
        return "; ".join(rivals) + "." if rivals else ""


def _errors(content: Content, role: str, changed: bool) -> str:
    """The errors of the robot in one sentence: before and after, or one if nothing changed."""
    first, last = (content[stage]["torque_percent"][role] for stage in ("before", "after"))
    figures = [_percent(first), _percent(last)] if changed else [_percent(last)]
    parts = [f"torque {' → '.join(figures)} (mean of the joints)"]
    before, after = (content[stage]["replay_rms"] for stage in ("before", "after"))
    if before[role] is not None and after[role] is not None:
        figures = [three(x[role]) for x in ((before, after) if changed else (after,))]
        unit = listed(sorted({units_of(x)[1] for x in content["joints"].values()}, reverse=True))
        text = f"position {' → '.join(figures)} {unit}, all joints together"
        fitted = before["fit"], after["fit"]
        # a rise by a tenth is more than that of another run
        if changed and role == "held_out" and None not in fitted and fitted[1] > 1.1 * fitted[0]:
            text += f" (worse on fitted logs: {three(fitted[0])} → {three(fitted[1])} {unit})"
        parts.append(text)
    where = "held-out" if role == "held_out" else "fitted"
    worse = ", which is worse" if changed and None not in (first, last) and last > first else ""
    return f"{'; '.join(parts)}{worse} ({where} logs; per cent of the drive)."


def _percent(x: float | None) -> str:
    return _NONE if x is None else percentage(x, 100.0)


def _cell(numbers: Mapping[str, Any], symbol: str) -> str:
    """A friction number; both directions if they differ."""
    names = (symbol,) if symbol in numbers else (f"{symbol}_pos", f"{symbol}_neg")
    return " / ".join(numbers[name].qualified for name in names if name in numbers) or _NONE


def _change(texts: Mapping[Stage, str], s: Summary) -> str:
    """An error before and after; "diverges" if the simulation leaves the logged motion."""
    if not texts:
        return _NONE
    text = " → ".join(texts.get(x, "diverges") for x in (STAGES if s.changed else STAGES[1:]))
    return text.replace(f"\u00a0{s.units[1]} →", " →")


def _fraction(errors: Content, whole: Content, role: str) -> str:
    error, size = errors[role], whole.get(role)
    return _NONE if error is None else percentage(error, size) if size else three(error)


def _torsion(name: str, x: Content) -> dict[str, str]:
    geared = [f"motor also geared to {n} ({c:.4g})" for n, c in x.get("geared", {}).items()]
    row = {"joint": ", ".join([name, *geared])}
    for key in ("stiffness", "backlash", "hysteresis", "link_position_older"):
        row[key] = with_unit(Estimate(**x[key])) if x.get(key) else "none seen"
    return row | {key: three(x[key]) for key in ("twist_rms", "left_rms")}
