"""The plant as a parts list that effects change, and the MJCF made from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .friction import ATTRACTION, ELEMENTS, maxwell_elements
from .loop import FIELDS
from .spec import LAWS, PlantSpec

JOINT, OTHER = "joint", "other"
# sigma1 over sqrt(stiffness * inertia): twice the damping ratio of the joint while it sticks.
MICRO_DAMPING = 0.1


@dataclass
class Parts:
    """What is put together: MJCF fragments, constants of the loop, and the instrument's errors.

    joint: extra attributes of the joint's hinge. extra_mass, extra_angle: see `_inertial`.
    shaft: attributes of a second hinge between motor and link (None: rigid). tendons, actuators:
    MJCF elements. loop: changes to `loop.FIELDS`. other: a second joint's motion per log.
    level_by_log: friction level factor of each log. start_temperatures: C, log by log in turn.
    eccentricity: rad, angle.
    """

    spec: PlantSpec
    joint: dict[str, str] = field(default_factory=dict)
    extra_mass: float = 0.0
    extra_angle: float = 0.0
    extra_armature: float = 0.0
    shaft: dict[str, str] | None = None
    shaft_inertia: float = 0.0
    bodies: list[str] = field(default_factory=list)
    tendons: list[str] = field(default_factory=list)
    actuators: list[str] = field(default_factory=list)
    loop: dict[str, float] = field(default_factory=dict)
    has_other: bool = False
    other_speed: float = 1.0
    encoder_on_link: bool = False
    torque_gain: float = 1.0
    delay: float = 0.0
    eccentricity: tuple[float, float] = (0.0, 0.0)
    log_temperature: bool = False
    voltage: bool = False
    level_by_log: tuple[float, ...] = ()
    start_temperatures: tuple[float, ...] = (25.0,)

    def constants(self) -> np.ndarray:
        """The loop's constants in the order of `loop.FIELDS`."""
        s, f = self.spec, self.spec.friction
        stiffness = 2.0 * f.Fs / f.presliding
        base = {
            "h": s.step, "law": float(LAWS.index(f.law)), "Fs": f.Fs, "Fc": f.Fc, "Vs": f.Vs,
            "delta": f.delta, "sigma2": f.sigma2, "asymmetry": f.asymmetry, "sigma0": stiffness,
            "sigma1": MICRO_DAMPING * np.sqrt(stiffness * (s.inertia + s.armature)),
            "attraction": ATTRACTION * f.Fs, "kp": s.controller.kp, "ki": s.controller.ki,
            "kd": s.controller.kd, "limit": s.controller.limit, "hold": round(1e-3 / s.step),
            "gravity": s.gravity_torque, "link_inertia": s.inertia,
            "other_kp": 200.0, "other_kd": 20.0,
        }  # fmt: skip
        values = {**FIELDS, **base, **self.loop}
        unknown = set(values) - set(FIELDS)
        if unknown:
            raise KeyError(f"the loop has no constant named {sorted(unknown)}")
        return np.array([float(values[name]) for name in FIELDS])

    def elements(self) -> tuple[np.ndarray, np.ndarray]:
        """Maxwell-slip stiffnesses and shares of this plant."""
        f = self.spec.friction
        k, alpha = maxwell_elements(f.Fs, f.presliding)
        assert k.size == ELEMENTS
        return k, alpha

    def mjcf(self) -> str:
        """MJCF of the true plant."""
        s = self.spec
        plain = {"frictionloss": "1"} if s.friction.law == "plain" else {}
        hinge = {"armature": f"{s.armature + self.extra_armature:.9g}", **plain, **self.joint}
        link = _inertial(s, self.extra_mass, self.extra_angle)
        if self.shaft is None:
            arm = _joint(JOINT, hinge) + link
        else:
            rotor = self.shaft_inertia
            hinge["armature"] = f"{float(hinge['armature']) + rotor:.9g}"
            arm = (
                _joint(JOINT, hinge)
                + '<inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/>'
                + f'<body name="link">{_joint("shaft", self.shaft)}{link}</body>'
            )
        return _document(s.step, arm, self)

    def believed(self) -> str:
        """MJCF the user believes in: the nominal rigid body, no friction, no effect."""
        s = self.spec
        arm = _joint(JOINT, {"armature": f"{s.armature:.9g}"}) + _inertial(s, 0.0, 0.0)
        nominal = Parts(s, has_other=self.has_other)
        return _document(1e-3, arm, nominal)


def _attributes(values: dict[str, str]) -> str:
    return "".join(f' {key}="{value}"' for key, value in values.items())


def _joint(name: str, values: dict[str, str]) -> str:
    return f'<joint name="{name}" axis="0 1 0"{_attributes(values)}/>'


def _inertial(s: PlantSpec, mass: float, angle: float) -> str:
    """The link about its own centre; an extra point mass on its arm, turned by `angle` from it."""
    own = max(s.inertia - s.mass * s.length**2, 1e-7)
    body = (
        f'<inertial pos="0 0 {-s.length:.9g}" mass="{s.mass:.9g}" '
        f'diaginertia="{own:.9g} {own:.9g} {own:.9g}"/>'
    )
    if mass == 0.0:
        return body
    place = f"{-s.arm * np.sin(angle):.9g} 0 {-s.arm * np.cos(angle):.9g}"
    return body + (
        f'<body pos="{place}"><inertial pos="0 0 0" mass="{mass:.9g}" '
        'diaginertia="1e-9 1e-9 1e-9"/></body>'
    )


def _document(step: float, arm: str, parts: Parts) -> str:
    other = ""
    if parts.has_other:
        other = (
            f'<body name="{OTHER}" pos="0 1 0"><joint name="{OTHER}" axis="0 1 0" armature="0.2"/>'
            '<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body>'
        )
    return (
        f'<mujoco model="joint"><compiler angle="radian"/><option timestep="{step}">'
        '<flag contact="disable" eulerdamp="disable"/></option><worldbody>'
        f'<body name="arm">{arm}</body>{"".join(parts.bodies)}{other}</worldbody>'
        f"{_section('tendon', parts.tendons)}{_section('actuator', parts.actuators)}</mujoco>"
    )


def _section(name: str, elements: list[str]) -> str:
    return f"<{name}>{''.join(elements)}</{name}>" if elements else ""
