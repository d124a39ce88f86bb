"""The laws' kernels with their tangents; written by ``generate``, see there."""

import math

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, in_line
from frictionjoint.law import (
    armstrong,
    bristle,
    dahl,
    dahl_stribeck,
    elastoplastic,
    integrated,
    lugre,
    maxwell_slip,
    memory,
    static,
    stribeck,
    transition,
)
from frictionjoint.law.kernel import start_rival
from frictionjoint.law.tangents import rules
from frictionjoint.law.tangents.direction import (
    ZERO,
    Tangent,
    Tangents,
    at,
    put,
    scaled,
    sum2,
    sum3,
    sum4,
)


@compiled
def integrated_start(
    P: Vector, P_t: Tangents, p: int, X: Vector, X_t: Tangents, h: int, s: int
) -> None:
    for i in range(memory.HEADER):
        put(X_t, h + i, ZERO)
        X[h + i] = 0.0
    X[h + memory.N_MIN] = 1.0
    X[h + memory.N_MAX] = 1.0
    X[h + memory.VIRGIN] = 1.0
    put(X_t, h + memory.RATE, ZERO)
    X[h + memory.RATE] = 1.0
    put(X_t, s, scaled(-1.0, at(P_t, p + integrated.NEGATIVE + stribeck.FS)))
    X[s] = -P[p + integrated.NEGATIVE + stribeck.FS]
    put(X_t, s + memory.CAPACITY, at(P_t, p + integrated.POSITIVE + stribeck.FS))
    X[s + memory.CAPACITY] = P[p + integrated.POSITIVE + stribeck.FS]


@in_line
def integrated_reverse(
    P: Vector, P_t: Tangents, p: int, X: Vector, X_t: Tangents, h: int, s: int, direction: float
) -> None:
    Fh_t = at(X_t, h + memory.FH)
    Fh = X[h + memory.FH]
    from_masing_virgin = P[p + integrated.MASING] == 1.0 and integrated._on_virgin(X, h)
    n_min = int(X[h + memory.N_MIN])
    n_max = int(X[h + memory.N_MAX])
    if direction < 0.0 or from_masing_virgin:
        if from_masing_virgin:
            y1 = abs(Fh)
            put(X_t, s + memory.CAPACITY + n_max, scaled(math.copysign(1.0, Fh), Fh_t))
            X[s + memory.CAPACITY + n_max] = y1
        else:
            put(X_t, s + memory.CAPACITY + n_max, Fh_t)
            X[s + memory.CAPACITY + n_max] = Fh
        X[h + memory.N_MAX] = n_max + 1
    if direction > 0.0 or from_masing_virgin:
        if from_masing_virgin:
            y2 = abs(Fh)
            put(X_t, s + n_min, scaled(-math.copysign(1.0, Fh), Fh_t))
            X[s + n_min] = -y2
        else:
            put(X_t, s + n_min, Fh_t)
            X[s + n_min] = Fh
        X[h + memory.N_MIN] = n_min + 1
    put(X_t, h + memory.FB, Fh_t)
    X[h + memory.FB] = Fh


@in_line
def integrated_reset(X: Vector, X_t: Tangents, h: int, s: int, direction: float) -> None:
    X[h + memory.N_MIN] = 1.0
    X[h + memory.N_MAX] = 1.0
    X[h + memory.VIRGIN] = 0.0
    X[h + memory.BOUND] = 0.0
    if direction > 0.0:
        put(X_t, h + memory.FB, at(X_t, s))
        X[h + memory.FB] = X[s]
    else:
        put(X_t, h + memory.FB, at(X_t, s + memory.CAPACITY))
        X[h + memory.FB] = X[s + memory.CAPACITY]


@in_line
def transition_knot_torque(P: Vector, P_t: Tangents, k: int, j: int) -> tuple[float, Tangent]:
    if j < 0:
        return 0.0, ZERO
    return P[k + 1 + transition.KNOT_STRIDE * j + 1], at(
        P_t, k + 1 + transition.KNOT_STRIDE * j + 1
    )


