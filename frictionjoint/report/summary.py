"""Every figure and sentence in the report of one joint, derived from report.json alone.

The terminal, the page and `Report.summary` print these, so no two of them can differ. Figures that
the logs do not support are withheld where they are made: `errors`, `evidence`, `numbers`,
`verdict`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from frictionjoint.report.error_figures import (
    STAGES,
    ErrorRow,
    Stage,
    drive_of,
    errors_of,
    models_differ,
    noise_of,
    units_of,
)
from frictionjoint.report.evidence import Candidate, EffectRow, effect_of, step_of, threshold_of
from frictionjoint.report.notes import without_repetition
from frictionjoint.report.numbers import Number, carried, friction_card, result_estimates

Content = Mapping[str, Any]

# a significant candidate is mentioned from this part of the squared residual on
_SUSPECT, _SIGNIFICANT = 0.1, 0.05


@dataclass(frozen=True)
class LogRow:
    """A log with its errors of the drive in motion."""

    name: str
    samples: int
    duration_s: float
    role: str
    before: float | None
    after: float | None


@dataclass(frozen=True)
class Summary:
    """Content of the report of one joint.

    Attributes:
        verdict: as in report.json. units: of drive and position. drive: its name.
        role: of the logs in the headline. noise: a sentence; `noise_level` its value if plausible.
        errors: most important first. at_rest: fraction of the samples.
        position_first: whether position comes first, as for servos. changed: whether the result
            differs from the base fit. friction: the main friction numbers.
        parameters: those in model.xml. steps: candidates of each step of the search.
        threshold: when an effect is normally added, in a sentence.
    """

    joint: str
    verdict: str
    units: tuple[str, str]
    drive: str
    role: str
    changed: bool
    position_first: bool
    errors: tuple[ErrorRow, ...]
    noise: str
    noise_level: float | None
    friction: tuple[Number, ...]
    effects: tuple[EffectRow, ...]
    steps: tuple[tuple[Candidate, ...], ...]
    threshold: str
    parameters: tuple[Number, ...]
    unexplained: tuple[tuple[str, float], ...]
    notes: tuple[str, ...]
    record_next: tuple[str, ...]
    logs: tuple[LogRow, ...]
    laws: tuple[str, str]
    at_rest: float = 0.0

    @property
    def verdict_lines(self) -> tuple[tuple[str, str], ...]:
        """Label and sentence of each line of the verdict."""
        from frictionjoint.report.verdict import verdict_lines  # it says what stands here

        return verdict_lines(self)

    @property
    def suspected(self) -> tuple[Candidate, ...]:
        """Candidates that are significant but too small to be added, if nothing was added."""
        if self.effects or not self.steps:
            return ()
        return tuple(c for c in self.steps[-1] if c.gain >= _SUSPECT and c.p_value <= _SIGNIFICANT)

    @property
    def covered(self) -> str:
        """The samples to which the errors and the search refer."""
        # a statement on logs that are at rest half of the time must mention it
        if self.at_rest < 0.5:
            return "these logs"
        return f"the {1.0 - self.at_rest:.0%} of the samples in which the joint moves"

    def error(self, quantity: str, stage: Stage) -> ErrorRow | None:
        """A row of the errors, if it is stated."""
        rows = (e for e in self.errors if e.quantity == quantity and e.stage == stage)
        return next(rows, None)


def summarise(content: Content) -> Summary:
    """Summarise the report of one joint.

    Args:
        content: of report.json, schema report-1, or of one joint of report-2 with its logs.
    """
    units = units_of(content)
    role = "held_out" if content["after"]["torque_rms"]["held_out"] is not None else "fit"
    laws = content["base"]["law"], content["after"].get("law", content["base"]["law"])
    effects = tuple(effect_of(content, added) for added in content["added"])
    errors = errors_of(content, units)
    # a joint of a robot may change by a cause that it shares
    changed = bool(effects) or laws[0] != laws[1] or models_differ(content)
    position_first = any(e.quantity.endswith("closed loop") for e in errors)
    if position_first:
        closed = [e for e in errors if e.quantity.endswith("closed loop")]
        others = [e for e in errors if e not in closed]
        errors = (*closed, *sorted(others, key=lambda e: not e.quantity.startswith("position")))
    if not changed:
        errors = tuple(e for e in errors if e.stage == "after")
    noise, noise_level = noise_of(content, units[0])
    unexplained = tuple((x["variable"], x["share"]) for x in content["unexplained"])
    return Summary(
        joint=content.get("joint", ""),
        verdict=content["verdict"],
        units=units,
        drive=drive_of(content, units[0]),
        role=role,
        changed=changed,
        position_first=position_first,
        errors=errors,
        noise=noise,
        noise_level=noise_level,
        friction=friction_card(result_estimates(content)),
        effects=effects,
        steps=tuple(
            step_of(look, effects) for look in content.get("candidates", ()) if look["rows"]
        ),
        threshold=threshold_of(content, effects),
        parameters=carried(content),
        unexplained=unexplained,
        notes=without_repetition(content.get("notes", ())),
        record_next=tuple(dict.fromkeys(content.get("proposals", ()))),
        logs=_logs(content),
        laws=laws,
        at_rest=content.get("at_rest") or 0.0,
    )


def _logs(content: Content) -> tuple[LogRow, ...]:
    errors = {(e["name"], e["role"]): e for e in content.get("log_errors", ())}
    return tuple(
        LogRow(
            log["name"],
            log["samples"],
            log["duration_s"],
            log["role"],
            *(errors.get((log["name"], log["role"]), {}).get(stage) for stage in STAGES),
        )
        for log in content["logs"]
    )
