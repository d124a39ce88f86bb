"""Presliding under a slow force, from the equations alone: no kernel, no simulation.

At rest speed S = Fs, and 1997's law is dx = dFh / (Fd'(z) (1 - sgn(r) |r|**n)) along one curve.
The way from one force to another, and the work on it, are integrals over Fh.
"""

import math

from scipy.integrate import quad

from frictionjoint.parameters import FrictionParameters


def way(p: FrictionParameters, base: float, target: float) -> float:
    """Displacement, m or rad, of a symmetric law from a reversal at `base` up to `target`."""
    return _integral(p, base, target, lambda F: 1.0)


def work(p: FrictionParameters, base: float, target: float) -> float:
    """Work of Fh on that way, J."""
    return _integral(p, base, target, lambda F: F)


def drift(p: FrictionParameters, low: float, high: float) -> float:
    """Displacement gained in one force cycle low -> high -> low."""
    return way(p, low, high) - way(p, -high, -low)


def loss(p: FrictionParameters, low: float, high: float) -> float:
    """Energy dissipated in one force cycle low -> high -> low, J."""
    return work(p, low, high) + work(p, -high, -low)


def _integral(p, base, target, weight):
    knots = [(0.0, 0.0), *p.knots]
    Fs = p.Fs_pos

    def integrand(F):
        d = F - base
        i = next((k for k in range(1, len(knots)) if d <= knots[k][1]), len(knots) - 1)
        slope = (knots[i][1] - knots[i - 1][1]) / (knots[i][0] - knots[i - 1][0])
        r = F / Fs if p.variant == "lampaert2002" else d / (Fs - base)
        rate = 1.0 - r**p.n if r >= 0.0 else 1.0 + (-r) ** p.n
        return weight(F) / (slope * rate)

    bends = [base + F for _, F in knots[1:] if base + F < target]
    return quad(integrand, base, target, points=bends or None, epsabs=1e-16, limit=200)[0]


def lugre_way(sigma0: float, Fs: float, base: float, target: float) -> float:
    """Displacement of LuGre at rest speed from force `base` up to `target`, m or rad."""
    return Fs / sigma0 * math.log((Fs - base) / (Fs - target))


def lugre_drift(sigma0: float, Fs: float, low: float, high: float) -> float:
    """Displacement gained in one force cycle: dx = dz / (1 - sigma0 z / Fs) each way."""
    return lugre_way(sigma0, Fs, low, high) - lugre_way(sigma0, Fs, -high, -low)


def lugre_loss(sigma0: float, Fs: float, low: float, high: float) -> float:
    """Energy dissipated in one force cycle, J: F dx = (Fs / (1 - F/Fs) - Fs) dF / sigma0."""
    up = Fs * lugre_way(sigma0, Fs, low, high)
    down = Fs * lugre_way(sigma0, Fs, -high, -low)
    return up + down - 2.0 * Fs * (high - low) / sigma0
