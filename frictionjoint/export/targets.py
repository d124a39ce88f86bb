"""Programs that the friction of a model can be converted for."""

from typing import Literal

Target = Literal["native", "mjx", "urdf", "c", "mjlab", "newton", "isaac"]
# name of the file in a folder
FILES: dict[Target, str] = {
    "native": "native.xml",
    "mjx": "mjx.xml",
    "urdf": "robot.urdf",
    "c": "friction.h",
    "mjlab": "friction_mjlab.py",
    "newton": "friction_newton.py",
    "isaac": "friction_isaac.py",
}
