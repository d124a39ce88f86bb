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

    In units "T" is the joint's torque (N m or N) and "x" its position (rad or m).
    """

    name: str  # canonical; forms of one effect share it and differ in `form`
    # text for people
    cause: str
    form: str
    source: str
    signature: str
    separating_motion: str  # what to record to distinguish it from similar effects
    # number of its kernel in models and files; 0 for an effect of the drive, which has none. 8 and
    # 15 belonged to effects that no longer exist
    effect_id: int = 0
    kernel: Callable[..., float] | None = None  # computes its torque; arguments: see kernel.py
    coefficients: tuple[str, ...] = ()  # names of the linear coefficients
    units: tuple[str, ...] = ()  # one per coefficient
    entry: Entry = "adds torque"  # how it enters the torque
    shape: tuple[str, ...] = ()  # names of the shape numbers
    shape_units: tuple[str, ...] = ()
    shape_fixed: int = 0  # number of leading shape numbers that are references, not estimated
    # grid of shape numbers to search, from the signals of the log, shape (n, N_SIGNALS)
    shapes: Callable[[Array], list[Shape]] = lambda signals: [()]
    needs: tuple[int, ...] = ()  # signal columns that the effect requires
    # of each coefficient, in units of its column; they state the physical sign
    bounds: tuple[tuple[float, float], ...] = ()
    shape_bounds: tuple[tuple[float, float], ...] = ()  # of each shape number; none where empty
    # it changes over minutes, and is certain long before its end and its rate are known
    slow: bool = False
    decays_over: str = ""  # the shape number over which its level falls to 37%
    # source of initial shape numbers: the grid of `shapes`, or, for effects fixed in angle, the
    # spectrum of the residual over position
    proposed_by: Literal["grid", "spectrum"] = "grid"
    # kinds of drive signal for which it is identifiable
    drives: tuple[str, ...] = ("torque", "voltage", "current")
    first: bool = False  # it is decided before all others: without it every torque is wrong
    # it is a voltage proportional to motor speed, and acts while the motor's circuit is closed
    opposes_voltage: bool = False
    on_motor: bool = False  # it acts between the drive and the motor torque
    delays: bool = False  # its shape number is the time by which the drive is logged early, s
    delays_target: bool = False  # it is the time by which a controller gets its target late, s
    is_inertia: bool = False  # its coefficient adds to the joint's inertia
    of_speed: bool = False  # its torque depends on speed only; a joint's damping approximates it
    plain: tuple[Plain, ...] = ()  # property of a joint in any simulator, per coefficient
    of_inertia: bool = False  # its bounds are in units of the joint's inertia
    # it changes the whole load torque: its coefficient is 1, or, if the motor gain is unknown, that
    # of the load
    of_load: bool = False
    of_size: bool = False  # it depends on the magnitude of the transmitted torque
    # its torque is discontinuous in a shape number, at an impact or a threshold, so the residual
    # sum of squares is not smooth and derivatives do not lead to its minimum
    leaps: bool = False
    title: str = ""  # common name; the canonical name if empty
    # what it is in a simulation: a torque in the callback, a joint with springs, or a delay of the
    # joint's sensors
    acts: Acts = "torque"
    # its free oscillation, for a log that begins during one: torque per unit of the first
    # coefficient from (shape, (state, rate), signals), shape (n,)
    free: Callable[[Shape, tuple[float, float], Array], Array] | None = None
    # for an effect of the drive, which has no coefficients: maps (block, delay, shape) of the
    # documented controller to block and delay of the actual one; the fields of a `Controller` that
    # it changes; the grid of shape numbers to search, from the commands of each log
    drive: Callable[[Array, float, Shape], tuple[Array, float]] | None = None
    controller: Callable[[Controller, Shape], dict[str, Any]] | None = None
    drive_shapes: Callable[[Sequence[Commands]], list[Shape]] | None = None
    # the shape number that states its size, and the value at which it changes nothing; None: all of
    # them, at 0
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
