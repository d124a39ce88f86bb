"""LuGre (Canudas de Wit et al. 1995) at rest speed under a force cycle, by scipy."""

from scipy.integrate import solve_ivp


def lugre_cycle(sigma0: float, Fs: float, low: float, high: float) -> tuple[float, float]:
    """Displacement gained, m, and energy lost, J, in one cycle low -> high -> low of the force.

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
