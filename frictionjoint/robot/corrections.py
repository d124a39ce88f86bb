"""Corrections of a robot's rigid-body model, and that model, in which a shaft is a tendon."""

from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.identify.rigid_body import TURNS
from frictionjoint.robot.inertia import of_model, write
from frictionjoint.simulate.shaft_wave import add_wave


@dataclass(frozen=True)
class Shaft:
    """A shaft that turns with two joints at once, such as a wrist motor behind coupled gears.

    Attributes:
        joints: names. ratio: of the second joint's angle to the first one's in the shaft's angle.
        top: speed above which its concave friction is constant, rad/s.
        waves: angular frequency of the friction level along the shaft, 1/rad.
        numbers: friction level, N m; viscous and concave friction, N m s/rad, the second its slope
            at low speed, see `concave_friction`; inertia, kg m^2; all seen from the first joint;
            sine and cosine of the level's wave, N m, at the shaft angle that the joints measure.
    """

    joints: tuple[str, str]
    ratio: float
    top: float
    waves: float = 0.0
    numbers: tuple[float, ...] = (0.0,) * 6

    @property
    def bare(self) -> "Shaft":
        """The shaft without friction and inertia."""
        return Shaft(self.joints, self.ratio, self.top, self.waves)

    def per_turn(self, joint: str) -> float:
        return dict(zip(self.joints, (1.0, self.ratio), strict=True)).get(joint, 0.0)


def concave_friction(velocity: Array, top: float) -> Array:
    """Concave friction, shape (n,): v - v|v| / top + v^3 / (3 top^2) up to the top speed, constant
    above; it never falls."""
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
        first, second = shaft.joints
        level, viscous, concave, inertia, sin, cos = shaft.numbers
        name = f"shaft of {first} and {second}"
        tendon = spec.add_tendon(name=name, frictionloss=level, armature=inertia)
        # by powers of speed
        curve = concave * np.array([1.0, -1.0 / shaft.top, 1.0 / (3.0 * shaft.top**2)])
        tendon.damping = np.array([viscous, 0.0, 0.0]) + curve if tendon_polynomial() else viscous
        tendon.wrap_joint(first, 1.0)
        tendon.wrap_joint(second, shaft.ratio)
        if shaft.waves:
            add_wave(spec, name, shaft.ratio, shaft.waves, sin, cos, TURNS * shaft.top)


def _keep_inertias(spec: mujoco.MjSpec, model: mujoco.MjModel, phi: Array) -> None:
    """State all inertias explicitly if the compiler would take them from the geoms."""
    if int(spec.compiler.inertiafromgeom) != int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE):
        return
    spec.compiler.inertiafromgeom = int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO)
    for body in spec.bodies:
        if body.id > 0 and model.body_mass[body.id] > 0.0:
            write(body, phi[body.id])
