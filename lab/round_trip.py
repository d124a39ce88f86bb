"""What is named is simulated: identify, write model.xml, simulate it, identify again.

    python lab/round_trip.py [--effects NAME...] [--search] [--seconds 12] [--seed N] > table.md

For each effect a plant of another hand that has it is logged: `lab/plants` (MuJoCo's own parts, a
LuGre joint), of effects of the drive `tests/servo_plant` (MuJoCo's own friction under a firmware).
A fit with the effect, or with --search the whole search, gives a model; the model is written as an
MJCF, loaded, and moved along the same targets by the same controller, its log taken from its own
sensors. The same fit of that log, of the effect in the same form, should give the same numbers.
Errors are in standard errors of the second fit; those of the first are the plant's, which no model
need share. Both models are run freely along their logs, half a second at a time, and under an
effect of the drive the whole log: with the torque that the fits leave, the plant's runs may err as
the model's own, times the ratio of what is left.
"""

import argparse
import sys
import tempfile
import warnings
from pathlib import Path

from round_trip_drive import DRIVES, drive_trip
from round_trip_joint import PLANTS, SLOW, Trip, joint_trip

EFFECTS = (*PLANTS, *DRIVES)
_SLOW_SECONDS = 40.0


def round_trip(
    name: str, folder: Path, seconds: float = 12.0, search: bool = False, seed: int = 0
) -> Trip:
    """There and back with one effect's test joint.

    Args:
        folder: to write into. seconds: of each log of the joint; slow effects have longer ones.
        search: the whole search names the effect, where it is one of the joint.
        seed: of another test joint.
    Raises:
        ValueError: the first fit or search has not found the effect.
    """
    if name in DRIVES:
        return drive_trip(name, folder, seed)
    return joint_trip(name, folder, max(seconds, _SLOW_SECONDS * (name in SLOW)), search, seed)


def row(trip: Trip) -> str:
    """A line of the table."""
    told = [
        ", ".join(f"{key} {x.value:.4g}" for key, x in values.items())
        for values in (trip.first, trip.second)
    ]
    worst = max(trip.errors.values(), default=float("nan"))
    free = [
        "-" if x is None else f"{1e3 * x:.3g}" for x in (trip.before, trip.after, trip.again_free)
    ]
    return (
        f"| {trip.name} | {', '.join(trip.again) or 'nothing'} | {told[0]} | {told[1]} | "
        f"{worst:.1f} | {trip.left:.3g}, {trip.left_again:.3g} | {', '.join(free)} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--effects", nargs="+", choices=EFFECTS, default=list(EFFECTS))
    parser.add_argument("--search", action="store_true")
    parser.add_argument("--seconds", type=float, default=12.0)
    parser.add_argument("--seed", type=int, default=0, help="other plants")
    asked = parser.parse_args()
    warnings.simplefilter("ignore", RuntimeWarning)
    heads = ("effect", "found again", "numbers, first", "again", "worst, standard errors")
    runs = "free runs, mrad: without, with, model's own"
    print(f"| {' | '.join(heads)} | left, N m | {runs} |")
    print("|---" * (len(heads) + 2) + "|")
    within: list[bool] = []
    for name in asked.effects:
        with tempfile.TemporaryDirectory() as folder:
            try:
                trip = round_trip(name, Path(folder), asked.seconds, asked.search, asked.seed)
            except ValueError as error:
                print(f"| {name} | {error} | | | | | |", flush=True)
                continue
        print(row(trip), flush=True)
        within += [error <= 2.0 for error in trip.errors.values()]
    print(f"\n{sum(within)} of {len(within)} numbers within two standard errors.")


if __name__ == "__main__":
    sys.exit(main())