@in_line
def integrated_closing_torque(
    X: Vector, X_t: Tangents, h: int, s: int, direction: float
) -> tuple[float, Tangent]:
    if direction > 0.0:
        tops = int(X[h + memory.N_MAX])
        if tops > 1:
            return X[s + memory.CAPACITY + tops - 1], at(X_t, s + memory.CAPACITY + tops - 1)
        return math.inf, ZERO
    tops = int(X[h + memory.N_MIN])
    if tops > 1:
        return -X[s + tops - 1], scaled(-1.0, at(X_t, s + tops - 1))
    return math.inf, ZERO


@in_line
def transition_slope(P: Vector, P_t: Tangents, k: int, j: int) -> tuple[float, Tangent]:
    return P[k + 1 + transition.KNOT_STRIDE * j + 2], at(
        P_t, k + 1 + transition.KNOT_STRIDE * j + 2
    )


@in_line
def integrated_close(
    P: Vector, P_t: Tangents, p: int, X: Vector, X_t: Tangents, h: int, s: int, direction: float
) -> None:
    n_min = X[h + memory.N_MIN] - 1.0
    n_max = X[h + memory.N_MAX] - 1.0
    if (
        P[p + integrated.MASING] == 1.0
        and X[h + memory.VIRGIN] == 1.0
        and (min(n_min, n_max) == 1.0)
    ):
        n_max = 1.0
        n_min = n_max
    X[h + memory.N_MIN] = n_min
    X[h + memory.N_MAX] = n_max
    if integrated._on_virgin(X, h):
        put(X_t, h + memory.FB, ZERO)
        X[h + memory.FB] = 0.0
    else:
        if direction > 0.0:
            put(X_t, h + memory.FB, at(X_t, s + int(n_min) - 1))
            X[h + memory.FB] = X[s + int(n_min) - 1]
        else:
            put(X_t, h + memory.FB, at(X_t, s + memory.CAPACITY + int(n_max) - 1))
            X[h + memory.FB] = X[s + memory.CAPACITY + int(n_max) - 1]


