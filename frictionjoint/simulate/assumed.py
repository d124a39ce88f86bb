"""The text ``<custom><text name="frictionjoint-assumed:JOINT">``: what of a friction is assumed."""

import mujoco

ASSUMED = "frictionjoint-assumed:"


def remove_assumed(spec: mujoco.MjSpec, joint: str) -> None:
    """Take the text of a joint out of a spec, also behind the prefix of ``MjSpec.attach``.

    Args:
        spec: changed in place.
        joint: name, with its prefix.
    """
    for text in list(spec.texts):
        prefix, tag, rest = text.name.partition(ASSUMED)
        if tag and prefix + rest == joint:
            spec.delete(text)
