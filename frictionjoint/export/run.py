"""One export: the text for a target, what it cannot represent, and the resulting errors."""

import os
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.describe import effect_texts
from frictionjoint.effects.catalogue import CATALOGUE
from frictionjoint.errors import ModelError
from frictionjoint.export import c, presliding, scripts, sliding
from frictionjoint.export.losses import Loss, losses
from frictionjoint.export.mjx import fit_for_mjx
from frictionjoint.export.motion import Motion, log_motions, stated_motion
from frictionjoint.export.sliding import PlainFriction, add_plain
from frictionjoint.export.targets import FILES, Target
from frictionjoint.export.urdf import urdf_text
from frictionjoint.joint_friction import JointFriction
from frictionjoint.law.motion import presliding_distance
from frictionjoint.model_joints import is_slide, mass_at_start
from frictionjoint.simulate.carrier import install, load_model, read_friction
from frictionjoint.simulate.shaft_wave import remove_waves, wave_losses
from frictionjoint.simulate.uninstall import take_out

# a constant torque, a spring
_SPRINGS = ("native", "mjx", "newton")
# effects that are joints, springs and sensors of the model
_MECHANICAL = frozenset(e.name for e in CATALOGUE if e.acts != "torque")


@dataclass(frozen=True)
class Exported:
    """Result of an export.

    Attributes:
        text: of the file. lost: what the target cannot represent, one sentence each.
        losses: errors, one row per joint; empty if the target represents everything.
    """

    text: str
    lost: tuple[str, ...]
    losses: tuple[Loss, ...] = ()


@dataclass(frozen=True)
class _Task:
    """Input of an export."""

    path: Path
    out: Path
    target: Target
    friction: dict[str, JointFriction]
    lugre: bool = False
    yielding: bool = False

    def spec(self, mechanism: bool = False) -> mujoco.MjSpec:
        """The model without its friction; with rigid joints, or with springs and gaps."""
        spec = mujoco.MjSpec.from_file(str(self.path))
        take_out(spec, list(self.friction), not mechanism)
        remove_waves(spec)
        return spec

    def rigid(self) -> mujoco.MjModel:
        """The model with its friction on rigid joints: the reference for an export."""
        spec = self.spec()
        carried = self.friction.items()
        effects = {n: [e for e in c.effects if e.effect.acts == "torque"] for n, c in carried}
        install(spec, {n: c.parameters for n, c in carried}, effects)
        return spec.compile()


def export(
    path: Path,
    target: Target,
    out: Path,
    speeds: tuple[float, float] | None = None,
    log: Path | None = None,
    columns: Mapping[str, str] | None = None,
    lugre: bool = False,
    yielding: bool = False,
    progress: Callable[[str], None] = lambda text: None,
) -> Exported:
    """Convert the friction of an MJCF for a target.

    Args:
        path: of the MJCF. out: of the file to write, for its name and its path to the model.
        speeds: lowest and highest, rad/s (m/s), over which a plain joint is fitted; None: see
            `stated_motion`, for Isaac those above the Stribeck range.
        log: its motion replaces the standard one, with `columns` ours -> the log's.
        lugre: for the native target: friction by MuJoCo's own LuGre. yielding: by springs that
            yield, MuJoCo 4.0.
    Raises:
        ModelError: no friction, or a model that the target cannot represent. LogError: a bad log.
    """
    model = load_model(path)
    friction = read_friction(model)
    waves = tuple(wave_losses(model))
    task = _Task(path, out, target, friction, lugre, yielding)
    if yielding and (lugre or target != "native"):
        raise ModelError("--yield is for the target native, without --lugre")
    if lugre and target != "native":
        raise ModelError(f"{target} has no LuGre friction: leave out --lugre")
    if target == "c":
        return Exported(c.header(friction, out.name), (*c.lost_effects(friction), *waves))
    if target == "mjlab":
        return Exported(scripts.mjlab_text(path, out, list(friction), model), waves)
    motions = _motions(task, model, speeds, log, columns or {})
    # coefficients of damping; MuJoCo's own is a polynomial
    terms = 3 if target == "native" else 1
    fast = target == "isaac" and speeds is None and log is None

    def over(name: str) -> Array:
        # Isaac has the fall from rest to sliding in a number of its own
        law = friction[name].parameters
        falls = sliding.stribeck_velocity(law) is not None
        return sliding.speeds_above_stribeck(law) if fast and falls else motions[name].speeds

    plain = {name: sliding.plain_friction(friction[name], over(name), terms) for name in motions}
    progress("losses along a motion")
    bare = task.spec().compile()
    actuators: dict[str, Array] = {}
    softened: dict[str, float] = {}
    refused: list[str] = []
    add: Callable[[mujoco.MjSpec], mujoco.MjSpec] = partial(add_plain, friction=plain)
    if lugre:
        fitted = {n: presliding.lugre_friction(friction[n].parameters, motions[n]) for n in motions}
        actuators = {name: presliding.lugre_torque(fitted[name], motions[name]) for name in motions}
        add = partial(presliding.add_lugre, lugre=fitted, plain=plain)
    elif yielding:
        springs = _springs(bare, friction, plain)
        softened = {name: x.softened for name, x in springs.items()}
        add = partial(presliding.add_yield_springs, springs=springs, plain=plain)
    if target in ("urdf", "newton", "isaac"):
        text, exported = _of_numbers(task, plain)
    else:
        whole, rigid = task.spec(mechanism=True), task.spec()
        if target == "mjx":
            fit_for_mjx(whole)
            refused = [f"MJX refuses {x}" for x in fit_for_mjx(rigid)]
        text, exported = _with_assets(add(whole), task), add(rigid).compile()
    # a joint slides once 99% of the change of friction behind a reversal is done
    before_sliding = {n: presliding_distance(friction[n].parameters, 0.99) for n in motions}
    found = losses(task.rigid(), bare, exported, motions, actuators, before_sliding)
    return Exported(text, (*_lost(task, plain, bare, softened), *refused, *waves), tuple(found))


