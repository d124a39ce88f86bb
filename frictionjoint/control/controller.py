"""A position controller: gains, limits, delays."""

import math
from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

import tomlkit

from frictionjoint.errors import ParameterError

Output = Literal["torque_nm", "voltage_v", "duty"]
Velocity = Literal["measured", "differentiated"]
DropOf = Literal["error", "output"]
DeadbandForm = Literal["cut", "shifted"]
UNKNOWN = "unknown"
LOG = "log:"
# a number, "unknown", or "log:NAME", a number in each log
Value = float | str

_CHOICES = {
    "output": get_args(Output),
    "velocity": get_args(Velocity),
    "drop_of": get_args(DropOf),
    "deadband_form": get_args(DeadbandForm),
}
# entries that may be "unknown", and entries that may be read from a log
_MAY_BE_UNKNOWN = (
    *("kp", "kd", "supply_v", "limit", "deadband", "delay_s", "target_rate", "drop_above", "sag"),
)
_MAY_BE_LOGGED = ("kp", "kd", "ki", "supply_v", "limit")
# what no controller of a joint exceeds; of any other number it is 1e9
_MOST = {"rate_hz": 1e6, "delay_s": 10.0, "drop_left": 1.0}


@dataclass(frozen=True, kw_only=True)
class Controller:
    """A position controller as implemented in firmware.

        u = kp e + ki (integral of e) - kd v + feed_forward (target's velocity),  |u| <= limit

    with e = target - position. For a slide joint read m for rad and N for N m.

    Attributes:
        output: quantity of u. With a duty the motor voltage is supply_v u.
        kp, kd, ki: per rad, per rad/s, per rad s, in `gain_unit`; ``"log:NAME"`` is read from each
            log. An ``"unknown"`` kp is estimated from the load (`reconstruct`); kd, ki and
            feed_forward must then be unknown or absent. An unknown kd counts as 0, and identified
            viscous friction and back-EMF include it.
        gain_unit: u per unit of kp, kd and ki, for gains in units of the firmware.
        supply_v: V at full duty. A log's own ``supply_v`` column takes precedence.
        limit: of abs(u).
        deadband: rad, no output below; deadband_form: outside, the whole error acts (cut) or only
            the part that exceeds the band (shifted).
        rate_hz: ticks per second; 0: at every call.
        delay_s: from the target to the tick that uses it.
        target_rate: largest speed of the target, rad/s: a motion profile in the firmware.
        velocity: input of kd: the joint velocity, or the difference of positions between ticks.
        feed_forward: u per rad/s of the target.
        count_rad: encoder step, rad; 0: none.
        drop_above: protection: error in rad, or u, above which only `drop_left` of u remains.
        drop_of: which of the two.
        sag: supply resistance relative to the winding's; sag_emf: V s/rad, of the motor.
        source: where the numbers come from.
    Raises:
        ParameterError: a number that is not possible for a controller.
    """

    output: Output
    kp: Value
    kd: Value = 0.0
    ki: Value = 0.0
    gain_unit: float = 1.0
    supply_v: Value | None = None
    limit: Value = math.inf
    deadband: Value = 0.0
    deadband_form: DeadbandForm = "cut"
    rate_hz: float = 0.0
    delay_s: Value = 0.0
    target_rate: Value = math.inf
    velocity: Velocity = "measured"
    feed_forward: float = 0.0
    count_rad: float = 0.0
    drop_above: Value = math.inf
    drop_of: DropOf = "error"
    drop_left: float = 1.0
    sag: Value = 0.0
    sag_emf: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        for field in fields(self):
            name, value = field.name, getattr(self, field.name)
            if name == "source":
                if not isinstance(value, str):
                    raise ParameterError(f"source is {value!r}: give text")
            elif name in _CHOICES:
                if value not in _CHOICES[name]:
                    listed = ", ".join(repr(x) for x in _CHOICES[name])
                    raise ParameterError(f"{name} is {value!r}: give one of {listed}")
            elif isinstance(value, str):
                self._check_text(name, value)
            elif not (name == "supply_v" and value is None):
                _check_number(name, value)
        if self.output == "duty" and self.supply_v is None:
            raise ParameterError(
                'a duty needs supply_v: give V at full duty, "log:NAME" or "unknown"'
            )
        if self.output != "duty" and self.supply_v is not None:
            raise ParameterError(f"supply_v does not go with output {self.output!r}: leave it out")
        if self.kp == UNKNOWN:
            self._check_unknown_kp_alone()

    def _check_unknown_kp_alone(self) -> None:
        """Reject terms that are not relative to kp where the output is."""
        for name in ("kd", "ki", "feed_forward"):
            value = getattr(self, name)
            if value not in (0.0, UNKNOWN):
                instead = 'say that it is "unknown"' if name in _MAY_BE_UNKNOWN else "leave it out"
                raise ParameterError(
                    f"{name} is {value!r} together with an unknown kp: give kp too, or {instead}"
                )

    @staticmethod
    def _check_text(name: str, value: str) -> None:
        if value == UNKNOWN and name in _MAY_BE_UNKNOWN:
            return
        if value.startswith(LOG) and len(value) > len(LOG) and name in _MAY_BE_LOGGED:
            return
        choices = ["a number"]
        if name in _MAY_BE_UNKNOWN:
            choices.append('"unknown"')
        if name in _MAY_BE_LOGGED:
            choices.append('"log:NAME"')
        raise ParameterError(f"{name} is {value!r}: give {' or '.join(choices)}")

    def to_toml(self) -> str:
        """Inverse of `read_controller`, exact to the last bit; defaults are omitted."""
        document = tomlkit.document()
        unit = "of a joint, SI units; 'log:NAME' is a figure of each log, 'unknown' is not known."
        document.add(tomlkit.comment(f"Controller {unit}"))
        for field in fields(self):
            value = getattr(self, field.name)
            if value != field.default:
                document.add(field.name, value)
        return tomlkit.dumps(document)


def _check_number(name: str, value: Any) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
        raise ParameterError(f"{name} is {value!r}: give a number")
    endless = name in ("limit", "drop_above", "target_rate") and value == math.inf
    if abs(value) > (most := _MOST.get(name, 1e9)) and not endless:
        raise ParameterError(f"{name} is {value!r:.20}: give at most {most:g}")
    if name == "feed_forward":
        return
    above = name in ("limit", "drop_above", "target_rate", "supply_v", "gain_unit")
    if value < 0.0 or (above and value == 0.0):
        raise ParameterError(f"{name} is {value}: give {'more than 0' if above else '0 or more'}")


def unknown_notes(controller: Controller) -> tuple[str, ...]:
    """Notes on an assumed damping; other unknowns are searched for as effects."""
    if controller.kd != UNKNOWN:
        return ()
    return (
        "The controller's kd is unknown and assumed to be 0. Where the drive is made from the "
        "controller; the identified viscous friction includes its damping.",
    )
