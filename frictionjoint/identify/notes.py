"""Notes on a fit: one or two sentences each."""

import numpy as np

from frictionjoint.effects.signals import GX, GY, LOAD, A, V
from frictionjoint.errors import LogError, few
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.result import LOOSE, law_estimates, law_parameters
from frictionjoint.identify.segment import Prepared

_SLOW = "record slow constant velocities in both directions, where viscous friction is small"
# of the drive: a law that leaves more does not suit the joint, or the logs not the model
LARGE = 0.2
CAUSES = "check units and zeros, or search for the cause with `frictionjoint close-loop`"


def inertia_note(prepared: Prepared, fitted: Fit) -> tuple[str, ...]:
    """Note that the torque scale depends on the inertia in the MJCF, if gravity is too small."""
    if "load" not in fitted.names or fitted.in_drive_units:
        return ()
    signals = np.concatenate([s.at_kept(s.signals) for s in prepared.segments])
    # of a slide gravity is one force, of a hinge it turns with the link
    pull = np.ones((len(signals), 1)) if prepared.slide else signals[:, [GX, GY]]
    both = np.column_stack([signals[:, A], pull])
    gravity = pull @ np.linalg.lstsq(both, signals[:, LOAD], rcond=1e-6)[0][1:]
    per_torque = float(fitted.beta[fitted.names.index("load")])
    if per_torque * np.sqrt(np.mean(gravity**2)) > fitted.rms:
        return ()
    return (
        "Gravity barely loads this joint, so the torque scale comes from the MJCF's inertia alone: "
        "if that inertia is wrong by a factor, so are all torques. Give --gain, or record motion "
        "with a known payload against gravity.",
    )


def other_drive_note(*logs: Prepared | None) -> tuple[str, ...]:
    """Note on parts of logs that are left out because another drive turns the joint."""
    return tuple(
        f"{segment.name}: {begin:.4g} to {end:.4g} s are left out: the logged drive is exactly 0, "
        "but the joint does not slow down as friction would require, so another drive moves it."
        for prepared in logs
        if prepared
        for segment in prepared.segments
        for begin, end in segment.turned_by_another
    )


def require_level(prepared: Prepared, fitted: Fit) -> None:
    """Raise LogError if the law has no Coulomb friction because the logs do not determine it."""
    if not (fitted.has_level or _shows_no_level(prepared, fitted)):
        names = few([s.name for s in prepared.segments])
        why, share = _one_way(prepared, fitted), fitted.rms / fitted.target_rms
        if share > LARGE and not why:
            raise LogError(f"{names}: the law leaves {share:.0%} of the {prepared.drive}: {CAUSES}")
        raise LogError(f"{names}: does not determine Coulomb friction{why}: {_SLOW}")


def _shows_no_level(prepared: Prepared, fitted: Fit) -> bool:
    """Whether the logs determine the Coulomb friction of a fit without it."""
    cov = stated_covariance(prepared, fitted)
    error = law_estimates(fitted, cov, prepared.slide)["Fc_pos"].stderr
    # twice this error would be as large as the residual, and still not be seen
    return error is not None and error <= LOOSE * fitted.rms_in_motion


def _one_way(prepared: Prepared, fitted: Fit) -> str:
    """Why a motion does not determine Coulomb friction, if it is one in a single direction."""
    forward = float(np.mean(prepared.at_kept(V)[fitted.in_motion] > 0.0))
    return "" if 0.01 < forward < 0.99 else ", because the joint moves in one direction only"


def assumed_note(prepared: Prepared, fitted: Fit) -> tuple[str, ...]:
    """Notes on what is assumed, or that the law has no Coulomb friction."""
    if not fitted.has_level:
        said = "show no Coulomb friction: its fitted value is zero"
        if not _shows_no_level(prepared, fitted):
            why = _one_way(prepared, fitted)
            said = f"do not determine Coulomb friction{why}; its fitted value, zero, says nothing"
        return (
            f"These logs {said}. The model therefore does not hold the joint at rest. "
            f"{_SLOW[0].upper()}{_SLOW[1:]}.",
        )
    shape = fitted.shape
    found = []
    if fitted.level_assumed:
        found.append(
            "The Coulomb friction of the unloaded joint is assumed: these logs do not determine "
            "it, because they always load the joint. Record motion with less load."
        )
    if shape.stiffness_assumed:
        found.append(
            "The presliding stiffness is assumed: these logs do not determine it. It is as high as "
            "encoder and sample time resolve, or higher if the logs require it, so that the joint "
            "sticks."
        )
    elif shape.steep_start:
        found.append(
            "The beginning of the presliding curve is assumed: with the fitted curve the simulated "
            "joint would ring instead of coming to rest. Up to 0.5% of breakaway friction it is "
            "steeper than fitted."
        )
    if shape.breakaway_assumed:
        law = law_parameters(fitted).to_dict()
        ratio = round(float(law["Fs_pos"] / law["Fc_pos"]), 3)
        times = f"is {ratio:.3g} times" if ratio > 1.0 else "equals"
        least = ", the smallest value that the logs allow" if ratio > 1.0 else ""
        found.append(
            "The breakaway friction is assumed: these logs do not determine it. It "
            f"{times} Coulomb friction{least}."
        )
    return tuple(found)
