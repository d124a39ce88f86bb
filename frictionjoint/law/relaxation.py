"""Exact flow of dr/da = 1 - sgn(r) |r|**n, the one differential equation of the law.

On a linear piece of Fd (slope K) with S frozen, the law dz/dx = 1 - sgn(r) |r|**n turns into this
equation for r = Fd / (S - Fb) over the displacement a = K x / (S - Fb). It is stiff near r = 1.
Written for u = -ln|1 - r| it is not: du/da = (1 - r**n) / (1 - r) lies between 1 and n.

n = 1 and n = 2 have closed forms both ways, n = 4 nearly so. Otherwise a(r) is a series
below r = 1/2 and a Gauss-Legendre quadrature in u above, both near machine precision. r(a) follows
by Newton's method, which is monotone because a(u) is concave (r < 1) or convex (r > 1).
"""

import math

import numpy as np

from frictionjoint.compiled import compiled, in_line

# exp(-37) is below the spacing of doubles at 1: from here on r is 1 to the last bit.
_U_SATURATED = 37.0
# n*a up to which a few steps of a series cost less than one Newton solution
_SMALL = 0.4
# Nearer to 1 than this a power of r is two terms of its binomial series, to 1e-14.
_NEXT = 1e-5
# n |1 - r| below this: the flow is a series, to 1e-11
_NEAR = 0.05
# n (1 - |r|) beyond this: |r|**n is below exp(-8), which is small
_FLAT = 8.0
_ORDER = 8
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(_ORDER)
_X = tuple(float(x) for x in _NODES)
_W = tuple(float(w) for w in _WEIGHTS)


@in_line
def power(r: float, n: float) -> float:
    """r**n for r >= 0; small whole exponents by multiplication, which is several times faster."""
    if n == 1.0:
        return r
    if n == 2.0:
        return r * r
    if n == 3.0:
        return r * r * r
    if n == 4.0:
        return (r * r) * (r * r)
    return float(r**n)


@in_line
def _slope(r: float, n: float) -> float:
    """dr/da."""
    return 1.0 - power(r, n) if r >= 0.0 else 1.0 + power(-r, n)


@in_line
def rate(r: float, n: float) -> float:
    """dz/dx = 1 - sgn(r) |r|**n."""
    short = 1.0 - r
    if abs(short) < _NEXT:
        return n * short * (1.0 - 0.5 * (n - 1.0) * short)
    return _slope(r, n)


@compiled
def _series(r: float, n: float, sign: float) -> float:
    """Integral of 1 / (1 - sign r**n) from 0 to r, for 0 <= r <= 1/2."""
    q = sign * float(r**n)
    term = r
    total = r
    k = 1.0
    while True:
        term *= q
        step = term / (n * k + 1.0)
        total += step
        if abs(step) <= 1e-17 * total or k > 60.0:
            return total
        k += 1.0


@in_line
def _below(u: float, n: float) -> float:
    """da/du for r = 1 - exp(-u) < 1."""
    e = math.exp(-u)
    return -e / math.expm1(n * math.log1p(-e))


@in_line
def _above(u: float, n: float) -> float:
    """da/du for r = 1 + exp(-u) > 1."""
    e = math.exp(-u)
    return e / math.expm1(min(n * math.log1p(e), 700.0))  # r**n may exceed a double


@in_line
def _negative(t: float, n: float) -> float:
    """-da/dt for r = -exp(t/n) < 0."""
    return math.exp(t / n) / (n * (1.0 + math.exp(t)))


@compiled
def _quadrature(branch: int, lower: float, upper: float, n: float) -> float:
    """Integral of one of the three integrands, panel by panel; each is smooth on a scale of 1."""
    panels = math.ceil(abs(upper - lower))
    if panels == 0:
        return 0.0
    half = 0.5 * (upper - lower) / float(panels)
    total = 0.0
    for p in range(panels):
        middle = lower + float(2 * p + 1) * half
        for i in range(_ORDER):
            u = middle + half * _X[i]
            if branch == 0:
                total += _W[i] * _below(u, n)
            elif branch == 1:
                total += _W[i] * _above(u, n)
            else:
                total += _W[i] * _negative(u, n)
    return total * half


