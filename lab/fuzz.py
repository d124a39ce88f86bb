"""Fuzz what comes from outside: logs, parameter files, MJCFs that carry friction.

    python lab/fuzz.py [--inputs 30000] [--seed 0] [--only TARGET] [--out fuzz]

The inputs are those of tests/test_logs_fuzz.py, test_parameters_fuzz.py and test_carrier_fuzz.py,
any number of them: each must end in a value that keeps its promises or in an error of one line.
Every target runs in processes of its own, so that a crash or an endless loop is a finding too.
Prints the inputs and the failures of each target; an input of each kind of failure is kept in the
folder, with `fuzz.json`. Exit code 1 where anything failed.
"""

import argparse
import importlib
import json
import mmap
import multiprocessing
import os
import signal
import struct
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

TESTS = Path(__file__).resolve().parents[1] / "tests"
TARGETS = ("logs", "parameters", "carrier")
_FILES = {"parameters": "joint.toml", "carrier": "arm.xml"}
# Inputs a process tries before the next takes over, and examples of a generator in a row.
_SHIFT, _ROW = 20000, 500
# Computing time an input may take; a loaded machine and the first compilation of a kernel count.
_PATIENCE_S = 120.0
_HUNG = -signal.SIGPROF
# What a process writes down before each input: inputs so far, length of the input, the input.
_HEAD = struct.Struct("<QQ")
_ROOM = 1 << 20


@dataclass
class Found:
    """What a target did: inputs tried, and failures by where they happened with their number."""

    inputs: int = 0
    failures: dict[str, int] = field(default_factory=dict)

    def add(self, place: str, content: bytes, stem: Path) -> None:
        """Count a failure; the first input of its kind is kept."""
        if place not in self.failures:
            kept = stem.with_name(f"{stem.name}-{len(self.failures)}")
            kept.with_suffix(".input").write_bytes(content)
            kept.with_suffix(".txt").write_text(place + "\n")
        self.failures[place] = self.failures.get(place, 0) + 1


def shift(target: str, seed: int, inputs: int, notes: Path, results: Any) -> None:
    """A process's work: try `inputs` inputs and send the failures, each as (place, content)."""
    os.environ["FRICTIONJOINT_FUZZ"] = str(_ROW)
    sys.path.insert(0, str(TESTS))
    from hypothesis import HealthCheck, settings
    from hypothesis import seed as seeded

    quiet = {"deadline": None, "database": None, "suppress_health_check": list(HealthCheck)}
    settings.register_profile("fuzz", **quiet)
    settings.load_profile("fuzz")
    module = importlib.import_module(f"test_{target}_fuzz")
    log = mmap.mmap(os.open(notes, os.O_RDWR), _ROOM)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # MuJoCo's warnings about each broken file
    check, done = module.never_anything_else, 0

    def watched(*arguments: Any) -> None:
        nonlocal done
        content = next(a for a in arguments if isinstance(a, bytes))[: _ROOM - _HEAD.size]
        log[: _HEAD.size + len(content)] = _HEAD.pack(done, len(content)) + content
        done += 1
        signal.setitimer(signal.ITIMER_PROF, _PATIENCE_S)
        try:
            check(*arguments)
        except Exception as error:
            results.put((place(error), content))

    module.never_anything_else = watched
    tests = [x for name, x in vars(module).items() if name.startswith("test_")]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        given = {"file": Path(_FILES[target])} if target in _FILES else {}
        turn = 0
        while done < inputs:
            seeded(seed * 1000003 + turn)(tests[turn % len(tests)])(**given)
            turn += 1
        os.chdir("/")
    log[: _HEAD.size] = _HEAD.pack(done, 0)


def place(error: Exception) -> str:
    """The kind of an error and the innermost line of this project it passed through."""
    own = [f for f in traceback.extract_tb(error.__traceback__) if str(TESTS.parent) in f.filename]
    where = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else "?"
    return f"{type(error).__name__} at {where}"


def fuzz(target: str, seed: int, inputs: int, out: Path) -> Found:
    """Try at least `inputs` inputs on a target, in as many processes as it takes."""
    found, turn = Found(), 0
    spawn = multiprocessing.get_context("spawn")
    notes = out / f"{target}.now"
    while found.inputs < inputs:
        notes.write_bytes(bytes(_ROOM))
        results = spawn.SimpleQueue()
        wanted = min(_SHIFT, inputs - found.inputs)
        worker = spawn.Process(
            target=shift, args=(target, seed * 10007 + turn, wanted, notes, results)
        )
        worker.start()
        while worker.is_alive() or not results.empty():
            worker.join(0.2)
            while not results.empty():
                found.add(*results.get(), out / target)
        done, length = _HEAD.unpack(notes.read_bytes()[: _HEAD.size])
        found.inputs += done
        if worker.exitcode:
            content = notes.read_bytes()[_HEAD.size : _HEAD.size + length]
            hung = worker.exitcode == _HUNG
            why = f"no end in {_PATIENCE_S:g} s" if hung else f"exit code {worker.exitcode}"
            found.add(why, content, out / target)
            found.inputs += 1
        turn += 1
        print(f"{target}: {found.inputs} inputs, {sum(found.failures.values())} failed", flush=True)
    notes.unlink()
    return found


def main() -> None:
    """Run the targets one after the other."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--inputs", type=int, default=30000, help="in all, over the targets")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=TARGETS, help="this target alone")
    parser.add_argument("--out", type=Path, default=Path("fuzz"), help="folder for what failed")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    targets = (given.only,) if given.only else TARGETS
    share = -(-given.inputs // len(targets))
    begin = time.monotonic()
    found = {t: fuzz(t, given.seed, share, given.out.resolve()) for t in targets}
    rows = {t: {"inputs": x.inputs, "failures": x.failures} for t, x in found.items()}
    (given.out / "fuzz.json").write_text(json.dumps(rows, indent=2) + "\n")
    for target, x in found.items():
        print(f"{target}: {x.inputs} inputs, {sum(x.failures.values())} failures")
        for where, number in x.failures.items():
            print(f"  {number} x {where}")
    print(f"{sum(x.inputs for x in found.values())} inputs, {time.monotonic() - begin:.0f} s")
    raise SystemExit(any(x.failures for x in found.values()))


if __name__ == "__main__":
    main()
