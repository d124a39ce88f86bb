"""Parameter files of BAM (Duclusaud et al. 2024, github.com/Rhoban/bam), read and written.

BAM bounds friction by a budget: with the motor's torque tm and the torque te that acts on the joint
from outside,

    M1  base + viscous |v|                                  M2  + stribeck E, E = exp(-|v/vs|^alpha)
    M3  base + viscous |v| + load |tm - te|                 M4  both, + load_stribeck E |tm - te|
    M5  with |motor tm - external te| in place of load |tm - te|, and the same with E
    M6  M5 + E (external_quad te^2 or motor_quad tm^2), by who drives

The joint stands still as long as the budget suffices: no displacement before sliding. Here that is
the law `static`; the load's part is the effect `load-dependent`. A joint that is held has
tm = -te, so |tm - te| is twice the torque that the gear transmits, and of M5 the sum of motor and
external remains.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from frictionjoint.effects.friction_level import LOAD_COULOMB, LOAD_FORMS, LOAD_STRIBECK
from frictionjoint.effects.motor import BACK_EMF
from frictionjoint.errors import ParameterError
from frictionjoint.export.sliding import levels
from frictionjoint.joint_friction import JointFriction, SimulatedEffect
from frictionjoint.parameter_checks import check_number
from frictionjoint.rivals import StaticParameters
from frictionjoint.structured_files import read_json

_PLAIN = ("friction_base", "friction_viscous")
_FALLING = ("friction_stribeck", "dtheta_stribeck", "alpha")
_SIDES = ("load_friction_motor", "load_friction_external")
_FALLING_SIDES = tuple(f"{name}_stribeck" for name in _SIDES)
_SQUARED_SIDES = tuple(f"{name}_quad" for name in _SIDES)
_M5 = (*_PLAIN, *_FALLING, *_SIDES, *_FALLING_SIDES)
MODELS = {
    "m1": _PLAIN,
    "m2": (*_PLAIN, *_FALLING),
    "m3": (*_PLAIN, "load_friction_base"),
    "m4": (*_PLAIN, *_FALLING, "load_friction_base", "load_friction_stribeck"),
    "m5": _M5,
    "m6": (*_M5, *_SQUARED_SIDES),
}
# rad/s over which BAM's standstill is drawn out, and rad over which a change of load is reached
_STANDSTILL, _REACH = 1e-3, 1e-4


@dataclass(frozen=True)
class BamParameters:
    """A file of BAM.

    Attributes:
        model: m1 to m6. actuator: BAM's name of it. friction: the model's numbers, SI.
        motor: the other numbers of the file: kt, R, armature, q_offset and so on.

    Raises:
        ParameterError: an unknown model, or a number is missing or is not a number.
    """

    model: str
    actuator: str
    friction: dict[str, float]
    motor: dict[str, float]

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise ParameterError(f"BAM has no model {self.model!r}: it has {', '.join(MODELS)}")
        missing = [name for name in MODELS[self.model] if name not in self.friction]
        if missing:
            raise ParameterError(f"model {self.model} lacks {', '.join(missing)}: add it")
        for name, value in {**self.friction, **self.motor}.items():
            check_number(name, value)

    def to_json(self) -> str:
        """The file's text."""
        names = {"model": self.model, "actuator": self.actuator}
        return json.dumps({**self.motor, **self.friction, **names}, indent=4) + "\n"


def read_bam(path: Path) -> BamParameters:
    """A parameter file of BAM.

    Raises:
        ParameterError: unreadable, no JSON, or not what BAM writes.
    """
    content = read_json(path, "give the parameter file that BAM writes")
    if not isinstance(content, dict) or not {"model", "actuator"} <= set(content):
        raise ParameterError(f"{path}: no parameter file of BAM: model and actuator are missing")
    model, actuator = (str(content.pop(name)) for name in ("model", "actuator"))
    own = MODELS.get(model, ())
    try:
        return BamParameters(
            model,
            actuator,
            {name: content[name] for name in own if name in content},
            {name: value for name, value in content.items() if name not in own},
        )
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from None