@compiled
def _to_zero(rho: float, n: float) -> float:
    """Displacement from r = -rho up to r = 0."""
    if rho <= 0.5:
        return _series(rho, n, -1.0)
    half = _series(0.5, n, -1.0)
    t0 = -n * math.log(2.0)
    t1 = n * math.log(rho)
    # exp(-40) against 1: left of it the integrand in r is 1, right of it nothing is left.
    if t0 < -40.0:
        reach = min(t1, -40.0)
        half += math.exp(reach / n) - 0.5
        t0 = reach
    t1 = min(t1, 40.0)
    return half + (_quadrature(2, t0, t1, n) if t1 > t0 else 0.0)


@compiled
def _from_zero(r: float, n: float) -> float:
    """Displacement from 0 to r, 0 <= r < 1."""
    if r <= 0.5:
        return _series(r, n, 1.0)
    return _series(0.5, n, 1.0) + _quadrature(0, math.log(2.0), -math.log1p(-r), n)


@compiled
def distance_positive(r0: float, r1: float, n: float) -> float:
    """`distance` for 0 <= r0 <= r1 < 1."""
    if n == 2.0:
        return 0.5 * math.log(((1.0 + r1) * (1.0 - r0)) / ((1.0 - r1) * (1.0 + r0)))
    if n == 4.0:
        atanh = 0.5 * math.log(((1.0 + r1) * (1.0 - r0)) / ((1.0 - r1) * (1.0 + r0)))
        return 0.5 * (atanh + math.atan(r1) - math.atan(r0))
    if r0 > 0.5:
        return _quadrature(0, -math.log1p(-r0), -math.log1p(-r1), n)
    return _from_zero(r1, n) - _from_zero(r0, n)


@compiled
def distance(r0: float, r1: float, n: float) -> float:
    """Displacement a that takes r0 to r1; infinity where r1 is at or past the fixed point 1."""
    if (r0 < 1.0 and r1 >= 1.0) or (r0 > 1.0 and r1 <= 1.0) or r0 == 1.0:
        return math.inf
    if n == 1.0:
        return math.log((1.0 - r0) / (1.0 - r1))
    if n == 2.0 and r0 > 1.0:
        return 0.5 * math.log(((r1 + 1.0) * (r0 - 1.0)) / ((r1 - 1.0) * (r0 + 1.0)))
    if r0 > 1.0:
        return _between(-math.log(r0 - 1.0), r0, -math.log(r1 - 1.0), r1, n)
    if r1 <= 0.0:
        return _to_zero(-r0, n) - _to_zero(-r1, n)
    if r0 < 0.0:
        return _to_zero(-r0, n) + distance_positive(0.0, r1, n)
    return distance_positive(r0, r1, n)


@compiled
def _advance_negative(rho: float, a: float, n: float) -> float:
    """rho after the displacement a < _to_zero(rho): Newton's method kept inside a bracket."""
    total = _to_zero(rho, n)
    low, high = 0.0, rho
    x = max(0.0, rho - a * (1.0 + power(rho, n)))
    for _ in range(100):
        excess = total - _to_zero(x, n) - a
        if excess > 0.0:
            low = x
        else:
            high = x
        step = excess * (1.0 + power(x, n))
        x_new = x + step
        if not low <= x_new <= high:
            x_new = 0.5 * (low + high)
        if abs(x_new - x) <= 1e-16 * (1.0 + x):
            return x_new
        x = x_new
    return x


@compiled
def _between(u0: float, r0: float, u1: float, r1: float, n: float) -> float:
    """Displacement from r0 to r1 on one side of 1, given u as well: 1 - r has no digits near 1."""
    if r0 > 1.0:
        return _quadrature(1, u0, u1, n)
    if r0 > 0.5 and r1 > 0.5:
        return _quadrature(0, u0, u1, n)
    return distance_positive(r0, r1, n) if r1 >= r0 else -distance_positive(r1, r0, n)


@compiled
def _advance_below(r0: float, a: float, n: float) -> float:
    """r after the displacement a from 0 <= r0 < 1."""
    u = -math.log1p(-r0)
    if u + a >= _U_SATURATED:
        return 1.0
    r, left = r0, a
    for _ in range(60):
        u_new = u + left / _below(u, n) if u > 0.0 else u + left
        if u_new >= _U_SATURATED:
            # concave: the tangent never passes the root, so the root lies further still
            return 1.0
        r_new = -math.expm1(-u_new)
        left -= _between(u, r, u_new, r_new, n)
        # Newton squares the error: the step after this one would be lost in rounding
        if abs(u_new - u) <= 1e-7 * (1.0 + u):
            return r_new
        u, r = u_new, r_new
    return r


