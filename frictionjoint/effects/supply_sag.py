"""supply-sag: a supply voltage that falls with the motor current."""

from collections.abc import Sequence

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.control.kernel import SAG, SAG_EMF, SUPPLY
from frictionjoint.control.reconstruct import Commands
from frictionjoint.effects.effect import Effect, Shape


def changed(block: Array, delay: float, shape: Shape) -> tuple[Array, float]:
    """The controller block with a supply resistance."""
    block[SAG], block[SAG_EMF] = shape
    return block, delay


def _emfs(logs: Sequence[Commands]) -> list[Shape]:
    fastest = max(float(np.quantile(np.abs(x.velocity), 0.99)) for x in logs)
    supply = float(np.median([x.block[SUPPLY] for x in logs]))
    # back-EMF at the fastest motion, relative to the supply
    return [(0.1, fraction * supply / fastest) for fraction in (0.3, 0.7) if fastest > 0.0]


EFFECT = Effect(
    name="supply-sag",
    title="supply voltage that falls under load",
    cause="battery, cable or adapter with a resistance of its own",
    form="V - sag u (u V - emf v), sag the supply's resistance over the winding's, u the duty",
    source="Kirchhoff's laws of a chopped supply",
    signature="a loss of drive that grows with the cube of the duty, smaller at speed",
    separating_motion="the same motion with a small and a large load",
    entry="acts on the drive",
    shape=("sag", "emf"),
    shape_units=("1", "V s/x"),
    shape_bounds=((0.0, 0.5), (0.0, float("inf"))),
    drives=("voltage",),
    drive=changed,
    controller=lambda controller, shape: {"sag": shape[0], "sag_emf": shape[1]},
    drive_shapes=_emfs,
)
