"""The interface of an effect: physical cause, form, units, bounds, source, and its signature in
logs.

An effect adds the torque ``sum_i c_i * column_i(signals; shape)`` to the friction law. The
coefficients c enter linearly; shape numbers (a period, a time constant) do not, and `shapes`
proposes the grid on which they are searched before they are refined. The kernel with number
`effect_id` (see kernel.py) computes the sum both for a log and in a simulation.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from frictionjoint.arrays import Array
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import Commands

Shape = tuple[float, ...]
Entry = Literal[
    "adds torque",
    "scales the friction level",
    "acts on the measurement",
    "acts on the motor",
    "acts on the drive",
]
Plain = Literal["preload", "stiffness", "armature"]
Acts = Literal["torque", "mechanism", "sensors"]


@dataclass(frozen=True, repr=False)
class Effect:
    """One effect beyond the friction law.

    Attributes:
        title: common name; the canonical name if empty.
        name: canonical name; forms of one effect share it and differ in `form`.
        effect_id: number of its kernel in models and files; 0 for an effect of the drive, which has
            none. 8 and 15 belonged to effects that no longer exist.
        kernel: computes its torque, see `kernel.py` for the arguments.
        coefficients: names of the linear coefficients; units: one unit per coefficient, with
            "T" for the joint's torque (N m or N) and "x" for its position (rad or m).
        shape: names of the shape numbers; shape_units: their units.
        shape_fixed: number of leading shape numbers that are references and not estimated.
        shapes: grid of shape numbers to search, from the signals of the log, shape (n, N_SIGNALS).
        needs: signal columns that the effect requires.
        entry: how it enters the torque. cause, form, source, signature: text for people.
        bounds: of each coefficient, in units of its column; they state the physical sign.
        shape_bounds: of each shape number; none where empty.
        slow: it changes over minutes, and is certain long before its end and its rate are known.
        decays_over: the shape number over which its level falls to 37%.
        proposed_by: source of initial shape numbers: the grid of `shapes`, or, for effects fixed
            in angle, the spectrum of the residual over position.
        drives: kinds of drive signal for which the effect is identifiable.
        first: it is decided before all others, because without it every torque is wrong.
        opposes_voltage: it is a voltage proportional to motor speed; it acts only while the
            motor's circuit is closed.
        on_motor: it acts between the drive and the motor torque.
        delays: its shape number is the time by which the drive is logged early, s.
        delays_target: its number is the time by which a controller gets its target late, s.
        is_inertia: its coefficient adds to the joint's inertia.
        acts: what it is in a simulation: a torque in the callback, a joint with springs, or a
            delay of the joint's sensors.
        of_speed: its torque is a function of speed only, and a joint's damping approximates it.
        plain: property of a joint in any simulator, per coefficient; empty if there is none.
        of_inertia: bounds are in units of the joint's inertia.
        of_load: it changes the whole load torque: its coefficient is 1, or, if the motor gain is
            unknown, that of the load.
        of_size: it depends on the magnitude of the transmitted torque.
        leaps: its torque is discontinuous in a shape number, at an impact or a threshold, so the
            residual sum of squares is not smooth and derivatives do not lead to its minimum.
        free: its free oscillation, for a log that begins during one: torque per
            unit of the first coefficient from (shape, (state, rate), signals), shape (n,).
        drive: for an effect of the drive: maps (block, delay, shape) of the documented controller
            to block and delay of the actual one. Such an effect has no coefficients.
        controller: for an effect of the drive, the fields of a `Controller` that it changes.
        drive_shapes: grid of shape numbers to search, from the commands of each log.
        vanishes: the shape number that states its size, and the value at which it changes nothing;
            None: all of them, at 0.
        separating_motion: what to record to distinguish it from similar effects.
    """

    name: str
    cause: str
    form: str
    source: str
    signature: str
    separating_motion: str
    effect_id: int = 0
    kernel: Callable[..., float] | None = None
    coefficients: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    entry: Entry = "adds torque"
    shape: tuple[str, ...] = ()
    shape_units: tuple[str, ...] = ()
    shape_fixed: int = 0
    shapes: Callable[[Array], list[Shape]] = lambda signals: [()]
    needs: tuple[int, ...] = ()
    bounds: tuple[tuple[float, float], ...] = ()
    shape_bounds: tuple[tuple[float, float], ...] = ()
    slow: bool = False
    decays_over: str = ""
    proposed_by: Literal["grid", "spectrum"] = "grid"
    drives: tuple[str, ...] = ("torque", "voltage", "current")
    first: bool = False
    opposes_voltage: bool = False
    on_motor: bool = False
    delays: bool = False
    delays_target: bool = False
    is_inertia: bool = False
    of_speed: bool = False
    plain: tuple[Plain, ...] = ()
    of_inertia: bool = False
    of_load: bool = False
    of_size: bool = False
    leaps: bool = False
    title: str = ""
    acts: Acts = "torque"
    free: Callable[[Shape, tuple[float, float], Array], Array] | None = None
    drive: Callable[[Array, float, Shape], tuple[Array, float]] | None = None
    controller: Callable[[Controller, Shape], dict[str, Any]] | None = None
    drive_shapes: Callable[[Sequence[Commands]], list[Shape]] | None = None
    vanishes: tuple[str, float] | None = None

    def __repr__(self) -> str:
        return f"Effect({self.name!r}, {self.form!r})"

    @property
    def is_wave(self) -> bool:
        """Whether it repeats along the position."""
        return self.proposed_by == "spectrum"

    @property
    def scales(self) -> bool:
        """Whether the coefficient is the relative error of the measured torque."""
        return self.units == ("1",) and self.entry == "acts on the measurement"

    @property
    def size(self) -> int:
        """Length of the number block: shape numbers, then coefficients."""
        return len(self.shape) + len(self.coefficients)


NOTHING = Effect("", "", "", "", "", "")
"""Effect of a term that is none of the catalogue."""