@compiled
def _advance_above(r0: float, a: float, n: float) -> float:
    """r after the displacement a from r0 > 1."""
    u0 = -math.log(r0 - 1.0)
    if u0 + n * a >= _U_SATURATED:
        return 1.0
    low, high = u0, min(_U_SATURATED, u0 + a / _above(u0, n))
    u = high
    for _ in range(100):
        excess = _between(u0, r0, u, 1.0 + math.exp(-u), n) - a
        if excess > 0.0:
            high = u
        else:
            low = u
        u_new = u - excess / _above(u, n)
        if not low <= u_new <= high:
            u_new = 0.5 * (low + high)
        close = abs(u_new - u) <= 1e-7 * (1.0 + abs(u))
        u = u_new
        if close:
            break
    return 1.0 + math.exp(-u)


@in_line
def _advance_flat(r: float, a: float, n: float) -> float:
    """r after the displacement a while |r|**n < exp(-_FLAT): r' = 1 - sgn(r) |r|**n to second
    order in this power."""
    end = r + a
    w0, w1 = power(abs(r), n), power(abs(end), n)
    x0, x1 = abs(r) * w0, abs(end) * w1
    back = n * (end * w1 * w1 - r * w0 * w0) / (2.0 * n + 1.0)
    back -= x0 * ((w1 if end > 0.0 else -w1) - (w0 if r > 0.0 else -w0))
    return end - (x1 - x0 - back) / (n + 1.0)


@compiled
def _advance_near_one(r: float, a: float, n: float) -> float:
    """r after the displacement a from where n |1 - r| < _NEAR.

    e = 1 - r has e' = -n e (1 - b1 e + b2 e^2 - ...), so e exp(D(e)) / (1 - b1 e) falls by
    exp(-n a), with D a series of e that begins with its square.
    """
    e, b1, fallen = 1.0 - r, 0.5 * (n - 1.0), math.exp(-n * a)
    end = e * fallen / (1.0 - b1 * e * (1.0 - fallen))
    if abs(e) < _NEXT:
        return 1.0 - end
    b2 = (1.0 / 3.0) * b1 * (n - 2.0)
    b3 = 0.25 * b2 * (n - 3.0)
    d2, d3 = -0.5 * b2, (1.0 / 3.0) * (b3 - 2.0 * b1 * b2)
    d4 = 0.25 * (b2 * b2 - 3.0 * b1 * b1 * b2 + 2.0 * b1 * b3 - 0.2 * b3 * (n - 4.0))
    D = e * e * (d2 + e * (d3 + e * d4))
    at_end = end * end * (d2 + end * (d3 + end * d4))
    # the end that D moves by this has another D
    D -= at_end * (1.0 + 2.0 * (D - at_end))
    fallen *= 1.0 + D * (1.0 + 0.5 * D)
    return 1.0 - e * fallen / (1.0 - b1 * e * (1.0 - fallen))


@compiled
def _advance_fourth(r: float, a: float) -> float:
    """r after the displacement a from 0 <= r < 2, for n = 4.

    With y = (1 - r) / (1 + r) the flow multiplies w = y exp(2 atan y) by exp(-4 a). The inverse of
    w is a rational function to 5e-4, and one step of Halley's method in log y after it.
    """
    y = (1.0 - r) / (1.0 + r)
    w = y * math.exp(2.0 * math.atan(y) - 4.0 * a)
    if w == 0.0:
        return 1.0
    above = 1.00040769 + w * (4.8316135 + w * (4.10617197 + w * 0.26646571))
    ratio = above / (1.0 + w * (6.82627993 + w * (11.79377856 + w * 3.67716873)))
    y = w * ratio
    square = y * y
    off = math.log(ratio) + 2.0 * math.atan(y)
    slope = 1.0 + 2.0 * y / (1.0 + square)
    off /= slope - off * y * (1.0 - square) / ((1.0 + square) * (1.0 + square) * slope)
    y *= 1.0 - off * (1.0 - 0.5 * off * (1.0 - 1.0 / 3.0 * off))
    return (1.0 - y) / (1.0 + y)


@in_line
def _taylor_steps(r: float, a: float, n: float) -> int:
    """Steps that a small displacement from r > 0 takes.

    A step of sixth order with n*a < 0.1 and a/r < 0.05 is exact to 1e-11.
    """
    return 1 + int(max(n * a / 0.1, a / (0.05 * r)))


