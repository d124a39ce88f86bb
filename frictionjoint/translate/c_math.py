"""Mathematical functions that kernels use, in C99 from exp, log and pow alone.

Small C libraries of controllers lack the other functions, or provide them in single precision only.
Relative errors are a few units in the last place; for sin, cos and tan this holds for arguments up
to 1e6.
"""

import math
import re

from frictionjoint.translate.kinds import Dialect

_QUARTERS = tuple(math.atan(0.25 * k) for k in range(5))
# pi / 2 in three parts; the first two have so few digits that their products with integers are
# exact (Cody and Waite 1980)
_HALF_PI = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)

_ABS = """static inline double fj_abs(double x)
{
    return x < 0.0 ? -x : x;
}"""
_SQUARE = """static inline double fj_square(double x)
{
    return x * x;
}"""
_TWO = """static inline {kind} fj_{name}({kind} a, {kind} b)
{{
    return b {sign} a ? b : a;
}}"""
_CEIL = """/* The least whole number not below x. */
static inline int fj_ceil(double x)
{
    int whole = (int)x;
    return (double)whole < x ? whole + 1 : whole;
}"""
_SQRT = """static inline double fj_sqrt(double x)
{
    return pow(x, 0.5);
}"""
# Kahan's formulas keep the digits that the direct formulas lose
_LOG1P = """/* ln(1 + x), Kahan's form. */
static inline double fj_log1p(double x)
{
    double u = 1.0 + x;
    if (u == 1.0 || u == INFINITY) {
        return x;
    }
    return log(u) * x / (u - 1.0);
}"""
_EXPM1 = """/* exp(x) - 1, Kahan's form. */
static inline double fj_expm1(double x)
{
    double u = exp(x);
    if (u == 1.0) {
        return x;
    }
    double below = u - 1.0;
    if (below == -1.0 || u == INFINITY) {
        return below;
    }
    return below * x / log(u);
}"""
_TANH = """static inline double fj_tanh(double x)
{
    double e = fj_expm1(-2.0 * fj_abs(x));
    return (x < 0.0 ? e : -e) / (2.0 + e);
}"""
_ATAN = f"""/* Through the tangent of the difference to the nearest quarter, then its series. */
static inline double fj_atan(double x)
{{
    static const double quarters[5] = {{
        {", ".join(map(repr, _QUARTERS))}
    }};
    double y = fj_abs(x);
    double w = y > 1.0 ? 1.0 / y : y;
    int k = (int)(4.0 * w + 0.5);
    double t = (w - 0.25 * k) / (1.0 + 0.25 * k * w);
    double sum = 0.0;
    for (int i = 8; i > 0; i--) {{
        sum = -t * t * (1.0 / (2 * i + 1) + sum);
    }}
    double angle = quarters[k] + t * (1.0 + sum);
    if (y > 1.0) {{
        angle = {math.pi / 2!r} - angle;
    }}
    return x < 0.0 ? -angle : angle;
}}"""
_TURN = f"""/* sin of an angle plus `quarter` right angles: the rest beyond whole ones by series. */
static inline double fj_turn(double x, int quarter)
{{
    double turns = x * {2.0 / math.pi!r};
    int k = (int)(turns < 0.0 ? turns - 0.5 : turns + 0.5);
    double r = x - k * {_HALF_PI[0]!r};
    r = (r - k * {_HALF_PI[1]!r}) - k * {_HALF_PI[2]!r};
    unsigned int which = (unsigned int)(k + quarter) % 4u;
    double square = r * r;
    double sum = 0.0;
    int first = which % 2u == 0u ? 3 : 2;
    for (int i = first + 16; i >= first; i -= 2) {{
        sum = -square / (double)(i * (i - 1)) * (1.0 + sum);
    }}
    double value = which % 2u == 0u ? r + r * sum : 1.0 + sum;
    return which < 2u ? value : -value;
}}"""
_SIN = """static inline double fj_sin(double x)
{
    return fj_turn(x, 0);
}"""
_COS = """static inline double fj_cos(double x)
{
    return fj_turn(x, 1);
}"""
_TAN = """static inline double fj_tan(double x)
{
    return fj_turn(x, 0) / fj_turn(x, 1);
}"""

HELPERS = {
    "abs": _ABS,
    "abs_int": _ABS.replace("double", "int").replace("fj_abs", "fj_abs_int").replace("0.0", "0"),
    "square": _SQUARE,
    "min": _TWO.format(kind="double", name="min", sign="<"),
    "max": _TWO.format(kind="double", name="max", sign=">"),
    "min_int": _TWO.format(kind="int", name="min_int", sign="<"),
    "max_int": _TWO.format(kind="int", name="max_int", sign=">"),
    "ceil": _CEIL,
    "sqrt": _SQRT,
    "log1p": _LOG1P,
    "expm1": _EXPM1,
    "tanh": _TANH,
    "atan": _ATAN,
    "turn": _TURN,
    "sin": _SIN,
    "cos": _COS,
    "tan": _TAN,
}
_NEEDS = {
    "tanh": ("abs", "expm1"),
    "atan": ("abs",),
    "sin": ("turn",),
    "cos": ("turn",),
    "tan": ("turn",),
}


# integer quotient and remainder, rounded down as in Python, which the C library does not provide
_WHOLE = """static inline int fj_floor_div(int a, int b)
{
    int whole = a / b;
    return whole * b != a && (a < 0) != (b < 0) ? whole - 1 : whole;
}"""
_REST = """static inline int fj_floor_mod(int a, int b)
{
    return a - fj_floor_div(a, b) * b;
}"""
HELPERS |= {"floor_div": _WHOLE, "floor_mod": _REST}
_NEEDS["floor_mod"] = ("floor_div",)


def helpers_of(names: set[str], dialect: Dialect) -> list[str]:
    """C text of helpers and of the helpers that they call, each after those that it calls."""
    wanted = names.union(*(_NEEDS.get(name, ()) for name in names))
    texts = [HELPERS[name] for name in HELPERS if name in wanted]
    return [re.sub(r"\bint\b", dialect.whole, text) for text in texts]
