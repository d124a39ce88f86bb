"""What the law promises for every parameter and motion, with hypothesis."""

import dataclasses

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.motions import random_motion, random_parameters

from frictionjoint import friction_torque

SEEDS = st.integers(0, 2**32 - 1)
EXPONENTS = st.one_of(st.just(1.0), st.just(2.0), st.floats(1, 1000))


def law(seed, n, **others):
    p = random_parameters(np.random.default_rng(seed))
    return dataclasses.replace(p, n=n, **others)


def dry(seed, n, **others):
    return law(seed, n, sigma1=0.0, sigma2_pos=0.0, sigma2_neg=0.0, **others)


def quasi_static(p):
    return dataclasses.replace(p, Fc_pos=p.Fs_pos, Fc_neg=p.Fs_neg)


def path(turns, per=8):
    turns = np.asarray(turns)
    position = np.interp(
        np.linspace(0, len(turns) - 1, per * (len(turns) - 1) + 1), np.arange(len(turns)), turns
    )
    return np.arange(len(position)) * 0.01, position


@settings(max_examples=150)
@given(
    SEEDS,
    EXPONENTS,
    st.lists(
        st.tuples(st.floats(-12, 3), st.booleans(), st.floats(-6, 2)), min_size=1, max_size=40
    ),
)
def test_finite_and_bounded_for_any_steps(seed, n, moves):
    p = dry(seed, n)
    steps = np.array([10**e * (1 if up else -1) for e, up, _ in moves])
    time = np.concatenate(([0.0], np.cumsum([10**d for *_, d in moves])))
    F = friction_torque(p, time, np.concatenate(([0.0], np.cumsum(steps))))
    assert np.isfinite(F).all()
    assert (p.Fs_pos * (1 + 1e-9) >= F).all()
    assert (-p.Fs_neg * (1 + 1e-9) <= F).all()


@settings(max_examples=60)
@given(SEEDS, EXPONENTS, st.integers(0, 10**6))
def test_mirrored_motion_and_sides_mirror_the_torque(seed, n, motion):
    p = law(seed, n)
    swapped = {
        f"{x}_{a}": getattr(p, f"{x}_{b}")
        for a, b in (("pos", "neg"), ("neg", "pos"))
        for x in ("Fs", "Fc", "Vs", "delta", "sigma2")
    }
    time, q = random_motion(np.random.default_rng(motion), p)
    mirrored = friction_torque(dataclasses.replace(p, **swapped), time, -q)
    np.testing.assert_allclose(mirrored, -friction_torque(p, time, q), atol=1e-12 * p.Fs_pos)


@settings(max_examples=60)
@given(SEEDS, st.floats(0.01, 3), st.floats(0.1, 0.9), EXPONENTS)
def test_every_closed_cycle_dissipates(seed, width, share, n):
    p = dry(seed, n)
    a = width * p.knots[-1][0]
    cycle = [0, a, share * a - a / 2, a / 3, -a, 0]
    time, q = path([*cycle, *(cycle[1:] * 4)], per=40)
    F = friction_torque(p, time, q)
    last = slice(len(q) - 1 - 40 * (len(cycle) - 1), None)
    # Fh moves monotonically within a step, so the work lies between the two rectangle sums
    dq, Fq = np.diff(q[last]), F[last]
    assert np.sum(np.maximum(Fq[1:] * dq, Fq[:-1] * dq)) > 0


@settings(max_examples=60)
@given(SEEDS, st.floats(0.1, 0.8))
def test_a_closed_inner_loop_is_wiped_out(seed, share):
    p = quasi_static(dry(seed, 1000.0))
    reach = min(z for z, F in p.knots if 0.4 * min(p.Fs_pos, p.Fs_neg) <= F)
    a = min(p.knots[0][0], reach) * 0.3 * min(p.Fs_pos, p.Fs_neg) / p.knots[0][1]
    plain = friction_torque(p, *path([0, a, -a / 2, a * 0.9]))
    looped = friction_torque(
        p, *path([0, a, -a / 2, a * 0.5, a * (0.5 - share / 2), a * 0.5, a * 0.9])
    )
    assert abs(plain[-1] - looped[-1]) <= 1e-9 * p.Fs_pos


@settings(max_examples=60)
@given(SEEDS, EXPONENTS, st.floats(1e-3, 1e3))
def test_rate_independent_where_the_level_is_constant(seed, n, factor):
    p = quasi_static(dry(seed, n))
    time, q = random_motion(np.random.default_rng(seed), p)
    np.testing.assert_allclose(
        friction_torque(p, time * factor, q), friction_torque(p, time, q), atol=1e-8 * p.Fs_pos
    )


@settings(max_examples=60)
@given(SEEDS, EXPONENTS, st.integers(2, 9))
def test_refining_a_step_at_constant_speed_changes_nothing(seed, n, parts):
    p = law(seed, n)
    time, q = random_motion(np.random.default_rng(seed), p)
    fine = np.linspace(0, len(q) - 1, parts * (len(q) - 1) + 1)
    knots = np.arange(len(q))
    F = friction_torque(p, np.interp(fine, knots, time), np.interp(fine, knots, q))
    level = max(p.Fs_pos, p.Fs_neg, np.abs(F).max())
    np.testing.assert_allclose(F[::parts], friction_torque(p, time, q), atol=1e-6 * level)