@in_line
def integrated_slide(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    h: int,
    s: int,
    direction: float,
    S: float,
    S_t: Tangent,
    dx: float,
) -> None:
    dx_t = ZERO
    n = P[p + integrated.EXPONENT]
    k = p + integrated.KNOTS
    last = int(P[k]) - 1
    lampaert = P[p + integrated.LAMPAERT] == 1.0
    reset_torque_t = scaled(1.0 - integrated.RESET_MARGIN, S_t)
    reset_torque = (1.0 - integrated.RESET_MARGIN) * S
    f_t = scaled(direction, at(X_t, h + memory.FH))
    f = direction * X[h + memory.FH]
    j = -1
    r_t = ZERO
    r = 1.0
    while True:
        wiped = (
            X[h + memory.VIRGIN] == 0.0
            and X[h + memory.N_MIN] == 1.0
            and (X[h + memory.N_MAX] == 1.0)
        )
        if not wiped and f >= reset_torque:
            integrated_reset(X, X_t, h, s, direction)
            wiped = True
            j = -1
        b_t = scaled(direction, at(X_t, h + memory.FB))
        b = direction * X[h + memory.FB]
        scale = 0.5 if P[p + integrated.MASING] == 1.0 and integrated._on_virgin(X, h) else 1.0
        if lampaert:
            span_t = S_t
            span = S
        else:
            span_t = sum2(1.0, S_t, -1.0, b_t)
            span = S - b
        if lampaert:
            origin_t = ZERO
            origin = 0.0
        else:
            origin_t = b_t
            origin = b
        r_t = sum3(
            1.0 / span, f_t, -(1.0 / span), origin_t, -((f - origin) / span) * (1.0 / span), span_t
        )
        r = (f - origin) / span
        if j < 0:
            j = transition.segment_of_torque(P, k, max(0.0, (f - b) / scale))
        event = integrated._KNOT
        if r < 1.0:
            if j < last:
                y1, y1_t = transition_knot_torque(P, P_t, k, j)
                target_t = sum2(1.0, b_t, scale, y1_t)
                target = b + scale * y1
            else:
                target_t = ZERO
                target = math.inf
            top, top_t = integrated_closing_torque(X, X_t, h, s, direction)
            if top <= target:
                target_t = top_t
                target = top
                event = integrated._CLOSING
            if not wiped and reset_torque < target:
                target_t = reset_torque_t
                target = reset_torque
                event = integrated._RESET
        else:
            if j > 0:
                y2, y2_t = transition_knot_torque(P, P_t, k, j - 1)
                target_t = sum2(1.0, b_t, scale, y2_t)
                target = b + scale * y2
            else:
                target_t = ZERO
                target = -math.inf
        K, K_t = transition_slope(P, P_t, k, j)
        stop_t = sum3(
            1.0 / span,
            target_t,
            -(1.0 / span),
            origin_t,
            -((target - origin) / span) * (1.0 / span),
            span_t,
        )
        stop = (target - origin) / span
        near = abs(stop - r) <= integrated.SHORT
        if near:
            end_t = r_t
            end = r
        else:
            end, end_t = rules.advance(
                r,
                r_t,
                dx * K / span,
                sum3(
                    1.0 / span * K,
                    dx_t,
                    1.0 / span * dx,
                    K_t,
                    -(dx * K / span) * (1.0 / span),
                    span_t,
                ),
                n,
            )
        if not near and abs(end - r) + integrated.SHORT < abs(stop - r):
            r_t = end_t
            r = end
            f_t = sum3(1.0, origin_t, span, r_t, r, span_t)
            f = origin + r * span
            break
        y3, y3_t = rules.distance(r, r_t, stop, stop_t, n)
        reach_t = sum3(
            1.0 / K * span, y3_t, 1.0 / K * y3, span_t, -(y3 * span / K) * (1.0 / K), K_t
        )
        reach = y3 * span / K
        if dx < reach:
            if near:
                r, r_t = rules.advance(
                    r,
                    r_t,
                    dx * K / span,
                    sum3(
                        1.0 / span * K,
                        dx_t,
                        1.0 / span * dx,
                        K_t,
                        -(dx * K / span) * (1.0 / span),
                        span_t,
                    ),
                    n,
                )
            else:
                r_t = end_t
                r = end
            f_t = sum3(1.0, origin_t, span, r_t, r, span_t)
            f = origin + r * span
            break
        dx_t = sum2(1.0, dx_t, -1.0, reach_t)
        dx = dx - max(0.0, reach)
        f_t = target_t
        f = target
        put(X_t, h + memory.FH, scaled(direction, f_t))
        X[h + memory.FH] = direction * f
        if event == integrated._CLOSING:
            integrated_close(P, P_t, p, X, X_t, h, s, direction)
            j = -1
        else:
            if event == integrated._KNOT:
                j = j + (1 if r < 1.0 else -1)
    put(X_t, h + memory.FH, scaled(direction, f_t))
    X[h + memory.FH] = direction * f
    y4, y4_t = rules.rate(r, r_t, n)
    put(X_t, h + memory.RATE, y4_t)
    X[h + memory.RATE] = y4


@in_line
def integrated_move(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    s: int,
    dq: float,
    S: float,
    S_t: Tangent,
) -> None:
    if h != a:
        for i in range(memory.HEADER):
            put(X_t, h + i, at(X_t, a + i))
            X[h + i] = X[a + i]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        if X[h + memory.DIRECTION] == -direction:
            integrated_reverse(P, P_t, p, X, X_t, h, s, direction)
        X[h + memory.DIRECTION] = direction
        integrated_slide(P, P_t, p, X, X_t, h, s, direction, S, S_t, abs(dq))


@compiled
def integrated_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    s: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    S_t = ZERO
    S = 0.0
    if dq != 0.0:
        side = p + integrated.POSITIVE if dq > 0.0 else p + integrated.NEGATIVE
        S, S_t = rules.stribeck_level(P, P_t, side, abs(dq) / dt if dt > 0.0 else 0.0, ZERO)
    integrated_move(P, P_t, p, X, X_t, a, h, s, dq, S, S_t)


