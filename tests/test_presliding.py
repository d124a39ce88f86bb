"""Presliding hysteresis: nested loops, against independent elements and stored paths."""

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import frictionjoint as fj

STORED = Path(__file__).parent / "data" / "presliding.json"
KNOTS = ((1e-5, 1.5), (3e-5, 2.5), (1e-4, 3.2))
# where the stored paths turn, in units of 1e-5 rad
PATHS = {
    "nested": [0, 3, -1, 2, 0, 1.5, 0.2, 3.5, -4],
    "asymmetric": [0, 2.5, 1.5, 2.3, 1.7, 2.6, 4.0, -2.0, -1.0, -3.0],
    "into_sliding": [0, 1, -2, 30, 28, 29, 27, 60, -10],
}


def path(turns):
    legs = [np.linspace(a, b, 40, endpoint=False) for a, b in itertools.pairwise(turns)]
    q = np.append(np.concatenate(legs), turns[-1]) * 1e-5
    return np.arange(len(q)) * 1e-2, q


def friction(**changes):
    values = dict(Fs=1.5, Fc=1.0, Vs=1e-3, sigma2=0.4, sigma1=2.0, n=2, knots=KNOTS) | changes
    return fj.FrictionParameters.symmetric(**values)


def jenkins(q, knots):
    """Torque of elasto-plastic elements in parallel whose virgin curve is Fd(2z)/2.

    Element i is a spring of stiffness K_i - K_{i+1} that yields at half the knot's position;
    written from the definition of an element, not from the law.
    """
    z = np.array([0.0, *(k[0] for k in knots)])
    F = np.array([0.0, *(k[1] for k in knots)])
    slopes = np.append(np.diff(F) / np.diff(z), 0.0)
    stiffness = slopes[:-1] - slopes[1:]
    limit = stiffness * z[1:] / 2
    f = np.zeros(len(stiffness))
    torque = [0.0]
    for step in np.diff(q):
        f = np.clip(f + stiffness * step, -limit, limit)
        torque.append(f.sum())
    return np.array(torque)


@pytest.mark.parametrize("seed", range(20))
def test_nested_loops_equal_a_superposition_of_jenkins_elements(seed):
    parameters = friction(Fc=1.5, sigma1=0.0, sigma2=0.0, n=200, virgin="masing")
    rng = np.random.default_rng(seed)
    turns = np.append(0.0, rng.uniform(-1.7, 1.7, 60))
    time, q = path(turns)
    expected = jenkins(q, KNOTS)
    below = np.flatnonzero(np.abs(expected) > 0.9 * 1.5)
    end = below[0] if below.size else len(q)
    assert end > 200
    found = fj.friction_torque(parameters, time, q)
    np.testing.assert_allclose(found[:end], expected[:end], rtol=0, atol=1e-6 * 1.5)


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("variant", ["ganseman1997", "lampaert2002"])
def test_stored_paths_are_met(name, variant):
    stored = json.loads(STORED.read_text())[f"{name}/{variant}"]
    found = fj.friction_torque(friction(variant=variant), *path(PATHS[name]))
    np.testing.assert_allclose(found[::8], stored, rtol=0, atol=1e-9)


BROKEN = {
    "reversal": "_reverse",
    "closing": "_close",
    "reset": "_reset",
}


@pytest.mark.parametrize("mechanism", BROKEN)
def test_a_broken_mechanism_misses_the_stored_paths(mechanism):
    """The law runs uncompiled with one mechanism taken out: some stored path must object."""
    done = _uncompiled(f"law.{BROKEN[mechanism]} = lambda *a: None")
    worst = max(float(x) for x in done.split())
    # ten thousand times the tolerance of the stored paths
    assert worst > 1e-5, f"no stored path notices a missing {mechanism}"


def test_the_uncompiled_law_meets_the_stored_paths():
    assert max(float(x) for x in _uncompiled("").split()) < 1e-9


def _uncompiled(change):
    code = f"""
import json, numpy as np
import frictionjoint.law.integrated as law
import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})
from test_presliding import PATHS, STORED, friction, path
{change}
limit = 20000
original = law.distance
def counted(*a):
    global limit
    limit -= 1
    if limit < 0: raise RuntimeError('endless')
    return original(*a)
law.distance = counted
import frictionjoint as fj
for name, turns in PATHS.items():
    stored = np.array(json.loads(STORED.read_text())[name + '/ganseman1997'])
    try:
        found = fj.friction_torque(friction(), *path(turns))[::8]
        print(np.max(np.abs(found - stored)))
    except Exception:
        print(1e9)
"""
    environment = {**os.environ, "FRICTIONJOINT_PYTHON": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_torque_far_above_the_level_at_a_large_exponent_relaxes_without_overflow():
    """Fs / Fc of 333 and n = 730: r**n is beyond the largest double, the answer is not."""
    parameters = fj.FrictionParameters.symmetric(
        Fs=5,
        Fc=0.015,
        Vs=3e-5,
        n=730,
        knots=((1e-5, 4), (3e-5, 8), (1e-4, 12)),
        variant="lampaert2002",
    )
    found = fj.friction_torque(parameters, [0, 100, 100.000001], [0, 5e-5, 5e-5 + 1e-9])
    assert np.all(np.isfinite(found))
    assert np.all(np.abs(found) <= 5.0)
