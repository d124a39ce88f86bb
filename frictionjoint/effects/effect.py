"""The contract of an effect: physical cause, form, units, bounds, source, and how to spot it.

An effect adds the torque ``sum_i c_i * column_i(signals; shape)`` to the friction law. The
coefficients c enter linearly; shape numbers (a period, a time constant) do not, and
`shapes` proposes the grid on which they are searched before they are refined. The kernel
behind `effect_id` (see kernel.py) computes the sum both for a log and in a simulation.
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


def _no_shape(signals: Array) -> list[Shape]:
    return [()]


@dataclass(frozen=True, repr=False)
class Effect:
    """One effect beyond the friction law.

    Attributes:
        title: what a person calls it; the name where it is empty.
        name: canonical name; two forms of one effect have the same and differ in `form`.
        effect_id: number of its kernel.
        coefficients: names of the linear coefficients; units: one unit a coefficient, with
            "T" for the joint's torque (N m or N) and "x" for its position (rad or m).
        shape: names of the shape numbers; shape_units: their units.
        shape_fixed: how many of the shape numbers, the first ones, are references, not estimated.
        shapes: grid of shape numbers to search, from the signals of the log, shape (n, N_SIGNALS).
        needs: signal columns without which the effect cannot be tested.
        entry: how it enters. cause, form, source, signature: for people.
        bounds: of each coefficient, in units of its column; physical signs live here.
        shape_bounds: of each shape number; none where empty.
        slow: it changes over minutes, so that a log may hold one value of it: its gain is judged
            on stretches of every log, not on whole logs.
        memory: float64 of state the kernel keeps.
        proposed_by: what its shape numbers are proposed by: the grid of `shapes`, or, for what is
            fixed in angle, the spectrum of the residual over position.
        drives: what a log must hold of the motor for the effect to show.
        first: it is decided before anything else, for without it every torque is off.
        opposes_voltage: it takes from the voltage what turns with the motor; it acts only while the
            motor's circuit is closed.
        on_motor: it stands between the drive and the motor's torque.
        delays: its shape number is a time by which the drive is logged early, s.
        delays_target: it is a time by which a controller gets its target late, s.
        is_inertia: its coefficient adds to the joint's inertia.
        acts: what it is in a simulation: a torque of the callback, a joint and its springs, or a
            delay of the joint's sensors.
        of_speed: its torque is a function of the speed alone, which a joint's damping approximates.
        plain: what each coefficient is of a joint in any simulator; none where empty.
        of_inertia: bounds are in units of the joint's inertia.
        of_load: it changes what the load asks of the motor, all of it: its coefficient is 1, of a
            motor whose gain is unknown as much as the load's.
        of_size: it depends on how much torque the gear transmits, whatever its sign.
        leaps: its torque leaps with a shape number, at an impact or a threshold: the squares that a
            fit leaves are rough, and derivatives say little of where they are least.
        free: its motion without excitation, for a log that begins in the middle of one: torque per
            unit of the first coefficient from (shape, (state, rate), signals), shape (n,).
        drive: of an effect of the drive, from (block, delay, shape) of a controller to block and
            delay of what it truly is; such an effect has no kernel and no coefficients.
        controller: of an effect of the drive, the fields of a `Controller` that it changes.
        drive_shapes: grid of shape numbers to search, from the commands of each log.
        separating_motion: what to record to distinguish it from its nearest neighbours.
    """

    name: str
    effect_id: int
    coefficients: tuple[str, ...]
    units: tuple[str, ...]
    cause: str
    form: str
    source: str
    signature: str
    separating_motion: str
    entry: Entry = "adds torque"
    shape: tuple[str, ...] = ()
    shape_units: tuple[str, ...] = ()
    shape_fixed: int = 0
    shapes: Callable[[Array], list[Shape]] = _no_shape
    needs: tuple[int, ...] = ()
    bounds: tuple[tuple[float, float], ...] = ()
    shape_bounds: tuple[tuple[float, float], ...] = ()
    slow: bool = False
    memory: int = 0
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

    def __repr__(self) -> str:
        return f"Effect({self.name!r}, {self.form!r})"

    @property
    def decided_first(self) -> bool:
        """Whether without it every torque is off: a motor's own, or the drive itself."""
        return self.first or self.drive is not None

    @property
    def scales(self) -> bool:
        """Whether its coefficient is the error of a measured torque over the true one."""
        return self.units == ("1",) and self.entry == "acts on the measurement"

    @property
    def size(self) -> int:
        """Length of the number block: shape numbers, then coefficients."""
        return len(self.shape) + len(self.coefficients)