@compiled
def memory_make_room(X: Vector, X_t: Tangents, h: int, s: int) -> None:
    n_min = int(X[h + memory.N_MIN])
    n_max = int(X[h + memory.N_MAX])
    if max(n_min, n_max) < memory.CAPACITY:
        return
    m = s
    M = s + memory.CAPACITY
    pairs = min(n_min, n_max)
    best = 1
    least = 1e300
    for k in range(1, pairs):
        gap = max(X[M + k - 1] - X[M + k], X[m + k] - X[m + k - 1])
        if gap < least:
            best = k
            least = gap
    for k in range(best, n_min - 1):
        put(X_t, m + k, at(X_t, m + k + 1))
        X[m + k] = X[m + k + 1]
    for k in range(best, n_max - 1):
        put(X_t, M + k, at(X_t, M + k + 1))
        X[M + k] = X[M + k + 1]
    X[h + memory.N_MIN] = n_min - 1
    X[h + memory.N_MAX] = n_max - 1
    X[h + memory.FORGOTTEN] = X[h + memory.FORGOTTEN] + 1.0
    X[h + memory.BOUND] = X[h + memory.BOUND] + least


@compiled
def static_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    X[h + bristle.DIRECTION] = 0.0
    put(X_t, h + bristle.RATE, ZERO)
    X[h + bristle.RATE] = 0.0
    if v == 0.0:
        put(X_t, h + bristle.FH, ZERO)
        X[h + bristle.FH] = 0.0
    else:
        direction = 1.0 if v > 0.0 else -1.0
        S, S_t = rules.stribeck_level(P, P_t, bristle.side(p, direction), abs(v), ZERO)
        if abs(v) / P[p + static.V0] >= 1.0:
            y1, y1_t = 1.0, ZERO
        else:
            y1, y1_t = (
                abs(v) / P[p + static.V0],
                scaled(
                    -(abs(v) / P[p + static.V0]) * (1.0 / P[p + static.V0]), at(P_t, p + static.V0)
                ),
            )
        put(X_t, h + bristle.FH, sum2(y1 * direction, S_t, direction * S, y1_t))
        X[h + bristle.FH] = direction * S * y1


@compiled
def armstrong_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    Fh_t = at(X_t, a + bristle.FH)
    Fh = X[a + bristle.FH]
    direction = X[a + bristle.DIRECTION]
    sliding = X[a + armstrong.SLIDING]
    if dq != 0.0:
        now = 1.0 if dq > 0.0 else -1.0
        if now != direction:
            sliding = 0.0
        direction = now
        side_ = bristle.side(p, now)
        f_t = scaled(now, Fh_t)
        f = now * Fh
        if sliding == 0.0:
            f_t = sum2(1.0, f_t, abs(dq), at(P_t, p + armstrong.SIGMA0))
            f = f + P[p + armstrong.SIGMA0] * abs(dq)
            if f >= P[side_ + stribeck.FS]:
                sliding = 1.0
        if sliding == 1.0:
            f, f_t = rules.stribeck_level(P, P_t, side_, abs(dq) / dt if dt > 0.0 else 0.0, ZERO)
        Fh_t = scaled(now, f_t)
        Fh = now * f
    put(X_t, h + bristle.FH, Fh_t)
    X[h + bristle.FH] = Fh
    put(X_t, h + bristle.RATE, ZERO)
    X[h + bristle.RATE] = 1.0 - sliding
    X[h + bristle.DIRECTION] = direction
    X[h + armstrong.SLIDING] = sliding


