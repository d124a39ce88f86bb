"""What is assumed about a friction: ``<custom><text name="frictionjoint-assumed:JOINT">``."""

import mujoco

from frictionjoint.simulate.model_view import without_tag

ASSUMED = "frictionjoint-assumed:"


def assumed(model: mujoco.MjModel, joint: str) -> list[str]:
    """What is assumed about the friction of a joint, in one text; empty if nothing is."""
    names = (mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, i) for i in range(model.ntext))
    texts = zip(names, model.text_adr, model.text_size, strict=True)
    own = [(at, n) for name, at, n in texts if without_tag(name or "", ASSUMED) == joint]
    return [bytes(model.text_data[at : at + n - 1]).decode() for at, n in own]


def remove_assumed(spec: mujoco.MjSpec, joint: str) -> None:
    """Remove the text of a joint, its name with the prefix of ``MjSpec.attach``, from a spec."""
    for text in list(spec.texts):
        if without_tag(text.name, ASSUMED) == joint:
            spec.delete(text)
