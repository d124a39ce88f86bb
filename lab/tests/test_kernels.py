"""Every kernel of the library gives the numbers of the Python it is translated from."""

import os
import subprocess
import sys
from pathlib import Path
from threading import Thread
from time import perf_counter

import numpy as np

from frictionjoint.law.motion import drive_motions
from frictionjoint.parameters import FrictionParameters


def test_every_kernel_gives_what_its_python_gives_on_random_numbers():
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("kernel_calls.py"))],
        env=os.environ | {"FRICTIONJOINT_PYTHON": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_python_goes_on_while_another_thread_is_in_a_kernel():
    knots = ((1e-4, 1.1), (3e-3, 2.4))
    level = {"Fs": 1.0, "Fc": 0.8, "Vs": 0.1}
    both = {f"{name}_{side}": x for name, x in level.items() for side in ("pos", "neg")}
    P = FrictionParameters(**both, knots=knots).pack()
    t = 1e-3 * np.arange(1_000_000)
    q, edges = 0.1 * np.sin(t), np.array([0, len(t)])
    H, rate = np.empty_like(t), np.empty_like(t)
    drive_motions(P, t[:9], q[:9], np.array([0, 9]), H, rate)  # the first call finds the library
    span: list[float] = []

    def in_a_kernel() -> None:
        span.append(perf_counter())
        drive_motions(P, t, q, edges, H, rate)
        span.append(perf_counter())

    thread = Thread(target=in_a_kernel)
    thread.start()
    seen = []
    while thread.is_alive():
        seen.append(perf_counter())
    begin, end = span
    quarter = (end - begin) / 4
    assert any(begin + quarter < now < end - quarter for now in seen)