@compiled
def dahl_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    Fh_t = at(X_t, a + bristle.FH)
    Fh = X[a + bristle.FH]
    rate_t = at(X_t, a + bristle.RATE)
    rate = X[a + bristle.RATE]
    direction = X[a + bristle.DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        Fc_t = at(P_t, bristle.side(p, direction) + stribeck.FC)
        Fc = P[bristle.side(p, direction) + stribeck.FC]
        i_t = at(P_t, p + dahl.EXPONENT)
        i = P[p + dahl.EXPONENT]
        w, w_t = rules.remaining(
            1.0 - direction * Fh / Fc,
            sum2(-(1.0 / Fc * direction), Fh_t, -(-(direction * Fh / Fc) * (1.0 / Fc)), Fc_t),
            P[p + dahl.SIGMA0] * abs(dq) / Fc,
            sum2(
                1.0 / Fc * abs(dq),
                at(P_t, p + dahl.SIGMA0),
                -(P[p + dahl.SIGMA0] * abs(dq) / Fc) * (1.0 / Fc),
                Fc_t,
            ),
            i,
            i_t,
        )
        Fh_t = sum2((1.0 - w) * direction, Fc_t, -(direction * Fc), w_t)
        Fh = direction * Fc * (1.0 - w)
        if w > 0.0:
            y1 = w**i
            rate_t = sum2(i * y1 / w, w_t, y1 * math.log(w), i_t)
            rate = y1
        else:
            rate_t = ZERO
            rate = 0.0
    put(X_t, h + bristle.FH, Fh_t)
    X[h + bristle.FH] = Fh
    put(X_t, h + bristle.RATE, rate_t)
    X[h + bristle.RATE] = rate
    X[h + bristle.DIRECTION] = direction


@compiled
def dahl_stribeck_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    z_t = at(X_t, a + dahl_stribeck.Z)
    z = X[a + dahl_stribeck.Z]
    rate_t = at(X_t, a + bristle.RATE)
    rate = X[a + bristle.RATE]
    direction = X[a + bristle.DIRECTION]
    dx = abs(dq)
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        Fs_t = at(P_t, bristle.side(p, direction) + stribeck.FS)
        Fs = P[bristle.side(p, direction) + stribeck.FS]
        i_t = at(P_t, p + dahl_stribeck.EXPONENT)
        i = P[p + dahl_stribeck.EXPONENT]
        w, w_t = rules.remaining(
            1.0 - direction * z,
            scaled(-direction, z_t),
            P[p + dahl_stribeck.SIGMA0] * dx / Fs,
            sum2(
                1.0 / Fs * dx,
                at(P_t, p + dahl_stribeck.SIGMA0),
                -(P[p + dahl_stribeck.SIGMA0] * dx / Fs) * (1.0 / Fs),
                Fs_t,
            ),
            i,
            i_t,
        )
        z_t = scaled(-direction, w_t)
        z = direction * (1.0 - w)
        if w > 0.0:
            y1 = w**i
            rate_t = sum2(i * y1 / w, w_t, y1 * math.log(w), i_t)
            rate = y1
        else:
            rate_t = ZERO
            rate = 0.0
    y2, y2_t = rules.stribeck_level(P, P_t, bristle.side(p, z), dx / dt if dt > 0.0 else 0.0, ZERO)
    Fh_t = sum2(y2, z_t, z, y2_t)
    Fh = z * y2
    put(X_t, h + bristle.FH, Fh_t)
    X[h + bristle.FH] = Fh
    put(X_t, h + bristle.RATE, rate_t)
    X[h + bristle.RATE] = rate
    X[h + bristle.DIRECTION] = direction
    put(X_t, h + dahl_stribeck.Z, z_t)
    X[h + dahl_stribeck.Z] = z


@compiled
def lugre_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    Fh_t = at(X_t, a + bristle.FH)
    Fh = X[a + bristle.FH]
    rate_t = at(X_t, a + bristle.RATE)
    rate = X[a + bristle.RATE]
    direction = X[a + bristle.DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        dx = abs(dq)
        S, S_t = rules.stribeck_level(
            P, P_t, bristle.side(p, direction), dx / dt if dt > 0.0 else 0.0, ZERO
        )
        f_t = scaled(direction, Fh_t)
        f = direction * Fh
        y1 = math.expm1(-P[p + lugre.SIGMA0] * dx / S)
        f_t = sum3(
            1.0 + y1,
            f_t,
            -(y1 + (S - f) * ((y1 + 1.0) * (-(-P[p + lugre.SIGMA0] * dx / S) * (1.0 / S)))),
            S_t,
            dx * (1.0 / S) * (y1 + 1.0) * (S - f),
            at(P_t, p + lugre.SIGMA0),
        )
        f = f - (S - f) * y1
        Fh_t = scaled(direction, f_t)
        Fh = direction * f
        rate_t = sum2(-(1.0 / S), f_t, -(-(f / S) * (1.0 / S)), S_t)
        rate = 1.0 - f / S
    put(X_t, h + bristle.FH, Fh_t)
    X[h + bristle.FH] = Fh
    put(X_t, h + bristle.RATE, rate_t)
    X[h + bristle.RATE] = rate
    X[h + bristle.DIRECTION] = direction


@in_line
def elastoplastic_plastic_share(
    r: float, r_t: Tangent, r_ba: float, r_ba_t: Tangent
) -> tuple[float, Tangent]:
    if r <= r_ba:
        return 0.0, ZERO
    if r >= 1.0:
        return 1.0, ZERO
    y1 = math.sin(0.5 * math.pi * (r - r_ba) / (1.0 - r_ba))
    s_t = sum2(
        math.cos(0.5 * math.pi * (r - r_ba) / (1.0 - r_ba))
        * (1.0 / (1.0 - r_ba) * (0.5 * math.pi)),
        r_t,
        math.cos(0.5 * math.pi * (r - r_ba) / (1.0 - r_ba))
        * (
            -(0.5 * math.pi * (1.0 / (1.0 - r_ba)))
            + -(-(0.5 * math.pi * (r - r_ba) / (1.0 - r_ba)) * (1.0 / (1.0 - r_ba)))
        ),
        r_ba_t,
    )
    s = y1
    return s * s, scaled(s + s, s_t)


@in_line
def elastoplastic_slope(
    u: float, u_t: Tangent, r_ba: float, r_ba_t: Tangent
) -> tuple[float, Tangent]:
    y1 = math.exp(-u)
    left_t = scaled(-y1, u_t)
    left = y1
    r_t = scaled(-1.0, left_t)
    r = 1.0 - left
    y2, y2_t = elastoplastic_plastic_share(r, r_t, r_ba, r_ba_t)
    return (1.0 - y2 * r) / left, sum3(
        -(r * (1.0 / left)),
        y2_t,
        -(y2 * (1.0 / left)),
        r_t,
        -((1.0 - y2 * r) / left) * (1.0 / left),
        left_t,
    )


@compiled
def elastoplastic_transition(
    r: float, r_t: Tangent, r_ba: float, r_ba_t: Tangent, a: float, a_t: Tangent
) -> tuple[float, Tangent]:
    y1 = math.log1p(-r)
    u_t = scaled(1.0 / (1.0 + -r), r_t)
    u = -y1
    while a > 0.0:
        if u + a >= elastoplastic._U_SATURATED:
            y2 = math.exp(-(u + a))
            return 1.0, sum2(y2, u_t, y2, a_t)
        k1, k1_t = elastoplastic_slope(u, u_t, r_ba, r_ba_t)
        y3 = math.exp(0.2 * u)
        if a <= elastoplastic._STEP * y3 / k1:
            y4, y4_t = a, a_t
        else:
            y4, y4_t = (
                elastoplastic._STEP * y3 / k1,
                sum2(
                    1.0 / k1 * (elastoplastic._STEP * (y3 * 0.2)),
                    u_t,
                    -(elastoplastic._STEP * y3 / k1) * (1.0 / k1),
                    k1_t,
                ),
            )
        d_t = y4_t
        d = y4
        k2, k2_t = elastoplastic_slope(
            u + 0.5 * d * k1, sum3(1.0, u_t, k1 * 0.5, d_t, 0.5 * d, k1_t), r_ba, r_ba_t
        )
        k3, k3_t = elastoplastic_slope(
            u + 0.5 * d * k2, sum3(1.0, u_t, k2 * 0.5, d_t, 0.5 * d, k2_t), r_ba, r_ba_t
        )
        k4, k4_t = elastoplastic_slope(u + d * k3, sum3(1.0, u_t, k3, d_t, d, k3_t), r_ba, r_ba_t)
        u_t = sum2(
            1.0,
            sum4(
                1.0,
                u_t,
                1.0 / 6.0 * (k1 + 2.0 * (k2 + k3) + k4),
                d_t,
                1.0 / 6.0 * d,
                k1_t,
                1.0 / 6.0 * (d * 2.0),
                k2_t,
            ),
            1.0,
            sum2(1.0 / 6.0 * (d * 2.0), k3_t, 1.0 / 6.0 * d, k4_t),
        )
        u = u + d * (k1 + 2.0 * (k2 + k3) + k4) / 6.0
        if d == a:
            break
        a_t = sum2(1.0, a_t, -1.0, d_t)
        a = a - d
    y5 = math.exp(-u)
    return -math.expm1(-u), scaled(y5, u_t)


@compiled
def elastoplastic_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    Fh_t = at(X_t, a + bristle.FH)
    Fh = X[a + bristle.FH]
    rate_t = at(X_t, a + bristle.RATE)
    rate = X[a + bristle.RATE]
    direction = X[a + bristle.DIRECTION]
    if dq != 0.0:
        direction = 1.0 if dq > 0.0 else -1.0
        levels = bristle.side(p, direction)
        dx = abs(dq)
        S, S_t = rules.stribeck_level(P, P_t, levels, dx / dt if dt > 0.0 else 0.0, ZERO)
        f_t = scaled(direction, Fh_t)
        f = direction * Fh
        f_ba_t = sum2(
            P[levels + stribeck.FC],
            at(P_t, p + elastoplastic.BREAKAWAY),
            P[p + elastoplastic.BREAKAWAY],
            at(P_t, levels + stribeck.FC),
        )
        f_ba = P[p + elastoplastic.BREAKAWAY] * P[levels + stribeck.FC]
        r_ba_t = sum2(1.0 / S, f_ba_t, -(f_ba / S) * (1.0 / S), S_t)
        r_ba = f_ba / S
        left_t = scaled(dx, at(P_t, p + elastoplastic.SIGMA0))
        left = P[p + elastoplastic.SIGMA0] * dx
        if f_ba - f <= 0.0:
            y1, y1_t = 0.0, ZERO
        else:
            y1, y1_t = f_ba - f, sum2(1.0, f_ba_t, -1.0, f_t)
        if left <= y1:
            y2, y2_t = left, left_t
        else:
            y2, y2_t = y1, y1_t
        elastic_t = y2_t
        elastic = y2
        f_t = sum2(1.0, f_t, 1.0, elastic_t)
        f = f + elastic
        left_t = sum2(1.0, left_t, -1.0, elastic_t)
        left = left - elastic
        if left > 0.0:
            if f >= S:
                y3 = math.expm1(-left / S)
                f_t = sum3(
                    1.0 + y3,
                    f_t,
                    -(y3 + (S - f) * ((y3 + 1.0) * (-(-left / S) * (1.0 / S)))),
                    S_t,
                    1.0 / S * (y3 + 1.0) * (S - f),
                    left_t,
                )
                f = f - (S - f) * y3
            else:
                if f / S >= r_ba:
                    y4, y4_t = f / S, sum2(1.0 / S, f_t, -(f / S) * (1.0 / S), S_t)
                else:
                    y4, y4_t = r_ba, r_ba_t
                y5, y5_t = elastoplastic_transition(
                    y4,
                    y4_t,
                    r_ba,
                    r_ba_t,
                    left / S,
                    sum2(1.0 / S, left_t, -(left / S) * (1.0 / S), S_t),
                )
                f_t = sum2(y5, S_t, S, y5_t)
                f = S * y5
        Fh_t = scaled(direction, f_t)
        Fh = direction * f
        y6, y6_t = elastoplastic_plastic_share(
            f / S, sum2(1.0 / S, f_t, -(f / S) * (1.0 / S), S_t), r_ba, r_ba_t
        )
        rate_t = sum3(-(1.0 / S * f), y6_t, -(1.0 / S * y6), f_t, -(-(y6 * f / S) * (1.0 / S)), S_t)
        rate = 1.0 - y6 * f / S
    put(X_t, h + bristle.FH, Fh_t)
    X[h + bristle.FH] = Fh
    put(X_t, h + bristle.RATE, rate_t)
    X[h + bristle.RATE] = rate
    X[h + bristle.DIRECTION] = direction


@compiled
def maxwell_slip_step(
    P: Vector,
    P_t: Tangents,
    p: int,
    X: Vector,
    X_t: Tangents,
    a: int,
    h: int,
    dq: float,
    dt: float,
    v: float,
) -> None:
    n = int(P[p + maxwell_slip.N_ELEMENTS])
    if dq == 0.0:
        for i in range(bristle.HEADER + 2 * n):
            put(X_t, h + i, at(X_t, a + i))
            X[h + i] = X[a + i]
        return
    direction = 1.0 if dq > 0.0 else -1.0
    turned = X[a + bristle.DIRECTION] != direction
    dx = abs(dq)
    S, S_t = rules.stribeck_level(
        P, P_t, bristle.side(p, direction), dx / dt if dt > 0.0 else 0.0, ZERO
    )
    y1 = math.expm1(-P[p + maxwell_slip.ATTRACTION] * dt / S)
    missing_t = sum2(
        -(dt * (1.0 / S) * (y1 + 1.0)),
        at(P_t, p + maxwell_slip.ATTRACTION),
        (y1 + 1.0) * (-(-P[p + maxwell_slip.ATTRACTION] * dt / S) * (1.0 / S)),
        S_t,
    )
    missing = y1
    Fh_t = ZERO
    Fh = 0.0
    sticking_t = ZERO
    sticking = 0.0
    for i in range(n):
        k_t = at(P_t, p + maxwell_slip.ELEMENTS + 2 * i)
        k = P[p + maxwell_slip.ELEMENTS + 2 * i]
        share_t = at(P_t, p + maxwell_slip.ELEMENTS + 2 * i + 1)
        share = P[p + maxwell_slip.ELEMENTS + 2 * i + 1]
        level_t = sum2(S, share_t, share, S_t)
        level = share * S
        f_t = scaled(direction, at(X_t, a + bristle.HEADER + i))
        f = direction * X[a + bristle.HEADER + i]
        slips = not turned and X[a + bristle.HEADER + n + i] == 1.0
        if not slips:
            if f >= level:
                slips = True
            else:
                f_t = sum2(1.0, f_t, dx, k_t)
                f = f + k * dx
                if f >= maxwell_slip.AT_LEVEL * level:
                    f_t = level_t
                    f = level
                    put(X_t, h + bristle.HEADER + i, scaled(direction, f_t))
                    X[h + bristle.HEADER + i] = direction * f
                    X[h + bristle.HEADER + n + i] = 1.0
                    Fh_t = sum2(1.0, Fh_t, 1.0, f_t)
                    Fh = Fh + f
                    continue
                sticking_t = sum2(1.0, sticking_t, 1.0, share_t)
                sticking = sticking + share
        if slips:
            f_t = sum3(1.0 + missing, f_t, -missing, level_t, -(level - f), missing_t)
            f = f - (level - f) * missing
        put(X_t, h + bristle.HEADER + i, scaled(direction, f_t))
        X[h + bristle.HEADER + i] = direction * f
        X[h + bristle.HEADER + n + i] = 1.0 if slips else 0.0
        Fh_t = sum2(1.0, Fh_t, 1.0, f_t)
        Fh = Fh + f
    put(X_t, h + bristle.FH, scaled(direction, Fh_t))
    X[h + bristle.FH] = direction * Fh
    put(X_t, h + bristle.RATE, sticking_t)
    X[h + bristle.RATE] = sticking
    X[h + bristle.DIRECTION] = direction


@compiled
def drive_integrated(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        integrated_start(P, P_t, 1, X, X_t, 0, memory.HEADER)
        H[first], rate[first] = 0.0, X[memory.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            integrated_step(P, P_t, 1, X, X_t, 0, 0, memory.HEADER, dq, dt, dq / dt)
            memory_make_room(X, X_t, 0, memory.HEADER)
            H[k], rate[k] = X[memory.FH], X[memory.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[memory.FH, i], X_t[memory.RATE, i]


@compiled
def drive_static(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            static_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_armstrong(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            armstrong_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_dahl(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            dahl_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_dahl_stribeck(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            dahl_stribeck_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_lugre(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            lugre_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_elastoplastic(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            elastoplastic_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]


@compiled
def drive_maxwell_slip(
    P: Vector,
    P_t: Tangents,
    time: Vector,
    position: Vector,
    edges: Index,
    H: Vector,
    H_t: Array,
    rate: Vector,
    rate_t: Array,
    X: Vector,
    X_t: Tangents,
) -> None:
    for j in range(len(edges) - 1):
        first = edges[j]
        for i in range(len(X)):
            put(X_t, i, ZERO)
        start_rival(P, 0, X, 0)
        H[first], rate[first] = 0.0, X[bristle.RATE]
        for i in range(len(H_t)):
            H_t[i, first], rate_t[i, first] = 0.0, 0.0
        for k in range(first + 1, edges[j + 1]):
            dq = position[k] - position[k - 1]
            dt = time[k] - time[k - 1]
            maxwell_slip_step(P, P_t, 1, X, X_t, 0, 0, dq, dt, dq / dt)
            H[k], rate[k] = X[bristle.FH], X[bristle.RATE]
            for i in range(len(H_t)):
                H_t[i, k], rate_t[i, k] = X_t[bristle.FH, i], X_t[bristle.RATE, i]