def from_bam(bam: BamParameters) -> tuple[JointFriction, tuple[str, ...]]:
    """Friction of a joint from a file of BAM, and the content without counterpart, a sentence each.

    Raises:
        ParameterError: numbers that the law does not allow.
    """
    f = {name: bam.friction.get(name, 0.0) for name in MODELS["m6"] + MODELS["m4"]}
    falls = bam.model != "m1" and bam.model != "m3"
    law = StaticParameters.symmetric(
        Fs=f["friction_base"] + f["friction_stribeck"],
        Fc=f["friction_base"],
        Vs=f["dtheta_stribeck"] if falls else 1.0,
        delta=f["alpha"] if falls else 2.0,
        sigma2=f["friction_viscous"],
        V0=_STANDSTILL,
    )
    load = 2.0 * f["load_friction_base"] + sum(f[name] for name in _SIDES)
    falling = 2.0 * f["load_friction_stribeck"] + sum(f[name] for name in _FALLING_SIDES)
    effects: list[SimulatedEffect] = []
    if falling > 0.0:
        shape = (_REACH, f["dtheta_stribeck"])
        effects.append(SimulatedEffect(LOAD_STRIBECK, shape, (load, falling)))
    elif load > 0.0:
        effects.append(SimulatedEffect(LOAD_COULOMB, (_REACH,), (load,)))
    kt, R = bam.motor.get("kt"), bam.motor.get("R")
    creep = f"the joint creeps below {_STANDSTILL:g} rad/s"
    said = [f"no displacement before sliding is known: {creep}"]
    if kt is not None and R is not None:
        effects.append(SimulatedEffect(BACK_EMF, (), (kt * kt / R,)))
        said.append(f"kt {kt:.4g} and R {R:.4g} remain as the back-EMF's kt^2/R alone")
    if "armature" in bam.motor:
        said.append(f"armature {bam.motor['armature']:.4g} kg m^2 belongs to the MJCF's joint")
    rest = [name for name in bam.motor if name not in ("kt", "R", "armature")]
    if rest:
        said.append(f"{', '.join(rest)}: of the test bench, or of the drive")
    if falling > 0.0 and f["alpha"] != 1.0:
        ours = "the load's part falls as exp(-|v|/vs)"
        said.append(f"{ours}, BAM's with the exponent {f['alpha']:.3g}")
    if bam.model in ("m5", "m6"):
        said.append("load by the motor and from outside is one sum: who drives makes no difference")
    if bam.model == "m6":
        said.append("the part quadratic in the load")
    return JointFriction(law, tuple(effects)), tuple(said)


def to_bam(
    joint: JointFriction, like: BamParameters, model: str | None = None
) -> tuple[BamParameters, tuple[str, ...]]:
    """A file of BAM for a joint, and the friction that BAM cannot represent, a sentence each.

    Args:
        like: file that provides the numbers of actuator and motor.
        model: m1 to m6; None: the simplest model that can represent the joint.
    Raises:
        ParameterError: an unknown model.
    """
    if model is not None and model not in MODELS:
        raise ParameterError(f"BAM has no model {model!r}: it has {', '.join(MODELS)}")
    by_side = levels(joint.parameters)
    Fs, Fc, Vs, delta, sigma2 = (
        0.5 * (a + b) for a, b in zip(by_side["pos"], by_side["neg"], strict=True)
    )
    load, falling, said = _loads(joint)
    falls, loaded = Fs > Fc or falling > 0.0, load > 0.0 or falling > 0.0
    model = model or f"m{1 + falls + 2 * loaded}"
    held: Mapping[str, float] = {
        "friction_base": Fc,
        "friction_viscous": sigma2,
        "friction_stribeck": Fs - Fc,
        "dtheta_stribeck": Vs,
        "alpha": delta,
        **dict.fromkeys(("load_friction_base", *_SIDES), 0.5 * load),
        **dict.fromkeys(("load_friction_stribeck", *_FALLING_SIDES), 0.5 * falling),
        **dict.fromkeys(_SQUARED_SIDES, 0.0),
    }
    if by_side["pos"] != by_side["neg"]:
        said.append("the difference between the directions: the mean is written")
    if joint.parameters.law != "static":
        said.append(f"the {joint.parameters.law} law before sliding: BAM stands still")
    if "alpha" not in MODELS[model] and Fs > Fc:
        said.append(f"model {model} does not fall with speed: {Fs - Fc:.3g} of breakaway is lost")
    if len(MODELS[model]) <= len(MODELS["m2"]) and model != "m3" and load + falling > 0.0:
        said.append(f"model {model} knows no load")
    own = {name: held[name] for name in MODELS[model]}
    return BamParameters(model, like.actuator, own, like.motor), tuple(said)


def _loads(joint: JointFriction) -> tuple[float, float, list[str]]:
    """Load coefficients, constant and decreasing with speed, and what BAM cannot represent."""
    load = falling = 0.0
    said: list[str] = []
    for effect in joint.effects:
        if effect.effect in LOAD_FORMS:
            load += effect.coefficients[0]
            if effect.effect == LOAD_STRIBECK:
                falling += effect.coefficients[1]
                said.append(f"the load's fall with speed has its own {effect.shape[1]:.3g} rad/s")
        elif effect.effect == BACK_EMF:
            said.append("back-EMF: computed from the given kt and R")
        else:
            said.append(f"effect {effect.effect.name}")
    return load, falling, said
