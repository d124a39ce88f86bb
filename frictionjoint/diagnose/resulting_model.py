"""The model of one joint that a search and a refinement by simulation lead to."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from frictionjoint.diagnose.by_motion import named_by_motion
from frictionjoint.diagnose.finding import Trace
from frictionjoint.diagnose.joint_logs import JointLogs
from frictionjoint.identify.early_checks import check_fit, load_shows, scale_is_determined
from frictionjoint.identify.fit import Fit, with_gain
from frictionjoint.identify.segment import Prepared
from frictionjoint.refine.refine import Refined, RefinedModel, refine
from frictionjoint.replay.closed_loop import LoopErrors, driven_courses
from frictionjoint.replay.free_runs import simulated_whole
from frictionjoint.replay.windows import RUN_S


@dataclass(frozen=True)
class ResultingModel:
    """The model that the logs lead to."""

    trace: Trace
    fit: Fit  # what the simulation model contains
    kept_back: Prepared | None  # held-out logs, corrected as the fitted ones
    load_shows: bool  # whether the load determines the gain of the drive
    scaled: bool  # whether torques are known in N m
    closed: tuple[LoopErrors, ...]  # logs in closed loop, by the first and last fit to torque
    outcome: Refined | None  # of the refinement by simulation
    refined: RefinedModel | None

    @property
    def taken(self) -> RefinedModel | None:
        """The refinement, if it is the result."""
        return self.refined if self.refined and self.refined.taken else None


def resulting_model(
    logs: JointLogs, found: Trace, asked: bool | None, progress: Callable[[str], None]
) -> ResultingModel:
    """Refine the outcome of a search by simulation, and state it in units of the drive if the gain
    is unknown.

    Args:
        asked: whether to refine, see `commands.close_loop`.
    """
    kept_back = found.as_fitted(logs.kept_back) if logs.kept_back else None
    loops, body, shows = logs.loops, logs.body, load_shows(found.final)
    if shows and not load_shows(found.base):
        # without the effects the drive may hide the load: the motor is that of the found model
        found = replace(found, base=with_gain(found.base, found.final.gain))
    scaled = shows and scale_is_determined(found.prepared, found.final)
    closed: tuple[LoopErrors, ...] = ()
    outcome, refined = None, None
    if loops and shows:
        # if the load is weakly excited the gain is poorly determined: the best one, with its error
        if asked is not False:
            found, outcome = named_by_motion(found, loops.fit, body.armature, progress)
            # a gain with a standard error as large as itself may be any
            scaled = scaled or (outcome.taken and outcome.gain_error < 1.0)
            refined = RefinedModel.of(outcome, loops, body.slide, scaled)
        closed = loops.errors((found.base, found.final))
    elif asked and scaled and simulated_whole(found.final, body.armature, in_closed_loop=True):
        # runs from the measured motion, driven by the measured drive (multiple shooting)
        courses = driven_courses(logs.fitted, logs.bodies, found.prepared, RUN_S)
        outcome = refine(found.prepared, found.final, courses, progress)
        refined = RefinedModel.of(outcome, None, body.slide, scaled)
    best = outcome.fit if outcome else found.final
    if not scaled:
        found = found.without_scale()
    check_fit(found.prepared, found.final)
    return ResultingModel(found, best, kept_back, shows, scaled, closed, outcome, refined)
