"""Logs of a trial plant as the loop has them, and a small plant to make them of."""

from dataclasses import replace
from pathlib import Path

from plants.plant import simulate, write
from plants.spec import Controller, Effect, Friction, Instrument, Motion, PlantSpec

from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.readers import read_log

PENDULUM = PlantSpec(
    mass=1.0,
    length=0.2,
    inertia=0.06,
    armature=0.02,
    friction=Friction("lugre", Fs=0.6, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3),
    controller=Controller(kp=60.0, kd=3.0),
    motions=(Motion("sines", 3, 0.5, 1.0, 12.0), Motion("multisine", 4, 0.4, 1.0, 12.0)),
    instrument=Instrument(rate=500.0, counts=65536, torque_noise=0.005),
    seed=1,
)


def quiet(*effects: Effect, **changes: object) -> PlantSpec:
    """A plant with next to no friction and a perfect instrument: torque is the rigid body's."""
    spec = PlantSpec(
        mass=1.0, length=0.2, inertia=0.06, armature=0.02,
        friction=Friction("gms", Fs=2e-6, Fc=1e-6, sigma2=0.0, presliding=1e-2),
        controller=Controller(kp=60.0, kd=3.0),
        motions=(Motion("multisine", 3, 0.8, 2.0, 3.0),),
        instrument=Instrument(rate=1000.0, counts=0), seed=1, effects=effects,
    )  # fmt: skip
    return replace(spec, **changes)


def prepared_logs(spec: PlantSpec, folder: Path, most: int | None = None) -> Prepared:
    """The first logs of a plant, all where `most` is None, prepared with the believed MJCF."""
    logs = [read_log(path, "joint") for path in write(simulate(spec), folder)]
    return prepare(logs[:most], RigidBody(folder / "joint.xml", "joint"))
