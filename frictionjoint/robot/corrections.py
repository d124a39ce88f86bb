"""Corrections of a robot's rigid-body model, and that model, in which a shaft is a tendon."""

from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.rigid_body import TURNS
from frictionjoint.robot.inertia import of_model, write
from frictionjoint.simulate.shaft_wave import add_wave

SHAFT_NUMBERS = ("level", "viscous", "concave", "inertia", "sin", "cos")


@dataclass(frozen=True)
class Shaft:
    """A shaft that turns with two joints at once, such as a wrist motor behind coupled gears.

    Attributes:
        joints: names. ratio: of the second joint's angle to the first one's in the shaft's angle.
        top: speed above which its concave friction is constant, rad/s.
        level, viscous, concave, inertia: its friction, N m and N m s/rad, and its inertia, kg m^2,
            seen from the first joint; concave: its slope at low speed, see `concave_friction`.
        waves: angular frequency of the friction level along the shaft, 1/rad. sin, cos: of that
            wave, N m, at the shaft angle that the joints measure.
    """

    joints: tuple[str, str]
    ratio: float
    top: float
    level: float = 0.0
    viscous: float = 0.0
    concave: float = 0.0
    inertia: float = 0.0
    waves: float = 0.0
    sin: float = 0.0
    cos: float = 0.0

    @property
    def numbers(self) -> Array:
        """The values of `SHAFT_NUMBERS`, shape (6,)."""
        return np.array([getattr(self, name) for name in SHAFT_NUMBERS])

    @property
    def bare(self) -> "Shaft":
        """The shaft without friction and inertia."""
        return Shaft(self.joints, self.ratio, self.top, waves=self.waves)

    def moved(self, number: int, by: float) -> "Shaft":
        """The shaft with one of its numbers changed."""
        name = SHAFT_NUMBERS[number]
        return replace(self, **{name: getattr(self, name) + by})

    @property
    def damping(self) -> Array:
        """Coefficients of a tendon's damping by powers of speed, shape (3,)."""
        curve = np.array([1.0, -1.0 / self.top, 1.0 / (3.0 * self.top**2)])
        return np.array([self.viscous, 0.0, 0.0]) + self.concave * curve

    def per_turn(self, joint: str) -> float:
        return dict(zip(self.joints, (1.0, self.ratio), strict=True)).get(joint, 0.0)


def concave_friction(velocity: Array, top: float) -> Array:
    """Concave friction with slope 1 at rest, constant above the top speed, (n,).

    v - v|v| / top + v^3 / (3 top^2) up to the top speed; it never falls.
    """
    part = np.abs(velocity) / top
    return np.asarray(velocity * (1.0 - part + part**2 / 3.0))


def tendon_polynomial() -> bool:
    """Whether this MuJoCo has tendon damping that is a polynomial of speed."""
    return np.size(mujoco.MjSpec().add_tendon().damping) > 1


@dataclass(frozen=True)
class Corrections:
    """Corrections of a rigid-body model.

    Attributes:
        phi: inertial parameters of all bodies, shape (nbody, 10). gravity: m/s^2, shape (3,).
        armature: to add to a joint's, kg m^2 (kg), by name. offset: to add to a joint's measured
            position, rad (m), by name. shafts: in addition to the model's own tendons.
    """

    phi: Array
    gravity: Array
    armature: dict[str, float] = field(default_factory=dict)
    offset: dict[str, float] = field(default_factory=dict)
    shafts: tuple[Shaft, ...] = ()

    @classmethod
    def none(cls, model: mujoco.MjModel) -> "Corrections":
        """No correction: the model as given."""
        return cls(of_model(model), np.array(model.opt.gravity))

    def moves_alike(self, other: "Corrections") -> bool:
        """Whether motion and gravity are the same with both."""
        return self.offset == other.offset and np.array_equal(self.gravity, other.gravity)

    def linear_to(self, other: "Corrections") -> bool:
        """Whether torques change from these corrections to others by numbers they are linear in."""
        shafts = [[s.bare for s in x.shafts] for x in (self, other)]
        return self.moves_alike(other) and shafts[0] == shafts[1]

    def with_body(self, body: int, phi: Array) -> "Corrections":
        """The corrections with other parameters of one body."""
        changed = self.phi.copy()
        changed[body] = phi
        return replace(self, phi=changed)


def write_corrections(spec: mujoco.MjSpec, found: Corrections) -> None:
    """Put corrections into a spec of the same model; ModelError: no body has the parameters."""
    model = spec.compile()
    before = of_model(model)
    # MJCF has six digits: what differs by less is the same body
    changed = np.abs(found.phi - before).max(axis=1) > 1e-9 * np.abs(before).max(axis=1)
    if changed.any():
        _keep_inertias(spec, model, before)
    for body in spec.bodies:
        if body.id > 0 and changed[body.id]:
            write(body, found.phi[body.id])
    spec.option.gravity = found.gravity
    for name, extra in found.armature.items():
        spec.joint(name).armature = float(model.joint(name).armature[0]) + extra
    for name, angle in found.offset.items():
        # at the same measured position the body stands further along its axis
        joint = spec.joint(name)
        joint.ref = float(joint.ref) - (np.degrees(angle) if spec.compiler.degree else angle)
    for shaft in found.shafts:
        tendon = spec.add_tendon(
            name=f"shaft of {shaft.joints[0]} and {shaft.joints[1]}",
            frictionloss=shaft.level,
            armature=shaft.inertia,
        )
        tendon.damping = shaft.damping if tendon_polynomial() else shaft.viscous
        tendon.wrap_joint(shaft.joints[0], 1.0)
        tendon.wrap_joint(shaft.joints[1], shaft.ratio)
        if shaft.waves:
            turns_over = TURNS * shaft.top
            wave = shaft.ratio, shaft.waves, shaft.sin, shaft.cos
            add_wave(spec, tendon.name, *wave, turns_over)


def _keep_inertias(spec: mujoco.MjSpec, model: mujoco.MjModel, phi: Array) -> None:
    """State all inertias explicitly if the compiler would take them from the geoms."""
    if int(spec.compiler.inertiafromgeom) != int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE):
        return
    spec.compiler.inertiafromgeom = int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO)
    for body in spec.bodies:
        if body.id > 0 and model.body_mass[body.id] > 0.0:
            write(body, phi[body.id])
