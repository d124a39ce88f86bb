"""The claims of Ganseman et al. (1997), each held to a number (lab/paper draws them)."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from paper import (
    constant_velocity,
    general,
    presliding,
    quasi_static,
    reversal,
    stick_slip,
    whisker,
)
from scipy.integrate import solve_ivp


@pytest.mark.parametrize("seed", range(5))
def test_constant_velocity_points_give_both_signs_parameters_back(seed):
    found = constant_velocity.recover(*constant_velocity.measure(seed))
    for name, (value, error) in found.items():
        true = getattr(constant_velocity.TRUE, name)
        assert abs(value - true) < 4.0 * error
        assert error < 0.15 * true


def test_steady_torque_is_the_stribeck_level_of_its_sign():
    p = constant_velocity.TRUE
    for speed, side in ((0.02, "pos"), (-0.02, "neg")):
        values = [getattr(p, f"{name}_{side}") for name in constant_velocity.NAMES]
        wanted = np.sign(speed) * constant_velocity.level(abs(speed), *values)
        assert constant_velocity.steady_torque(p, speed) == pytest.approx(wanted, rel=1e-9)


# drift in um a cycle, as derived for the model notes before the law was written
DRIFT = {
    ("ganseman1997", 1): 18.1,
    ("ganseman1997", 2): 8.2,
    ("ganseman1997", 4): 3.2,
    ("ganseman1997", 10): 0.60,
    ("ganseman1997", 50): 0.0008,
    ("lampaert2002", 1): 33.4,
    ("lampaert2002", 2): 15.2,
    ("lampaert2002", 4): 6.2,
    ("lampaert2002", 10): 1.4,
    ("lampaert2002", 50): 0.0055,
}


@pytest.mark.parametrize("case", DRIFT, ids=lambda c: f"{c[0]}-{c[1]}")
def test_whisker_loop_closes_only_as_n_grows(case):
    variant, n = case
    p = replace(whisker.LAW, n=n, variant=variant)
    low, high = whisker.C * whisker.Fs, whisker.B * whisker.Fs
    by_integral = quasi_static.drift(p, low, high)
    assert 1e6 * by_integral == pytest.approx(DRIFT[case], rel=0.04)
    if n in (1, 10):
        drift, loss = whisker.closure(p, cycles=2)
        assert drift == pytest.approx(by_integral, rel=0.02)
        assert loss == pytest.approx(quasi_static.loss(p, low, high), rel=0.02)


def lugre_cycle(sigma0: float, Fs: float, low: float, high: float) -> tuple[float, float]:
    """LuGre at rest speed by scipy: displacement gained, m, and energy lost, J, in one force cycle.

    Slow: F = sigma0 z, so dz/dx = 1 - sgn(v) F / Fs gives dx = dF / (sigma0 (1 - sgn(v) F / Fs)).
    """
    x = loss = 0.0
    for start, end, s in ((low, high, 1.0), (high, low, -1.0)):

        def slopes(F, _, s=s):
            dx = 1.0 / (sigma0 * (1.0 - s * F / Fs))
            return [dx, F * dx]

        found = solve_ivp(slopes, (start, end), [0.0, 0.0], rtol=1e-10, atol=1e-18)
        x += found.y[0, -1]
        loss += found.y[1, -1]
    return x, loss


def test_whisker_loop_of_lugre_does_not_close():
    drift, loss = lugre_cycle(whisker.SIGMA0, whisker.Fs, 0.3, 1.35)
    assert 1e6 * drift == pytest.approx(24.3, rel=1e-3)
    assert drift == pytest.approx(
        quasi_static.lugre_drift(whisker.SIGMA0, 1.5, 0.3, 1.35), rel=1e-6
    )
    assert loss == pytest.approx(quasi_static.lugre_loss(whisker.SIGMA0, 1.5, 0.3, 1.35), rel=1e-6)
    # ours drifts a twentieth of that at n = 10, a thirty-thousandth at n = 50
    for n, share in ((10, 0.03), (50, 1e-4)):
        assert quasi_static.drift(replace(whisker.LAW, n=n), 0.3, 1.35) < share * drift


def test_reversal_is_continuous_and_starts_at_the_first_slope_of_fd():
    found = reversal.numbers()
    assert found["jump_of_Fh_at_reversal_Nm"] <= found["step_of_Fh_elsewhere_Nm"]
    stiffness = found["stiffness_after_reversal_Nm_per_rad"]
    assert stiffness == pytest.approx(found["first_slope_of_Fd_Nm_per_rad"], rel=1e-6)
    assert stiffness > 1.2 * found["stiffness_before_reversal_Nm_per_rad"]


def test_a_closed_loop_leaves_less_trace_as_n_grows():
    found = reversal.numbers()
    assert found["extrema_inside_the_loop"] == 4
    assert found["extrema_after_closing"] == 2
    left = list(found["trace_left_in_Fs"].values())
    assert all(b < a for a, b in itertools.pairwise(left))
    assert left[-1] < 1e-6 < 0.01 < left[0]


def test_presliding_loops_grow_with_amplitude_from_none_in_the_first_segment():
    areas = [presliding.area(a) for a in presliding.AMPLITUDES]
    assert abs(areas[0]) < 1e-9 * areas[-1]
    assert areas[1] < areas[2] < areas[3]


@pytest.mark.parametrize("seed", range(3))
def test_three_segments_are_read_off_a_noisy_loop(seed):
    np.testing.assert_allclose(
        presliding.identify_segments(seed), presliding.true_segments(), rtol=0.01
    )


def test_breakaway_force_falls_with_the_rate_of_the_force():
    force = [general.breakaway(general.SLIDER, rate) for rate in (1.0, 10.0, 50.0)]
    assert 1.5 > force[0] > 1.1 * force[1] > 1.2 * force[2] > 1.2


def test_friction_lags_more_at_a_higher_frequency():
    widths = [general.lag_width(general.SLIDER, w) for w in general.FREQUENCIES]
    assert 0.02 < widths[0] < 0.2 * widths[1]
    assert widths[1] < widths[2]
    # loops are run through clockwise: friction is higher while speeding up
    v, F = general.lag_loop(general.SLIDER, 10.0)
    half = len(v) // 2
    rising = np.interp(1.5e-3, v[half:], F[half:])
    assert rising > np.interp(1.5e-3, v[:half][::-1], F[:half][::-1])


def test_presliding_goes_over_into_sliding_without_a_step():
    for n in (1, 50):
        p = replace(whisker.LAW, n=n)
        steps = [general.largest_step(p, m) for m in (1000, 10000, 100000)]
        assert steps[1] < 0.15 * steps[0]
        assert steps[2] < 0.15 * steps[1]


def test_memory_reaches_back_beyond_the_last_reversal():
    found = general.memory_numbers()
    assert found["largest_difference_below_it_Nm"] < 1e-9
    assert found["difference_at_the_end_Nm"] > 5.0


# the paper reports 6% on the measured joint; a plant of another law is a harder one
@pytest.mark.parametrize(("law", "within"), [("generalised Maxwell-slip", 0.1), ("LuGre", 0.06)])
def test_stick_slip_is_predicted_from_other_motions(law, within):
    """Friction identified from constant velocities and presliding, on another law's joint."""
    measured = stick_slip.slips(*stick_slip.measured_stick_slip(law))
    fitted = stick_slip.identify(stick_slip.logs(law))
    found = stick_slip.slips(*stick_slip.predicted(fitted))
    assert len(measured) >= 8
    assert abs(len(found) - len(measured)) <= 1
    assert stick_slip.slip_error(measured, found) < within
    assert fitted.coefficient("0.bias") == pytest.approx(-12.72, abs=0.6)


def test_stick_slip_with_the_other_joints_own_parameters_is_within_the_papers_six_per_cent():
    """No fit: what is left is the form of the law, smaller as n grows."""
    measured = stick_slip.slips(*stick_slip.measured_stick_slip("generalised Maxwell-slip"))
    errors = [
        stick_slip.slip_error(measured, stick_slip.slips(*stick_slip.with_own_parameters(n)))
        for n in (2, 50)
    ]
    assert errors[1] < 0.06 < errors[0] < 0.1
