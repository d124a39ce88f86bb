"""What the stated standard errors promise, on least squares whose truth is known exactly."""

import numpy as np
from scipy.signal import lfilter

from frictionjoint.effects.signals import N_SIGNALS, V
from frictionjoint.identify.blocks import make_blocks
from frictionjoint.identify.fit import Fit
from frictionjoint.identify.intervals import covariance
from frictionjoint.identify.layout import Layout
from frictionjoint.identify.noise import Band, Noise
from frictionjoint.identify.segment import Prepared, Segment
from frictionjoint.identify.shape import INTEGRATED

LOGS, SAMPLES, DT = 4, 1500, 0.02
TRUE = np.array([0.3, 0.8])  # sigma2 in N m s/rad, Fc in N m
REPEATS = 400
NOISE = Noise(0.0, np.zeros(1), np.zeros(1), 0.0, 0.0)


def speeds(rng):
    """Sums of sines of other phases for each log, rad/s."""
    t = DT * np.arange(SAMPLES)
    w, phase = np.geomspace(0.3, 5.0, 6), rng.uniform(0.0, 2.0 * np.pi, (LOGS, 6))
    return np.sin(w * t[:, None, None] + phase).sum(axis=2).T


def correlated(rng, size):
    """Noise correlated over 20 samples or so, standard deviation 1."""
    rho = 0.9
    return lfilter([np.sqrt(1.0 - rho**2)], [1.0, -rho], rng.standard_normal((LOGS, size)))


def fitted(v, torque):
    """Least squares of sigma2 v + Fc sgn(v) on all logs."""
    X = np.column_stack([v.ravel(), np.sign(v).ravel()])
    beta = np.linalg.lstsq(X, torque.ravel(), rcond=None)[0]
    segments = []
    for one in v:
        signals = np.zeros((SAMPLES, N_SIGNALS))
        signals[:, V] = one
        mask = np.ones(SAMPLES, dtype=bool)
        zero = np.zeros(SAMPLES)
        segments.append(Segment("log", DT, 10.0, 1, signals, zero, mask, mask, {}, NOISE, DT, 20.0))
    residual = torque.ravel() - X @ beta
    found = Fit(
        shape=INTEGRATED[0], terms=(), drive="torque", beta=beta, gain=1.0,
        layout=Layout(("sigma2", "Fc"), (), ()), residual=residual, jacobian=X,
        weight=np.ones(len(residual)), bound=np.zeros(2, dtype=bool),
        low=np.full(2, -np.inf), high=np.full(2, np.inf),
        log_index=np.repeat(np.arange(LOGS), SAMPLES),
        begun=np.zeros((len(residual), 0)), target_rms=1.0,
    )  # fmt: skip
    return Prepared(tuple(segments), "joint", False, "torque", Band(10.0, 20.0)), found


def stated(v, torque):
    """Estimates and their standard errors."""
    prepared, found = fitted(v, torque)
    cov = covariance(prepared, found, make_blocks(prepared, found).of_sample)
    return found.beta, np.sqrt(np.diag(cov))


def white(v, torque):
    """Standard errors that take the residual for white noise."""
    _, found = fitted(v, torque)
    X = found.jacobian
    return np.sqrt(np.mean(found.residual**2) * np.diag(np.linalg.inv(X.T @ X)))


def trials(torque_of):
    rng = np.random.default_rng(0)
    errors, widths, naive = [], [], []
    for _ in range(REPEATS):
        v = speeds(rng)
        torque = torque_of(rng, v)
        value, width = stated(v, torque)
        errors.append(value - TRUE)
        widths.append(width)
        naive.append(white(v, torque))
    return np.array(errors), np.array(widths), np.array(naive)


def exact(v):
    return TRUE[0] * v + TRUE[1] * np.sign(v)


def test_intervals_hold_the_truth_on_correlated_noise_and_are_not_boundless():
    errors, widths, naive = trials(lambda rng, v: exact(v) + 0.1 * correlated(rng, SAMPLES))
    inside = np.mean(np.abs(errors) <= 1.96 * widths, axis=0)
    assert np.all(inside >= 0.93)
    assert np.all(np.median(widths, axis=0) < 2.0 * errors.std(axis=0))
    assert np.all(np.mean(np.abs(errors) <= 1.96 * naive, axis=0) < 0.8)


def test_a_law_wrong_at_some_speeds_is_seen_however_often_it_is_recorded():
    def torque(rng, v):
        slow = 0.1 * np.sign(v) * np.exp(-((v / 0.3) ** 2))
        return exact(v) + slow + 0.01 * correlated(rng, SAMPLES)

    errors, widths, naive = trials(torque)
    # a bias is not a spread: the stated error is of its size, and no more is promised
    assert np.all(np.mean(np.abs(errors) <= 3.0 * widths, axis=0) >= 0.95)
    assert np.all(np.mean(np.abs(errors) <= 3.0 * naive, axis=0) < 0.1)
