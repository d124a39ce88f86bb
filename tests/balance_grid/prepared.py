"""A case of the grid as the package reads it."""

from pathlib import Path

from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.segment import Prepared
from frictionjoint.measured.log import JointLog

from .case import Case
from .files import MODEL


def prepared(case: Case, folder: Path) -> Prepared:
    """Its logs, prepared with the MJCF of the inertia alone, which is written to the folder."""
    model = folder / "model.xml"
    model.write_text(MODEL.format(J=case.J))
    logs = [
        JointLog(
            name=f"log{i}",
            joint="joint1",
            time=x["time_s"],
            position=x["position_rad"],
            torque=x["torque_nm"],
        )
        for i, x in enumerate(case.logs)
    ]
    return prepare(logs, RigidBody(model, "joint1"))
