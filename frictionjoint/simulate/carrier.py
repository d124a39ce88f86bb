"""Write friction into a model and read it, see `block` for the form."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.arguments import require_friction, require_path, require_spec
from frictionjoint.arrays import Array
from frictionjoint.effects.catalogue import SIMULATED
from frictionjoint.effects.heating import EFFECT as HEATING
from frictionjoint.errors import ModelError
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.laws import unpack
from frictionjoint.model_files import ONE_DOF, compiling, not_xml
from frictionjoint.mujoco_warnings import as_python_warnings
from frictionjoint.parameters import Friction
from frictionjoint.simulate import block as slot
from frictionjoint.simulate.block import TAG, blocks, have_rows, make_room, names_of, rows_of_block
from frictionjoint.simulate.layout import ModelView
from frictionjoint.simulate.mechanism import DEFLECTION, add_mechanism, delay_sensors, require_place
from frictionjoint.simulate.motor import check_motors, gives_less
from frictionjoint.simulate.native_friction import (
    clear_native_friction,
    counts_twice,
    native_friction_of_spec,
)
from frictionjoint.simulate.shaft_wave import resolve_waves
from frictionjoint.simulate.uninstall import carrying, take_out

# MuJoCo 4.0.0 writes what is a 1e-12th of the largest number as zero
LARGEST = 1e11


def install(
    spec: mujoco.MjSpec,
    friction: Mapping[str, Friction],
    effects: Mapping[str, Sequence[SimulatedEffect]] | None = None,
    clear_native: bool = False,
    replace: bool = False,
) -> None:
    """Write friction into a spec and reserve room for its state in ``userdata``.

    Existing user data of the model stays in front. An elastic joint, or one with backlash, gets
    another joint behind it, and a delayed instrument delayed sensors (``simulate.mechanism``). A
    warning says if friction would count twice.

    Args:
        spec: changed in place, only if every joint is suitable.
        friction: parameters by joint name.
        effects: effects beyond the law by joint name.
        clear_native: remove the joints' own ``frictionloss`` and ``damping``, also the damping of
            ``springdamper``.
        replace: replace the friction of joints that have some already.
    Raises:
        TypeError: a path or a compiled model instead of a spec, a dict instead of parameters.
        ModelError: unknown joint, not a hinge or slide, existing friction, or a number too large
            for an MJCF.
    """
    require_spec(spec)
    require_friction(friction)
    joints = {joint.name: joint for joint in spec.joints if joint.name}
    replaced = [name for name in carrying(spec) if name in friction]
    for name in [*friction, *(effects or {})]:
        if name not in joints:
            raise ModelError(f"no joint {name!r}: the model has {', '.join(joints) or 'none'}")
        if int(joints[name].type) not in ONE_DOF:
            kind = mujoco.mjtJoint(joints[name].type).name.removeprefix("mjJNT_").lower()
            raise ModelError(
                f"joint {name!r} is a {kind} joint: only hinge and slide joints can have friction"
            )
        if name not in friction:
            raise ModelError(f"joint {name!r} has effects but no friction law: give both")
        if name in replaced and not replace:
            raise ModelError(
                f"joint {name!r} has friction already: install(..., replace=True), or "
                "`frictionjoint install --replace`, replaces it"
            )
        elastic = any(e.effect.acts == "mechanism" for e in (effects or {}).get(name, ()))
        if elastic and not (name in replaced and name + DEFLECTION in joints):
            require_place(spec, name)
    carried = {name: heating_first((effects or {}).get(name, ())) for name in friction}
    made = {
        name: _encode(parameters.pack(), carried[name]) for name, parameters in friction.items()
    }
    for name, block in made.items():
        largest = float(np.abs(block).max())
        if largest > LARGEST:
            raise ModelError(
                f"joint {name!r} has a parameter of {largest:g}, next to which an MJCF loses "
                f"small ones: stay below {LARGEST:g}"
            )
    if replaced:
        take_out(spec, replaced)
    there = [numeric.data for numeric in spec.numerics if TAG in numeric.name]
    own = max(0, spec.nuserdata - sum(rows_of_block(block) for block in there))
    for name, block in made.items():
        # larger whole numbers do not survive six digits
        block[slot.ROW] = own + 1 if own < 999_999 else 0
        numeric = spec.add_numeric(name=TAG + name, data=block, size=len(block))
        assert numeric is not None
        spec.nuserdata = max(spec.nuserdata, 0) + rows_of_block(block)
        mechanical = [(e.effect, e.numbers) for e in carried[name] if e.effect.acts == "mechanism"]
        if mechanical:
            add_mechanism(spec, name, mechanical)
        for effect in carried[name]:
            if effect.effect.acts == "sensors" and effect.shape[0] != 0.0:
                delay_sensors(spec, name, effect.shape[0])
    if clear_native:
        clear_native_friction(spec, friction)
    native = native_friction_of_spec(spec, friction)
    if native:
        warnings.warn(counts_twice(native), RuntimeWarning, stacklevel=2)


def heating_first(effects: Sequence[SimulatedEffect]) -> list[SimulatedEffect]:
    """Sort heating first, because it computes the temperature for the others."""
    return sorted(effects, key=lambda e: e.effect is not HEATING)


def _encode(law: Array, effects: list[SimulatedEffect]) -> Array:
    numbers = np.concatenate([law, [float(len(effects))], *(e.pack() for e in effects)])
    head = np.array([slot.MAGIC, slot.VERSION, 0, 0, 0, 0, 0, len(numbers), slot.HEAD + len(law)])
    # four 16-bit integers for each double, which XML keeps exactly
    integers = np.frombuffer(numbers.astype("<f8").tobytes(), dtype="<u2").astype(np.float64)
    return np.concatenate([head, numbers, integers])


def resolve(model: mujoco.MjModel | ModelView, in_userdata: bool = True) -> dict[str, int]:
    """Write addresses and exact numbers into a model's own blocks; returns their addresses.

    Args:
        in_userdata: whether the state is stored there. A model with too little gets room for data
            made from now on; a model that is being stepped, a `ModelView`, does not.
    Raises:
        ModelError: a block without its joint, of another version or damaged, too little
            ``userdata``, or a motor that delivers less than commanded and cannot be followed.
    """
    found = blocks(model)
    ids = {name: i for i, name in enumerate(names_of(model, "jnt")) if name}
    sizes, made = {}, []
    for name, at in found.items():
        _check_block(model, name, at, ids)
        begin = at + slot.HEAD
        end = begin + int(model.numeric_data[at + slot.COUNT])
        exact = model.numeric_data[begin:end]
        if _size(model, at) > end - at:
            exact[:] = _exact(exact, model.numeric_data[end : end + 4 * len(exact)])
        carried = _friction_at(model, name, at).effects
        mechanical = [e.effect.name for e in carried if e.effect.acts == "mechanism"]
        if mechanical and name + DEFLECTION not in ids:
            raise ModelError(
                f"joint {name!r} has {mechanical[0]}, but its joint {name + DEFLECTION!r} is "
                "missing: install the friction again"
            )
        made.append(model.numeric_data[at:end])
        sizes[name] = rows_of_block(made[-1])
    need = sum(sizes.values())
    if in_userdata and not have_rows(made, model.nuserdata):
        if isinstance(model, ModelView):
            raise ModelError(
                f"friction of {len(found)} joints needs {need} numbers of user data, the model has "
                f"{model.nuserdata}: call frictionjoint.attach(model) before "
                f'mujoco.MjData(model), or write <size nuserdata="{need}"/> in the MJCF'
            )
        make_room(model, need)
    if isinstance(model, mujoco.MjModel) and not any(
        model.numeric_data[at + slot.RESOLVED] for at in found.values()
    ):
        _move_together(model)
        found = blocks(model)
    row = model.nuserdata - need
    for name, at in found.items():
        joint = ids[name]
        if gives_less(model.numeric_data, at + int(model.numeric_data[at + slot.EFFECTS])):
            check_motors(model, name, joint)
        model.numeric_data[at + slot.QPOS] = model.jnt_qposadr[joint]
        model.numeric_data[at + slot.DOF] = model.jnt_dofadr[joint]
        model.numeric_data[at + slot.JOINT] = joint
        model.numeric_data[at + slot.ROW] = row
        row += sizes[name]
    resolve_waves(model)
    # last: another thread may be looking
    for at in found.values():
        model.numeric_data[at + slot.RESOLVED] = 1.0
    return found


def _size(model: mujoco.MjModel | ModelView, at: int) -> int:
    """Number of elements for which a block has room."""
    return int(model.numeric_size[np.flatnonzero(np.asarray(model.numeric_adr) == at)[0]])


def _exact(plain: Array, integers: Array) -> Array:
    """The doubles that four integers each hold, and each number that was changed by hand."""
    exact = np.frombuffer(integers.astype("<u2").tobytes(), dtype="<f8").copy()
    lost = 10.0 / LARGEST * np.abs(exact).max()
    for i in np.flatnonzero(plain != exact):
        written = 0.0 if plain[i] == 0.0 and abs(exact[i]) < lost else float(f"{exact[i]:.6g}")
        if plain[i] != written:
            exact[i] = plain[i]
    return exact


def _move_together(model: mujoco.MjModel) -> None:
    """Move the blocks of numerics that follow one another together, without their integers."""
    to = end = -1
    for i, name in enumerate(names_of(model, "numeric")):
        at, size = int(model.numeric_adr[i]), int(model.numeric_size[i])
        if TAG not in name:
            continue
        n = slot.HEAD + int(model.numeric_data[at + slot.COUNT])
        if at != end:
            to = at
        end = at + size
        model.numeric_data[to : to + n] = model.numeric_data[at : at + n].copy()
        model.numeric_adr[i], model.numeric_size[i] = to, n
        to += n


def _check_block(
    model: mujoco.MjModel | ModelView, name: str, at: int, ids: Mapping[str, int]
) -> None:
    head = model.numeric_data[at : at + slot.HEAD]
    where = f"numeric {TAG}{name}"
    size = _size(model, at)
    if size < slot.HEAD or head[0] != slot.MAGIC:
        raise ModelError(f"{where} is no friction block: install the friction again")
    if head[1] != slot.VERSION:
        raise ModelError(f"{where} has version {head[1]:g}, this package reads {slot.VERSION:g}")
    if not np.isfinite(head).all() or np.any(head != np.round(head)):
        raise ModelError(f"{where} was edited by hand: install the friction again")
    short = slot.HEAD + int(head[slot.COUNT])
    whole = 5 * short - 4 * slot.HEAD
    if size not in (short, whole) or not slot.HEAD < head[slot.EFFECTS] < short:
        raise ModelError(f"{where} has {size} numbers, not {whole}: install it again")
    pieces = model.numeric_data[at + short : at + size]
    if np.any((pieces != np.round(pieces)) | (pieces < 0.0) | (pieces > 65535.0)):
        raise ModelError(f"{where} was edited by hand: install the friction again")
    if name not in ids:
        raise ModelError(
            f"{where} belongs to joint {name!r}, which the model lacks (it has "
            f"{', '.join(ids) or 'none'}): delete that numeric too, or take friction away with "
            "frictionjoint.uninstall before you delete or rename the joint"
        )
    if int(model.jnt_type[ids[name]]) not in ONE_DOF:
        raise ModelError(f"{where}: joint {name!r} is neither a hinge nor a slide")


def read_effects(numbers: Array, where: str) -> tuple[SimulatedEffect, ...]:
    """Read a block of effects: their count, then id, length and numbers of each; a ModelError that
    names `where` if it is damaged."""
    known = {float(effect.effect_id): effect for effect in SIMULATED}
    found, at = [], 1
    while np.isfinite(numbers).all() and at + 1 < len(numbers):
        effect = known.get(float(numbers[at]))
        if effect is None or numbers[at + 1] != effect.size:
            break
        values = tuple(float(x) for x in numbers[at + 2 : at + 2 + effect.size])
        cut = len(effect.shape)
        found.append(SimulatedEffect(effect, values[:cut], values[cut:]))
        at += 2 + effect.size
    if at != len(numbers) or numbers[0] != len(found):
        raise ModelError(f"{where} contains damaged effects: install the friction again")
    return tuple(found)


def read_friction(model: mujoco.MjModel) -> dict[str, JointFriction]:
    """Friction in a model, by joint name, exactly as it was installed."""
    return {name: _friction_at(model, name, at) for name, at in resolve(model).items()}


def _friction_at(model: mujoco.MjModel | ModelView, name: str, at: int) -> JointFriction:
    """Friction in a block with its exact numbers."""
    first, law = at + slot.HEAD, int(model.numeric_data[at + slot.EFFECTS]) - slot.HEAD
    numbers = np.array(model.numeric_data[first : first + int(model.numeric_data[at + slot.COUNT])])
    parameters = unpack(numbers[:law])
    return JointFriction(parameters, read_effects(numbers[law:], f"numeric {TAG}{name}"))


def load_model(path: str | Path) -> mujoco.MjModel:
    """Load an MJCF with friction, ready for `attach`.

    Raises:
        ModelError: the file does not compile, or has no friction or damaged friction.
        TypeError: `path` is no path.
    """
    require_path(path, "load_model")
    if not Path(path).is_file():
        what = "a folder" if Path(path).is_dir() else "no such file"
        raise ModelError(f"{path}: {what}, give the path of an MJCF")
    with as_python_warnings(), compiling():
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
            carried = resolve(model)
        except ValueError as error:
            raise ModelError(f"{path}: {not_xml(path) or error}") from None
        if not carried:
            raise ModelError(f"{path} has no friction: add it with `frictionjoint install`")
    return model
