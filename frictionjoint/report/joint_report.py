"""Results of `close_loop` as plain data: the content of report.json and of the page."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from frictionjoint.arrays import root_mean_square
from frictionjoint.control.controller import Controller
from frictionjoint.decisions import AT_THE_FLOOR, CLEARLY, LEAST_NOISE
from frictionjoint.errors import ParameterError
from frictionjoint.files import toml_document
from frictionjoint.identify.result import Estimate
from frictionjoint.identify.rms import Rms
from frictionjoint.joint_friction import JointFriction
from frictionjoint.parameters import Friction
from frictionjoint.refine.posterior import Posterior
from frictionjoint.refine.refine import RefinedModel
from frictionjoint.replay.closed_loop import LoopErrors
from frictionjoint.report.entries import (
    Added,
    Curve,
    Interval,
    Intervals,
    LogEntry,
    Looked,
    Role,
    SimulatedPosition,
    Torsion,
    table_of,
)
from frictionjoint.report.error_figures import possible_noise

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Verdict = Literal["explained", "partly-explained", "no-effect-found", "too-short-to-tell"]
SCHEMA = "frictionjoint/report-1"


@dataclass(frozen=True, repr=False)
class Report:
    """Result of `close_loop`.

    Attributes follow report.json; `laws` (before and after), `curves` and `rankings` serve the
    page. `thresholds`: of the search, by name. `closed_loops` (before, and after without
    refinement) and the controller are None without a controller; `refined` is None if it was not
    requested; `posterior` is None if the logs determine no torque scale. Intervals are those of the
    rms before and after, 95%, on held-out logs if there are any; None if these are too short.
    `reconstructed`: the drive was not measured but computed from the controller. `units` are those
    of torque and position: N m and rad, or N and m for a slide. If the logs do not determine the
    torque per current or voltage, torques are in A or V, or divided by an unknown kp in rad or m;
    then there is no replay and the model contains no friction. `carried` is the friction in
    model.xml; None if it contains none. `positions` are the simulated positions of the logs; empty
    if nothing was simulated.
    `recordings` states how each number varies between recordings, if there are three or more.
    `smallest`: the smallest further effects that the logs would show, see `detection_limit`.
    `law_errors`: rms in motion on fitted logs of each law with the same effects.
    `unexplained_causes`: of some unexplained dependences the likely cause, in a sentence.

    For a joint of a robot, `base` and the errors before are those of the law alone with the user's
    model; `other_before` says whether `curves` and `positions` before are of another model, the one
    with the causes that joints share. `increase` is the 95% paired interval of the increase of each
    held-out error that increased, by its name. `torsion` is the gear between two encoders.
    """

    joint: str
    slide: bool
    units: tuple[str, str]
    logs: tuple[LogEntry, ...]
    base: dict[str, Estimate]
    final: dict[str, Estimate]
    before_torque: Rms
    before_replay: Rms
    added: tuple[Added, ...]
    after_torque: Rms
    after_replay: Rms
    torque_interval: Intervals | None
    replay_interval: Intervals | None
    measured_rms: float
    bandwidth_hz: float
    noise_floor: float | None
    unexplained: tuple[tuple[str, float], ...]
    verdict: Verdict
    mjcf: str
    seconds: float
    laws: tuple[Friction, Friction] = field(repr=False)
    curves: tuple[Curve, ...] = field(repr=False)
    rankings: tuple[Looked, ...] = field(repr=False)
    thresholds: Mapping[str, float] = field(repr=False)
    proposals: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    closed_loops: tuple[LoopErrors | None, LoopErrors] | None = field(default=None, repr=False)
    refined: RefinedModel | None = None
    controller: Controller | None = None
    reconstructed: bool = False
    posterior: Posterior | None = field(default=None, repr=False)
    carried: JointFriction | None = field(default=None, repr=False)
    positions: tuple[SimulatedPosition, ...] = field(default=(), repr=False)
    recordings: tuple[dict[str, Any], ...] = field(default=(), repr=False)
    smallest: tuple[Any, ...] = field(default=(), repr=False)
    law_errors: Mapping[str, float] = field(default_factory=dict, repr=False)
    unexplained_causes: Mapping[str, str] = field(default_factory=dict)
    other_before: bool = False
    increase: Mapping[str, Interval] = field(default_factory=dict, repr=False)
    torsion: Torsion | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        added = ", ".join(x.effect for x in self.added) or "nothing"
        return f"Report(joint={self.joint!r}, verdict={self.verdict!r}, added: {added})"

    def summary(self) -> str:
        """The verdict, the errors and the friction numbers as text, as the command line prints."""
        from frictionjoint.report.text import summary_text

        return summary_text(self.to_dict())

    def plot(self) -> "Figure":
        """Friction-speed curve, torque and position of the worst held-out stretch (matplotlib)."""
        from frictionjoint.report.picture import draw

        return draw(self)

    def drive_rms(self, stage: Literal["before", "after"]) -> Rms:
        """rms of the drive in motion, as the controller's file says or as effects of the drive
        change it, in the unit of torque; None for a role without logs."""

        def rms(role: Role) -> float | None:
            own = (c for c in self.curves if c.role == role)
            drives = [(c.given if stage == "before" else c.measured)[c.in_motion] for c in own]
            together = np.concatenate([*drives, np.zeros(0)])
            return root_mean_square(together) if len(together) else None

        return Rms(rms("fit"), rms("held-out"))

    def _at_rest(self) -> float:
        """Fraction of the fitted samples whose torque the position does not determine."""
        moving = [c.in_motion for c in self.curves if c.role == "fit"]
        return 1.0 - float(np.mean(np.concatenate(moving))) if moving else 0.0

    def _log_errors(self) -> list[dict[str, Any]]:
        """rms errors of the torque in motion of each log, before and after."""
        found = []
        for c in self.curves:
            on = c.in_motion
            before, after = (
                root_mean_square((c.measured - x)[on]) if on.any() else None
                for x in (c.before, c.after)
            )
            own = None if self.other_before else before
            found.append({"name": c.name, "role": c.role, "before": own, "after": after})
        return found

    @property
    def worse(self) -> tuple[str, ...]:
        """Held-out errors that are clearly larger after the change of the model.

        The increase must exceed its confidence interval, and the squared error must grow by a
        noticeable fraction. No shared cause may add such an increase to a joint.
        """
        pairs = {
            "torque_rms": (self.before_torque.held_out, self.after_torque.held_out),
            "replay_rms": (self.before_replay.held_out, self.after_replay.held_out),
        }
        found = []
        for name, (low, _) in self.increase.items():
            before, after = pairs[name]
            assert before is not None
            assert after is not None
            if low > 0.0 and after**2 > (1.0 + CLEARLY) * before**2:
                found.append(name)
        return tuple(found)

    @property
    def above_noise(self) -> bool:
        """Whether the error on fitted logs is above the instruments' noise, if that is known."""
        noise, left = self.noise_floor or 0.0, self.after_torque.fit or 0.0
        return noise >= LEAST_NOISE * self.measured_rms and left > AT_THE_FLOOR * noise

    @property
    def changed(self) -> bool:
        """Whether the result differs from the base fit: effects were added, or the law changed."""
        return bool(self.added) or self.laws[0].law != self.laws[1].law

    def samples(self, n: int, seed: int = 0) -> tuple[JointFriction, ...]:
        """Parameter sets drawn from the uncertainty of the result, for `frictionjoint.install`.

        Raises:
            ParameterError: the logs determine no torque scale; fewer than one sample requested.
        """
        if self.posterior is None:
            raise ParameterError("no samples: the logs do not determine the friction's scale")
        return self.posterior.sample(n, seed)

    def _repr_html_(self) -> str:
        from frictionjoint.report.picture import report_html

        return report_html(self)

    def _staged(self, pair: Intervals | None) -> dict[str, Interval] | None:
        """An interval before and one after, as in report.json; none of another model's errors."""
        if pair is None:
            return None
        return {"after": pair[1]} if self.other_before else {"before": pair[0], "after": pair[1]}

    def to_dict(self) -> dict[str, Any]:
        """The content of report.json."""
        carried, refined = self.carried, self.refined
        before, balance = self.closed_loops or (None, None)
        after = (refined.loops if refined and refined.taken else None) or balance
        optional = {
            # compared with the fit to torque
            "refined": refined.to_dict() | _figures(balance, "balance_") if refined else None,
            "posterior": self.posterior,
            "recordings": self.recordings,
            "unexplained_causes": self.unexplained_causes,
            "model": toml_document(carried.parameters, carried.effects).unwrap()
            if carried
            else None,
        }
        content = table_of(
            {
                "schema": SCHEMA,
                "joint": self.joint,
                "units": {"torque": self.units[0], "position": self.units[1]},
                "logs": self.logs,
                "log_errors": self._log_errors(),
                "slide": self.slide,
                "drive": {
                    "source": "controller" if self.reconstructed else "measured",
                    "rms": {"before": self.drive_rms("before"), "after": self.drive_rms("after")},
                },
                "intervals": {
                    "torque_rms": self._staged(self.torque_interval),
                    "replay_rms": self._staged(self.replay_interval),
                },
                "bandwidth_hz": self.bandwidth_hz,
                "at_rest": self._at_rest(),
                "base": {"law": self.laws[0].law, "parameters": self.base},
                "before": {
                    "torque_rms": self.before_torque,
                    "replay_rms": self.before_replay,
                    **_figures(before),
                },
                "added": self.added,
                "after": {
                    "law": self.laws[1].law,
                    "parameters": self.final,
                    "torque_rms": self.after_torque,
                    "replay_rms": self.after_replay,
                    **_figures(after),
                },
                **{name: x for name, x in optional.items() if x},
                "thresholds": self.thresholds,
                "candidates": self.rankings,
                "smallest": self.smallest,
                "law_errors": self.law_errors,
                "noise_floor": self.noise_floor,
                "unexplained": [{"variable": v, "share": s} for v, s in self.unexplained],
                "proposals": self.proposals,
                "notes": self.notes,
                "verdict": self.verdict,
            }
        )
        # no noise above an error that it states
        return content | {"noise_floor": possible_noise(content)}

    def in_robot(self) -> dict[str, Any]:
        """The content for one joint of a robot: without the parts that belong to the robot."""
        own = {k: x for k, x in self.to_dict().items() if k not in ("schema", "joint", "logs")}
        more = {"measured_rms": self.measured_rms, "increase": self.increase, "worse": self.worse}
        return own | table_of(more | ({"torsion": self.torsion} if self.torsion else {}))


def _figures(loops: LoopErrors | None, prefix: str = "") -> dict[str, Any]:
    return {prefix + key: x for key, x in loops.figures().items()} if loops else {}
