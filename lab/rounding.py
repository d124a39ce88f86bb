"""What the last bits decide: each joint as it is, and with its logs changed by less than they mean.

    python lab/rounding.py FOLDER...                           plants, in the layout of `trials.py`
    python lab/rounding.py --data DIR [--only emps]            measured logs of `real_logs.py`

Torque and position are multiplied by numbers within 1e-13 to 1e-9 of one, the logs are given in
another order, and OpenBLAS computes with the kernels of other processors or with two threads. All
of these hold the same information. A row per joint: how many of the changes give the same names
with the same ties, and by how much the held-out error changes at most.
"""

import argparse
import multiprocessing
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from real_logs import ROOT, cases
from trials import joint_of, plants_in

from frictionjoint import close_loop
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.readers import read_log

Logs = list[JointLog]


@dataclass(frozen=True)
class Change:
    """What is done to the logs, and the environment in which the loop runs."""

    name: str
    of_logs: Callable[[Logs], Logs]
    environment: Mapping[str, str]


def scaled(channel: str, by: float) -> Callable[[Logs], Logs]:
    """Logs whose channel is multiplied by 1 + by."""

    def change(logs: Logs) -> Logs:
        drives = ("torque", "voltage", "current") if channel == "drive" else (channel,)
        return [
            replace(
                log,
                **{
                    name: getattr(log, name) * (1.0 + by)
                    for name in drives
                    if getattr(log, name) is not None
                },
            )
            for log in logs
        ]

    return change


def same(logs: Logs) -> Logs:
    """The logs as they are."""
    return logs


def backwards(logs: Logs) -> Logs:
    """The logs in the opposite order."""
    return logs[::-1]


CHANGES = [
    *((f"drive {by:+.0e}", "drive", by) for by in (1e-13, -1e-11, 1e-9)),
    *((f"position {by:+.0e}", "position", by) for by in (-1e-13, 1e-11, -1e-9)),
]
KERNELS = ("Haswell", "Zen", "Nehalem")


def changes() -> Iterator[Change]:
    """The logs as they are come first, then what must not matter."""
    yield Change("as they are", same, {})
    for name, channel, by in CHANGES:
        yield Change(name, scaled(channel, by), {})
    yield Change("other order", backwards, {})
    for kernel in KERNELS:
        yield Change(kernel, same, {"OPENBLAS_CORETYPE": kernel})
    yield Change("two threads", same, {"OPENBLAS_NUM_THREADS": "2"})
    other = {"OPENBLAS_CORETYPE": "Haswell", "OPENBLAS_NUM_THREADS": "2"}
    yield Change("Haswell, two threads", same, other)


@dataclass(frozen=True)
class Joint:
    """The logs of a joint: those of a folder of plants, or of a row of `real_logs.cases`."""

    name: str
    model: Path
    joint: str
    fitted: tuple[str, ...]
    held_out: tuple[str, ...] | float


def joints(folders: list[Path], data: Path | None, only: list[str] | None) -> Iterator[Joint]:
    """All that were asked for."""
    for folder in plants_in(folders):
        model, fitted = folder / "model.xml", sorted(folder.glob("fit*.csv"))
        logs = tuple(map(str, fitted)), (str(folder / "held.csv"),)
        yield Joint(str(folder), model, joint_of(model), *logs)
    for case in cases(data) if data else ():
        if not only or case.machine in only:
            model = ROOT / f"models/{case.model}.xml"
            yield Joint(f"{case.machine} {case.joint}", model, case.joint, case.logs, case.held_out)


def found(joint: Joint, name: str) -> tuple[list[list[str]], float]:
    """What is named, each with its ties, and the held-out error."""
    warnings.simplefilter("ignore")
    change = next(c for c in changes() if c.name == name)
    fitted = change.of_logs([read_log(path, joint.joint) for path in joint.fitted])
    held = joint.held_out
    if not isinstance(held, float):
        held = change.of_logs([read_log(path, joint.joint) for path in held])
    report = close_loop(fitted, joint.model, joint.joint, held)
    named = sorted(sorted((a.effect, *a.evidence.ties)) for a in report.added)
    return named, float(report.after_torque.held_out or np.nan)


def in_new_process(joint: Joint, change: Change) -> tuple[list[list[str]], float]:
    """`found` in a process of its own: OpenBLAS reads its environment once."""
    before = dict(os.environ)
    os.environ.update({"OPENBLAS_NUM_THREADS": "1", **change.environment})
    try:
        with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
            return pool.submit(found, joint, change.name).result()
    finally:
        os.environ.clear()
        os.environ.update(before)


def row(joint: Joint) -> str:
    """A line of the table."""
    first, *others = changes()
    named, error = in_new_process(joint, first)
    results = [(c.name, *in_new_process(joint, c)) for c in others]
    differ = [f"{name}: {told}" for name, told, _ in results if told != named]
    worst = max(abs(e / error - 1.0) for _, _, e in results)
    told = "; ".join(" = ".join(ties) for ties in named) or "none"
    alike = len(results) - len(differ)
    return (
        f"| {joint.name} | {told} | {alike} of {len(results)} | {worst:.1e} | {'; '.join(differ)} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--only", action="append", help="a machine; may be repeated")
    asked = parser.parse_args()
    print("| joint | named | same | error changes by | what differs |\n|---|---|---|---|---|")
    for joint in joints(asked.folders, asked.data, asked.only):
        print(row(joint), flush=True)


if __name__ == "__main__":
    main()
