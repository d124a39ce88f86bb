"""The text ``<custom><text name="frictionjoint-assumed:JOINT">``: what is assumed about a
friction."""

import mujoco

from frictionjoint.simulate.model_view import without_tag

ASSUMED = "frictionjoint-assumed:"


def remove_assumed(spec: mujoco.MjSpec, joint: str) -> None:
    """Remove the text of a joint from a spec, also with a prefix of ``MjSpec.attach``.

    Args:
        spec: changed in place.
        joint: name, with its prefix.
    """
    for text in list(spec.texts):
        if without_tag(text.name, ASSUMED) == joint:
            spec.delete(text)
