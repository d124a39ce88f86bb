"""Friction parameters inside a model: ``<custom><numeric name="frictionjoint:JOINT">``.

MuJoCo writes six digits of a number into XML. So a block contains each number twice: once as a
plain number, for a reader and for the callback, and once as four 16-bit integers, from which the
exact double is restored when the block is resolved. A block is

    0 MAGIC   1 version   2 resolved   3 qpos address   4 dof address   5 address of the state row
    6 id of the joint   7 count of numbers N   8 where the effects begin
    9.. N numbers: the law's block, then the effects' block       then 4 N integers

A plain number that a user has changed, in its first six digits, is used instead of its double.

Slots 2 to 6 belong to one compiled model. `carrier.resolve` writes them, by name, so that
``MjSpec.attach`` with a prefix works and the callback never looks up a name. Slot 2 is then 1; it
is -1 if the callback met a model that cannot be resolved (`resolve_when_stepped`). If the model is
not yet in use, `resolve` moves its blocks together without the integers, so that a step of many
joints reads a quarter of the memory.

What is assumed about a friction is ``<custom><text name="frictionjoint-assumed:JOINT">``.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.errors import ModelError
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.simulate.layout import ModelView, structure
from frictionjoint.simulate.row import row_size

MAGIC = 199797.0
VERSION = 1.0
RESOLVED, QPOS, DOF, ROW, JOINT, COUNT, EFFECTS = range(2, 9)
HEAD = EFFECTS + 1
REFUSED = -1.0
TAG, ASSUMED = "frictionjoint:", "frictionjoint-assumed:"
# models whose data were found to lack room, by address
rooms_missed: set[int] = set()


def blocks(model: mujoco.MjModel | ModelView) -> dict[str, int]:
    """Address in ``numeric_data`` of each joint's block, by joint name."""
    return tagged_numerics(model, TAG)


def names_of(model: mujoco.MjModel | ModelView, kind: str) -> list[str]:
    """Names of all objects of a kind, as mjModel abbreviates it ("jnt"), "" for one without."""
    letters = bytes(model.names)
    begins = getattr(model, f"name_{kind}adr")
    return [letters[begin : letters.index(0, begin)].decode() for begin in begins]


def without_tag(name: str, tag: str) -> str | None:
    """A name without its tag, which `MjSpec.attach` may have put behind a prefix; None if there is
    no tag."""
    prefix, own, rest = name.partition(tag)
    return prefix + rest if own else None


def tagged_numerics(model: mujoco.MjModel | ModelView, tag: str) -> dict[str, int]:
    """Address in ``numeric_data`` of each numeric with a tag in its name, by the rest of it."""
    names = (without_tag(name, tag) for name in names_of(model, "numeric"))
    pairs = zip(names, model.numeric_adr, strict=True)
    return {name: int(address) for name, address in pairs if name is not None}


def rows_of_block(block: Sequence[float] | Array) -> int:
    """Number of float64 of user data for a joint with this block."""
    numbers = np.asarray(block, dtype=np.float64)
    n_effects = int(numbers[int(numbers[EFFECTS])])
    return row_size(int(law_row_size(numbers, HEAD)), n_effects)


def effects_of(P: Sequence[float] | Array, at: int) -> list[tuple[float, int]]:
    """Id of each effect of the block of effects at P[at], and where its numbers begin."""
    found = []
    count, at = int(P[at]), at + 1
    for _ in range(count):
        found.append((float(P[at]), at + 2))
        at += 2 + int(P[at + 1])
    return found


def have_rows(blocks: Sequence[Sequence[float]], nuserdata: int) -> bool:
    """Whether `nuserdata` numbers of user data include the rows of all blocks of a model or spec;
    blocks that were added by ``MjSpec.attach`` have none."""
    need = sum(rows_of_block(block) for block in blocks)
    known = (block[ROW] - 1 for block in blocks if block[RESOLVED] == 0.0 < block[ROW])
    return need <= nuserdata and all(own + need == nuserdata for own in known)


def make_room(model: mujoco.MjModel, need: int) -> None:
    """Add numbers to a compiled model's user data for the friction; its own stay in front.

    ``MjSpec.attach`` and MJCF's ``<attach>`` keep the parameters that a child model carries and
    drop its ``nuserdata``. MuJoCo lays out the next ``mujoco.MjData(model)`` by the model's
    ``nuserdata``. Data made before have too little, and the callback leaves them alone
    (`native.lacks_room`); MuJoCo itself refuses to copy between the two.

    Raises:
        ModelError: MuJoCo's reset of existing data would then write past the end of these data.
    """
    own, data = int(model.nuserdata), mujoco.MjData(model)
    fields = structure("mjData").from_address(data._address)
    behind = (fields.buffer or 0) + fields.nbuffer - (fields.userdata or 0)
    if behind < model.numeric_data.itemsize * (own + need):
        raise ModelError(
            f'friction needs {need} numbers of user data: write <size nuserdata="{own + need}"/> '
            "in the MJCF, or set nuserdata of the spec"
        )
    structure("mjModel").from_address(model._address).nuserdata = own + need
    rooms_missed.discard(model._address)


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
