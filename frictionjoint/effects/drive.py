"""Effects of the drive: what a controller does that its file does not describe.

They act on the controller output and have no kernel in the joint: each changes the block of numbers
of the controller, or the delay of its target.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control import kernel
from frictionjoint.control.controller import Controller
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape

_of_drive = partial(Effect, entry="acts on the drive")
_POSITIVE = (0.0, math.inf)


def _at_most(at: int, block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with a lower limit of one of its numbers."""
    block[at] = min(block[at], shape[0])
    return block, delay


def _with_numbers(
    at: list[int], block: Array, delay: float, shape: Shape, more: Shape = ()
) -> tuple[Array, float]:
    """The controller block with other numbers: those of the effect, and `more`."""
    block[at] = (*shape, *more)
    return block, delay


def _with_factor(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    block[kernel.KP] *= shape[0]
    return block, delay


def _fastest(logs: Sequence[Commands], part: float) -> float:
    """The largest quantile of the speeds of a log."""
    return max(float(np.quantile(np.abs(x.velocity), part)) for x in logs)


def _errors(log: Commands) -> Array:
    """Size of the position error where the drive is on."""
    return np.asarray(np.abs(log.target - log.position)[log.on])


def delayed(controller: Controller, shape: Shape) -> dict[str, Any]:
    """Entries of a controller file whose targets act later by the first number, s."""
    before = controller.delay_s
    return {"delay_s": shape[0] + (0.0 if isinstance(before, str) else before)}


COMMAND_DELAY = _of_drive(
    name="command-delay",
    title="command delay",
    cause="buses, queues and firmware between a command and the drive",
    form="u of target(t - delay), each target held until the next",
    source="pure delay of the reference channel",
    signature="proportional to the target's velocity; nothing while the target stands",
    separating_motion="steps of the target, and a fast sine",
    shape=("delay",),
    shape_units=("s",),
    shape_bounds=((0.0, 0.5),),
    drive=lambda block, delay, shape: (block, delay + shape[0]),
    controller=delayed,
    # from a tick of a fast bus to a slow camera
    drive_shapes=lambda logs: [(delay,) for delay in (0.004, 0.012, 0.03, 0.08)],
    delays_target=True,
)


def _rates(logs: Sequence[Commands]) -> list[Shape]:
    fastest = _fastest(logs, 0.999)
    # with a limit far above the right one the gradient vanishes: one starts slightly above it
    fractions = np.geomspace(0.4, 1.8, 10)
    return [(float(fraction * fastest),) for fraction in fractions if fastest > 0.0]


COMMAND_RATE = _of_drive(
    name="command-rate",
    title="speed limit of the target",
    cause="a motion profile in the firmware, with a largest speed",
    form="u of a target that moves towards the commanded one at most at `rate`",
    source="goal speed and acceleration registers of servos (Feetech STS, Dynamixel profile "
    "velocity)",
    signature="after a step of the target the output rises steadily, more slowly at a lower kp",
    separating_motion="steps of the target at two gains",
    shape=("rate",),
    shape_units=("x/s",),
    shape_bounds=(_POSITIVE,),
    drive=partial(_at_most, kernel.SLEW),
    controller=lambda controller, shape: {"target_rate": shape[0]},
    drive_shapes=_rates,
)


def _limits(logs: Sequence[Commands]) -> list[Shape]:
    most = max(float(np.abs(x.drive() / x.supply).max() / x.block[kernel.SUPPLY]) for x in logs)
    return [(fraction * most,) for fraction in (0.15, 0.3, 0.45, 0.6, 0.75, 0.9) if most > 0.0]


DRIVE_LIMIT = _of_drive(
    name="drive-limit",
    title="limit of the drive",
    cause="a current, torque or duty limit in the firmware",
    form="|u| <= limit, u in the unit of the controller's output",
    source="goal PWM and torque limit registers of servos",
    signature="at large position errors the output stays at one value",
    separating_motion="steps of the target of several sizes",
    shape=("limit",),
    shape_units=("output",),
    shape_bounds=(_POSITIVE,),
    drive=partial(_at_most, kernel.LIMIT),
    controller=lambda controller, shape: {"limit": shape[0]},
    drive_shapes=_limits,
)


def _bands(logs: Sequence[Commands], quantiles: Sequence[float] | Array) -> list[Shape]:
    errors = np.concatenate([_errors(x) for x in logs])
    return [(float(d),) for d in np.unique(np.quantile(errors, quantiles)) if d > 0.0]


_BAND = [kernel.DEADBAND, kernel.SHIFTED]
DEADBAND = _of_drive(
    name="deadband",
    title="dead band of the controller",
    cause="a dead zone in the firmware, so that a servo at its target is silent",
    form="u = 0 where |target - q| <= deadband",
    source="dead zone registers of hobby servos (Feetech, memory table, CW and CCW dead zone)",
    signature="no output at small position errors, at any speed",
    separating_motion="slow approach of the target from both sides, at two gains",
    shape=("deadband",),
    shape_units=("x",),
    shape_bounds=(_POSITIVE,),
    leaps=True,
    drive=partial(_with_numbers, _BAND, more=(0.0,)),
    controller=lambda controller, shape: {"deadband": shape[0], "deadband_form": "cut"},
    # the torque is discontinuous, so a start must be within a few per cent of the samples
    drive_shapes=partial(_bands, quantiles=np.linspace(0.02, 0.5, 25)),
)
# only the part of an error that exceeds the band acts
SHIFTED_DEADBAND = replace(
    DEADBAND,
    form="u of the error less deadband sgn(error), 0 where |target - q| <= deadband",
    leaps=False,
    drive=partial(_with_numbers, _BAND, more=(1.0,)),
    controller=lambda controller, shape: {"deadband": shape[0], "deadband_form": "shifted"},
    drive_shapes=partial(_bands, quantiles=(0.05, 0.1, 0.2, 0.35, 0.5)),
)


def _dropping(of: str, controller: Controller, shape: Shape) -> dict[str, Any]:
    return {"drop_above": shape[0], "drop_of": of, "drop_left": shape[1]}


def _thresholds(monitored: Sequence[Array]) -> list[Shape]:
    """Quantiles of the monitored quantity, over samples and over their squares, and what is left.

    The torque is discontinuous, so a start must be within a few per cent of the samples or of the
    drive. A leg that follows slowly and jumps now and then has most of its samples at small errors
    and most of its drive at large ones.
    """
    size = np.sort(np.concatenate(monitored))
    squares = np.cumsum(size**2)
    parts = np.linspace(0.02, 0.98, 20)
    at = np.minimum(np.searchsorted(squares, parts * squares[-1]), len(size) - 1)
    of_samples = np.quantile(size, np.linspace(0.02, 0.98, 30))
    thresholds = np.unique(np.concatenate([of_samples, size[at]]))
    return [(float(x), 0.4) for x in thresholds if x > 0.0]


DUTY_DROP = _of_drive(
    name="duty-drop",
    title="output reduced at large error",
    cause="overload protection that lowers the duty",
    form="left u where |target - q| > threshold",
    source="protective torque and overload registers of Feetech STS servos; scope measurements of "
    "K-Scale Labs (2025)",
    signature="less drive at large errors than at smaller ones",
    separating_motion="hold the joint away from its target by several distances, at two gains",
    shape=("threshold", "left"),
    shape_units=("x", "1"),
    shape_bounds=(_POSITIVE, (0.0, 1.0)),
    leaps=True,
    drive=partial(_with_numbers, [kernel.DROP_ERROR, kernel.DROP_LEFT]),
    controller=partial(_dropping, "error"),
    drive_shapes=lambda logs: _thresholds([_errors(x) for x in logs]),
)
DROP_ABOVE_OUTPUT = replace(
    DUTY_DROP,
    form="left u where |u| > threshold, u in the unit of the controller's output",
    shape_units=("output", "1"),
    drive=partial(_with_numbers, [kernel.DROP_OUTPUT, kernel.DROP_LEFT]),
    controller=partial(_dropping, "output"),
    drive_shapes=lambda logs: _thresholds([x.block[kernel.KP] * _errors(x) for x in logs]),
)


def _emfs(logs: Sequence[Commands]) -> list[Shape]:
    fastest = _fastest(logs, 0.99)
    supply = float(np.median([x.block[kernel.SUPPLY] for x in logs]))
    # back-EMF at the fastest motion, relative to the supply
    return [(0.1, fraction * supply / fastest) for fraction in (0.3, 0.7) if fastest > 0.0]


SUPPLY_SAG = _of_drive(
    name="supply-sag",
    title="supply voltage that falls under load",
    cause="battery, cable or adapter with a resistance of its own",
    form="V - sag u (u V - emf v), sag the supply's resistance over the winding's, u the duty",
    source="Kirchhoff's laws of a chopped supply",
    signature="a loss of drive that grows with the cube of the duty, smaller at speed",
    separating_motion="the same motion with a small and a large load",
    shape=("sag", "emf"),
    shape_units=("1", "V s/x"),
    shape_bounds=((0.0, 0.5), _POSITIVE),
    drives=("voltage",),
    drive=partial(_with_numbers, [kernel.SAG, kernel.SAG_EMF]),
    controller=lambda controller, shape: {"sag": shape[0], "sag_emf": shape[1]},
    drive_shapes=_emfs,
)


def _with_gain(controller: Controller, shape: Shape) -> dict[str, Any]:
    kp = controller.kp
    if isinstance(kp, str):
        return {"gain_unit": controller.gain_unit * shape[0]}
    return {"kp": kp * shape[0]}


GAIN_ERROR = _of_drive(
    name="gain-error",
    title="wrong controller gain",
    cause="a gain that was changed or is in another unit",
    form="factor kp (target - q) in place of kp (target - q)",
    source="definition of the proportional gain",
    signature="proportional to the position error; absent where the output is at its limit",
    separating_motion="a motion with a known extra load, and steps that reach the limit",
    shape=("factor",),
    shape_units=("1",),
    shape_bounds=((0.05, 20.0),),
    # with a voltage the motor gain is unknown anyway, and the two are the same number
    drives=("torque",),
    drive=_with_factor,
    controller=_with_gain,
    drive_shapes=lambda logs: [(factor,) for factor in (0.7, 0.85, 1.2, 1.5)],
    vanishes=("factor", 1.0),
)

DRIVE_EFFECTS: tuple[Effect, ...] = (
    COMMAND_DELAY,
    COMMAND_RATE,
    DRIVE_LIMIT,
    DEADBAND,
    SHIFTED_DEADBAND,
    DUTY_DROP,
    DROP_ABOVE_OUTPUT,
    SUPPLY_SAG,
    GAIN_ERROR,
)
"""In the order of preference among forms that are equally good."""
