"""Numbers of a plant's friction that an answer about its logs is compared with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# with these the plant has no one friction level and viscosity to compare with
_WARM = {"temperature-dependent", "warm-up-drift"}


def logged_friction(truth: Mapping[str, Any]) -> dict[str, float]:
    """Coulomb torque `Fc` and viscosity `sigma2`, N m and N m s/rad, as the logged torque has them.

    A motor constant that is off scales the friction in a log with all the rest, and `torque-gain`
    is stated for the load alone (its form in the catalogue says so).

    Args:
        truth: the sealed answer of a trial.
    Returns:
        nothing where the friction warms up.
    """
    effects = {e["name"]: e for e in truth["effects"]}
    if effects.keys() & _WARM:
        return {}
    gain = 1.0 + effects.get("torque-gain", {}).get("error", 0.0)
    friction = truth["friction"]
    return {"Fc": gain * friction["Fc_pos"], "sigma2": gain * friction["sigma2"]}
