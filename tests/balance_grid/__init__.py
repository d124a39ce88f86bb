"""Logs whose torque balance is exact: the inertia's torque along a motion given by a formula.

Nothing is simulated, so what a balance leaves of such a log beyond the noise it was given comes
from the balance itself: from its filters, from the encoder's counts, from a torque held for a tick.

    for case in grid(np.random.default_rng(7), keep=lambda s: s.rate == 1000 and not s.friction):
        ...                  # case.logs: columns time_s, position_rad, torque_nm
        write(case, folder)  # log0.csv, log1.csv, ..., model.xml, case.json

motion    position, velocity and acceleration of the motions as formulas
case      the grid of cases, and one case made
files     a case written to a folder
"""

from .case import Case, Friction, Spec, grid, make, specs
from .files import write
from .motion import MOTIONS

__all__ = ["MOTIONS", "Case", "Friction", "Spec", "grid", "make", "specs", "write"]
