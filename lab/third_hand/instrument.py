"""What the instruments make of a joint's motion: counts, instants, torque noise."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Instruments:
    """Rates in Hz, times in s, torques in N m."""

    rate: float
    control_rate: float
    counts: int
    reads_encoder: bool  # the controller reads the counts, else the true position
    noise: float  # rms of white and coloured noise together
    coloured: float  # fraction of the noise's power that is coloured
    corner: float  # of the coloured noise, Hz
    resolution: float  # of the torque, 0 if none
    ripple: float  # amplitude of the drive's own ripple, fixed in angle
    ripple_order: float  # cycles a turn
    jitter: float  # rms of an instant's error
    stamped: bool  # the log holds the true instants, else the nominal ones

    @property
    def count(self) -> float:
        """Radians of one encoder count."""
        return 2 * np.pi / self.counts


RATES = (100.0, 125.0, 200.0, 250.0, 400.0, 500.0)
CONTROL_RATES = (1000.0, 2000.0, 4000.0)


def draw(rng: np.random.Generator, coulomb: float, counts: int, rate: float, quiet: float):
    """Instruments with at least 2**counts, this rate, and at most `quiet` * coulomb of noise."""
    counts = int(2 ** rng.integers(counts, 21))
    rate = float(rng.choice([r for r in RATES if r >= rate]))
    noise = coulomb * np.exp(rng.uniform(np.log(0.003), np.log(max(quiet, 0.004))))
    jitters, stamped = rng.random() < 0.25, bool(rng.random() < 0.5)
    # an instant that the log does not know is an error of the position
    jitter = rng.uniform(0.01, 0.06) / rate if stamped else rng.uniform(15e-6, 50e-6)
    return Instruments(
        rate=rate,
        control_rate=float(rng.choice(CONTROL_RATES)),
        counts=counts,
        reads_encoder=bool(counts >= 2**18 and rng.random() < 0.4),
        noise=noise,
        coloured=rng.uniform(0.0, 0.6),
        corner=rng.uniform(1.0, 15.0),
        resolution=noise * rng.choice([0.0, rng.uniform(0.2, 1.0)]),
        ripple=noise * rng.uniform(0.1, 0.4),
        # six times the pole pairs times the gear's ratio
        ripple_order=float(6 * rng.integers(4, 12) * rng.choice([50, 80, 100, 120, 160])),
        jitter=float(jitter) if jitters else 0.0,
        stamped=stamped,
    )


def steps(rng: np.random.Generator, seconds: float, instruments: Instruments, dt: float):
    """Steps of the integrator at which the log is taken, and the time written for each."""
    nominal = np.arange(0.05, seconds, 1 / instruments.rate)
    real = nominal + rng.normal(0, instruments.jitter, nominal.size).clip(
        -0.3 / instruments.rate, 0.3 / instruments.rate
    )
    at = np.round(real / dt).astype(np.int64)
    written = at * dt if instruments.stamped else nominal
    return at, written - nominal[0]


def torque_noise(rng: np.random.Generator, n: int, instruments: Instruments) -> np.ndarray:
    """White noise and noise through a first-order low pass, N m, shape (n,)."""
    keep = np.exp(-2 * np.pi * instruments.corner / instruments.rate)
    drive = rng.normal(0, np.sqrt(1 - keep**2), n)
    coloured = np.empty(n)
    state = rng.normal()
    for i in range(n):
        state = keep * state + drive[i]
        coloured[i] = state
    white = rng.normal(0, 1, n)
    share = instruments.coloured
    return instruments.noise * (np.sqrt(share) * coloured + np.sqrt(1 - share) * white)


def rounded(x: np.ndarray, step: float) -> np.ndarray:
    return np.round(x / step) * step if step else x