@compiled
def _advance_by_taylor(r: float, a: float, n: float, way: float) -> float:
    """|r| after a small displacement from r of the sign `way`: the series of |r| and of
    w = |r|**n side by side.

    From w' r = n w r' the coefficients of w follow by recurrence (Knuth, 4.7), so that each step
    costs one power.
    """
    # towards zero it falls up to twice as fast as it rises
    steps = _taylor_steps(r, (1.5 - 0.5 * way) * a, n)
    h = a / float(steps)
    for _ in range(steps):
        q = 1.0 / r
        w0 = power(r, n)
        r1 = way - w0
        w1 = q * n * r1 * w0
        r2 = -0.5 * w1
        w2 = 0.5 * q * ((n - 1.0) * r1 * w1 + 2.0 * n * r2 * w0)
        r3 = -(1.0 / 3.0) * w2
        w3 = 1.0 / 3.0 * q * ((n - 2.0) * r1 * w2 + (2.0 * n - 1.0) * r2 * w1 + 3.0 * n * r3 * w0)
        r4 = -0.25 * w3
        w4 = (n - 3.0) * r1 * w3 + (2.0 * n - 2.0) * r2 * w2
        w4 = 0.25 * q * (w4 + (3.0 * n - 1.0) * r3 * w1 + 4.0 * n * r4 * w0)
        r5 = -0.2 * w4
        w5 = (n - 4.0) * r1 * w4 + (2.0 * n - 3.0) * r2 * w3 + (3.0 * n - 2.0) * r3 * w2
        w5 = 0.2 * q * (w5 + (4.0 * n - 1.0) * r4 * w1 + 5.0 * n * r5 * w0)
        r += h * (r1 + h * (r2 + h * (r3 + h * (r4 + h * (r5 - h * (1.0 / 6.0) * w5)))))
    return r


@compiled
def any_advance(r: float, a: float, n: float) -> float:
    """`advance` for every exponent but 1 and 2."""
    most = max(-r, r + a)
    if n * (1.0 - most) > _FLAT or (n >= 3.0 and most < 0.06):
        return _advance_flat(r, a, n)
    if r < 0.0:
        if -1.0 <= r < -0.01 and n * a < _SMALL and _taylor_steps(-r, 2.0 * a, n) <= 4:
            return -_advance_by_taylor(-r, a, n, -1.0)
        to_zero = _to_zero(-r, n)
        if a < to_zero:
            return -_advance_negative(-r, a, n)
        r, a = 0.0, a - to_zero
    if r == 1.0:
        return 1.0
    if n * abs(1.0 - r) < _NEAR:
        return _advance_near_one(r, a, n)
    # S that falls leaves r a bit above 1; r**n must not be much above 1 either
    if r > 1.0 and n * (r - 1.0) < 0.25 and n * a < _SMALL:
        return _advance_by_taylor(r, a, n, 1.0)
    if 0.01 < r < 1.0 and n * a < _SMALL and _taylor_steps(r, a, n) <= 4:
        return _advance_by_taylor(r, a, n, 1.0)
    if n == 4.0 and r < 2.0:
        return _advance_fourth(r, a)
    return _advance_below(r, a, n) if r < 1.0 else _advance_above(r, a, n)


@in_line
def advance(r: float, a: float, n: float) -> float:
    """r after the displacement a >= 0.

    Args: r normalised transition torque, any sign; a displacement times slope over span, >= 0;
    n exponent, >= 1. Units: none. Source: Ganseman et al. (1997), equation (9).
    """
    if n == 1.0:
        return r - (1.0 - r) * math.expm1(-a)
    if n == 2.0:
        if r < 0.0:
            to_zero = math.atan(-r)
            if a < to_zero:
                return math.tan(a - to_zero)
            r, a = 0.0, a - to_zero
        # 0.5: Below this the hyperbolic tangent is seven terms of Lambert's continued fraction, to
        # 2e-16, in a third of the library's time.
        if a < 0.5:
            b = a * a
            above = a * (135135.0 + b * (17325.0 + b * (378.0 + b)))
            below = 135135.0 + b * (62370.0 + b * (3150.0 + b * 28.0))
            return (r * below + above) / (below + r * above)
        left = (1.0 - r) * math.exp(-2.0 * a)
        return (1.0 + r - left) / (1.0 + r + left)
    return any_advance(r, a, n)
