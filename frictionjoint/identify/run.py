"""Identification of the friction law of one joint, without a search for effects."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from frictionjoint.control.controller import unknown_notes
from frictionjoint.control.controller_file import GivenController, controller_of
from frictionjoint.control.reconstruct import check_drive
from frictionjoint.files import toml_text, toml_text_without_scale
from frictionjoint.identify.assumptions import with_assumptions
from frictionjoint.identify.base_fit import base_fit, with_last_freedoms
from frictionjoint.identify.early_checks import check as check_balance
from frictionjoint.identify.early_checks import check_fit, scale_is_determined
from frictionjoint.identify.fit import without_scale
from frictionjoint.identify.fixed_joints import Pose
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.matching import Bodies
from frictionjoint.identify.notes import (
    CAUSES,
    LARGE,
    assumed_note,
    inertia_note,
    other_drive_note,
    require_level,
)
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import (
    Estimate,
    law_estimates,
    law_parameters,
    scale_note,
    units_of,
)
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.long_logs import shortened
from frictionjoint.parameter_meanings import meaning
from frictionjoint.parameters import Friction
from frictionjoint.threads import one_thread


@dataclass(frozen=True)
class Identified:
    """The friction law of one joint, fitted to logs.

    Attributes:
        joint: name. parameters: of the law, for `frictionjoint.install`.
        estimates: each parameter with its standard error and unit.
        unit: of torques: N m (N), or A or V if the logs do not determine the torque scale.
        torque_rms: residual. drive_rms: of the measured drive, both in that unit.
        notes: on the result.
    """

    joint: str
    parameters: Friction
    estimates: dict[str, Estimate]
    unit: str
    torque_rms: float
    drive_rms: float
    notes: tuple[str, ...] = field(default=(), repr=False)

    @property
    def scaled(self) -> bool:
        """Whether torques are in N m (N), so that a model can contain the friction."""
        return self.unit in ("N m", "N")

    def to_toml(self) -> str:
        """Text of the parameter file that `frictionjoint identify` writes, notes as comments."""
        loose = [n for n, x in self.estimates.items() if x.stderr is not None and x.is_loose]
        notes = list(self.notes)
        if loose:
            notes.append(f"Standard errors of more than half of the value: {', '.join(loose)}.")
        if self.scaled:
            return toml_text(self.parameters, notes=notes)
        return toml_text_without_scale(self.parameters, self.unit, notes)

    def to_dict(self) -> dict[str, Any]:
        """As `frictionjoint identify --json` prints it."""
        rows = {name: x.to_dict() for name, x in self.estimates.items()}
        return {"unit": self.unit, "torque_rms": self.torque_rms, "parameters": rows}

    def summary(self) -> str:
        """Each parameter with its standard error, and the residual, as text."""
        lines = [
            f"{meaning(name)} {name}: {x.value:.5g}"
            + (f" ± {x.stderr:.2g}" if x.stderr is not None else "")
            + ("" if x.unit == "1" else f" {x.unit}")
            for name, x in self.estimates.items()
        ]
        return "\n".join([*lines, self.residual, *(f"* {note}" for note in self.notes)])

    @property
    def residual(self) -> str:
        """The residual error of the law, in a sentence."""
        share = self.torque_rms / self.drive_rms
        sizes = f"{self.torque_rms:.4g} of {self.drive_rms:.4g} {self.unit} rms ({share:.1%})"
        return f"Residual {sizes}" + (f": {CAUSES}." if share > LARGE else ".")


@one_thread
def identify_law(
    logs: Sequence[JointLog],
    model: str | Path | Mapping[str, str | Path],
    joint: str,
    law: str,
    fixed: Mapping[str, Pose] | None,
    controller: GivenController | None,
    progress: Callable[[str], None],
) -> Identified:
    """Fit a friction law; see `frictionjoint.identify`."""
    forms_of(law)
    bodies = Bodies(model, joint, fixed)
    driven_by = controller_of(controller, joint, bodies.models)
    read = shortened(list(logs))
    said = bodies.check(read, ())
    body = bodies.of(read)[0]
    if driven_by:
        said += tuple(note for log in read for note in check_drive(log, driven_by))
        said += unknown_notes(driven_by)
    prepared = prepare(read, bodies.of(read), controller=driven_by)
    check_balance(prepared)
    prepared, fitted = base_fit(prepared, law, progress)
    prepared, fitted = with_last_freedoms(prepared, fitted)
    prepared, fitted = with_assumptions(prepared, fitted)
    check_fit(prepared, fitted)
    require_level(prepared, fitted)
    if not scale_is_determined(prepared, fitted):
        fitted = without_scale(fitted)
    unit, _ = units_of(fitted, body.slide)
    return Identified(
        joint=joint,
        parameters=law_parameters(fitted),
        estimates=law_estimates(fitted, stated_covariance(prepared, fitted), body.slide),
        unit=unit,
        torque_rms=fitted.rms,
        drive_rms=fitted.target_rms,
        notes=(
            *said,
            *scale_note(fitted, body.slide),
            *inertia_note(prepared, fitted),
            *other_drive_note(prepared),
            *assumed_note(prepared, fitted),
        ),
    )
