"""Parameters of a robot that its logs do not determine, in words."""

import numpy as np

from frictionjoint.identify.result import Estimate
from frictionjoint.robot.information import Information, Parameter
from frictionjoint.robot.undetermined import undetermined


def test_each_entry_names_parameters_and_then_says_what_is_unknown_of_them():
    owned = (("arm", "mass"), ("hand", "mass"), ("hand", "Ixx"), ("hand", "Iyy"))
    columns = np.array([[1e3, 1e3, 0.0, 0.0], [2e3, 2e3, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    parameters = tuple(Parameter(owner, name, 1.0) for owner, name in owned)
    found = Information(parameters, columns.T @ columns)
    rows = undetermined(found, {"elbow": {"Fc": Estimate(1.0, 0.9, "N m")}})
    assert [row["text"] for row in rows] == [
        "mass of hand: only in sums with parameters of arm",
        "Ixx of hand: no effect on these torques",
        "Iyy of hand: known to no better than 50% of the model's own size",
        "friction of elbow: Coulomb friction",
    ]
