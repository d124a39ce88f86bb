"""Logs of a trial plant as the loop has them, and a small plant to make them of."""

from pathlib import Path

from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.readers import read_log
from tests.plants.plant import simulate, write
from tests.plants.spec import Controller, Friction, Instrument, Motion, PlantSpec

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


def prepared_logs(spec: PlantSpec, folder: Path, most: int | None = None) -> Prepared:
    """The first logs of a plant, all where `most` is None, prepared with the believed MJCF."""
    logs = [read_log(path, "joint") for path in write(simulate(spec), folder)]
    return prepare(logs[:most], RigidBody(folder / "joint.xml", "joint"))