def _motions(
    task: _Task,
    model: mujoco.MjModel,
    speeds: tuple[float, float] | None,
    log: Path | None,
    columns: Mapping[str, str],
) -> dict[str, Motion]:
    if log is not None:
        return log_motions(log, list(task.friction), columns)
    found = {}
    for name, carried in task.friction.items():
        joint = model.joint(name).id
        start = float(model.qpos0[model.jnt_qposadr[joint]])
        unit = "m" if is_slide(model, name) else "rad"
        found[name] = stated_motion(carried.parameters, start, speeds, unit)
    return found


def _springs(
    bare: mujoco.MjModel, friction: Mapping[str, JointFriction], plain: Mapping[str, PlainFriction]
) -> dict[str, presliding.YieldSprings]:
    """Springs of each joint, soft enough for the time step."""
    free = 1.0 / np.diag(np.linalg.inv(mass_at_start(bare)))
    step = float(bare.opt.timestep)
    made = {
        name: presliding.yield_springs(friction[name].parameters, p.coulomb)
        for name, p in plain.items()
    }
    dofs = {name: bare.joint(name).dofadr[0] for name in made}
    return {name: x.suited(step, float(free[dofs[name]])) for name, x in made.items()}


def _with_assets(spec: mujoco.MjSpec, task: _Task) -> str:
    """The spec's MJCF, with paths of asset files relative to the export; it is compiled."""
    spec.compile()
    text: str = spec.to_xml()
    if not (spec.meshes or spec.hfields or spec.textures or spec.skins):
        return text
    root = ET.fromstring(text)
    compiler = root.find("compiler")
    if compiler is None:
        compiler = ET.Element("compiler")
        root.insert(0, compiler)
    before, after = task.path.absolute().parent, task.out.absolute().parent
    for name in ("meshdir", "texturedir"):
        compiler.set(name, os.path.relpath(before / getattr(spec, name), after))
    return ET.tostring(root, encoding="unicode") + "\n"


def _of_numbers(task: _Task, plain: Mapping[str, PlainFriction]) -> tuple[str, mujoco.MjModel]:
    """Text and model for a target that takes the numbers of joints, not an MJCF."""
    spec = task.spec()
    if task.target == "urdf":
        note = f"{task.path.name} with the joints' friction as far as URDF has it, by frictionjoint"
        text = urdf_text(spec.compile(), plain, note)
        model = mujoco.MjModel.from_xml_string(text)
        model.opt.timestep = step = float(spec.option.timestep)
        # a URDF does not state how firmly friction holds: the losses are those of friction in MJCF
        model.dof_solimp[:, :2], model.dof_solref[:] = 0.9999, (2.0 * step, 1.0)
        return text, model
    if task.target == "newton":
        model = add_plain(spec, plain).compile()
        return scripts.newton_text(task.path, plain, model), model
    # PhysX has neither springs nor constant torques
    for_physx = {name: replace(p, preload=0.0, stiffness=0.0) for name, p in plain.items()}
    model = add_plain(spec, for_physx).compile()
    return scripts.isaac_text(task.path, plain, model), model


def _lost(
    task: _Task,
    plain: Mapping[str, PlainFriction],
    bare: mujoco.MjModel,
    softened: Mapping[str, float],
) -> list[str]:
    """Properties that each joint loses in the export, one sentence each."""
    found = []
    for name, p in plain.items():
        law, what = task.friction[name].parameters, []
        if task.lugre:
            what.append("the memory of reversals")
        elif not task.yielding and law.stiffness > 0.0:
            what.append("presliding with its memory")
        if not task.lugre and any(Fs > Fc for Fs, Fc, *_ in sliding.levels(law).values()):
            falls = {"isaac": "the fall of friction between rest and sliding"}
            what.append(falls.get(task.target, "friction that falls with speed"))
        if task.yielding and softened[name] > 1.0:
            softer = f"{softened[name]:.2g} times softer for the time step"
            what.append(f"presliding stiffness, {softer}")
        kept = _MECHANICAL if task.target in ("native", "mjx") else frozenset()
        sizes = effect_texts(task.friction[name], is_slide(bare, name))
        what += [
            f"{size.replace(': ', ' (', 1)})"
            for effect, size in zip(task.friction[name].effects, sizes, strict=True)
            if effect.effect.name in p.lost and effect.effect.name not in kept
        ]
        if task.target not in _SPRINGS:
            if p.preload != 0.0:
                what.append(f"a constant torque of {p.preload:.4g}")
            if p.stiffness != 0.0:
                what.append(f"a spring of {p.stiffness:.4g}")
        armature = float(bare.dof_armature[bare.joint(name).dofadr[0]]) + p.armature
        if task.target == "urdf" and armature != 0.0:
            what.append(f"rotor inertia {armature:.4g}")
        if task.target == "urdf" and p.coulomb > 0.0:
            what.append("how firmly friction holds (soft by default in MuJoCo)")
        if what:
            found.append(f"{name}: {', '.join(what)}")
    return found


def output_file(out: Path, target: Target) -> Path:
    """The file to write; in a folder its name depends on the target.

    Raises:
        ModelError: a folder's parent is a file.
    """
    if out.is_dir() or not out.suffix:
        if out.is_file():
            raise ModelError(f"{out} is a file without a suffix: name a folder or another file")
        return out / FILES[target]
    return out
