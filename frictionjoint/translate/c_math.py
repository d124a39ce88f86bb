"""Mathematical functions that kernels use, in C99 from exp, log and pow alone.

Small C libraries lack the others, or have them in single precision only. Relative errors are a few
units in the last place; for sin, cos and tan this holds for arguments up to 1e6.
"""

import math
import re
from string import Template

from frictionjoint.translate.kinds import Dialect

_NUMBERS = {
    "quarters": ", ".join(repr(math.atan(0.25 * k)) for k in range(5)),
    "right_angle": repr(math.pi / 2),
    "per_right_angle": repr(2.0 / math.pi),
    # pi / 2 in three parts; the first two have so few digits that their products with integers are
    # exact (Cody and Waite 1980)
    "first_part": "1.5707963267341256",
    "second_part": "6.077100506303966e-11",
    "third_part": "2.0222662487959506e-21",
}
# Each function comes after those that it calls. log1p and expm1: Kahan's formulas keep the digits
# that the direct formulas lose. floor_div and floor_mod: integer quotient and remainder, rounded
# down as in Python, which the C library does not provide.
_SOURCE = """\
static inline double fj_abs(double x)
{
    return x < 0.0 ? -x : x;
}

static inline double fj_min(double a, double b)
{
    return b < a ? b : a;
}

static inline double fj_max(double a, double b)
{
    return b > a ? b : a;
}

/* The least whole number not below x. */
static inline int fj_ceil(double x)
{
    int whole = (int)x;
    return (double)whole < x ? whole + 1 : whole;
}

static inline double fj_sqrt(double x)
{
    return pow(x, 0.5);
}

/* ln(1 + x), Kahan's form. */
static inline double fj_log1p(double x)
{
    double u = 1.0 + x;
    if (u == 1.0 || u == INFINITY) {
        return x;
    }
    return log(u) * x / (u - 1.0);
}

/* exp(x) - 1, Kahan's form. */
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
}

static inline double fj_tanh(double x)
{
    double e = fj_expm1(-2.0 * fj_abs(x));
    return (x < 0.0 ? e : -e) / (2.0 + e);
}

/* Through the tangent of the difference to the nearest quarter, then its series. */
static inline double fj_atan(double x)
{
    static const double quarters[5] = {
        $quarters
    };
    double y = fj_abs(x);
    double w = y > 1.0 ? 1.0 / y : y;
    int k = (int)(4.0 * w + 0.5);
    double t = (w - 0.25 * k) / (1.0 + 0.25 * k * w);
    double sum = 0.0;
    for (int i = 8; i > 0; i--) {
        sum = -t * t * (1.0 / (2 * i + 1) + sum);
    }
    double angle = quarters[k] + t * (1.0 + sum);
    if (y > 1.0) {
        angle = $right_angle - angle;
    }
    return x < 0.0 ? -angle : angle;
}

/* sin of an angle plus `quarter` right angles: the rest beyond whole ones by series. */
static inline double fj_turn(double x, int quarter)
{
    double turns = x * $per_right_angle;
    int k = (int)(turns < 0.0 ? turns - 0.5 : turns + 0.5);
    double r = x - k * $first_part;
    r = (r - k * $second_part) - k * $third_part;
    unsigned int which = (unsigned int)(k + quarter) % 4u;
    double square = r * r;
    double sum = 0.0;
    int first = which % 2u == 0u ? 3 : 2;
    for (int i = first + 16; i >= first; i -= 2) {
        sum = -square / (double)(i * (i - 1)) * (1.0 + sum);
    }
    double value = which % 2u == 0u ? r + r * sum : 1.0 + sum;
    return which < 2u ? value : -value;
}

static inline double fj_sin(double x)
{
    return fj_turn(x, 0);
}

static inline double fj_cos(double x)
{
    return fj_turn(x, 1);
}

static inline double fj_tan(double x)
{
    return fj_turn(x, 0) / fj_turn(x, 1);
}

static inline int fj_floor_div(int a, int b)
{
    int whole = a / b;
    return whole * b != a && (a < 0) != (b < 0) ? whole - 1 : whole;
}

static inline int fj_floor_mod(int a, int b)
{
    return a - fj_floor_div(a, b) * b;
}"""
_FUNCTION = re.compile(r"\bfj_(\w+)\(")
_HELPERS = {
    _FUNCTION.findall(text)[0]: text
    for text in Template(_SOURCE).substitute(_NUMBERS).split("\n\n")
}
for _name in ("abs", "min", "max"):
    _real = _HELPERS[_name].replace("double", "int").replace("0.0", "0")
    _HELPERS[f"{_name}_int"] = _real.replace("(", "_int(", 1)


def helpers_of(names: set[str], dialect: Dialect) -> list[str]:
    """C text of helpers and of the helpers that they call, each after those that it calls."""
    wanted = names.union(*(_FUNCTION.findall(_HELPERS[name]) for name in names))
    texts = [text for name, text in _HELPERS.items() if name in wanted]
    return [re.sub(r"\bint\b", dialect.whole, text) for text in texts]
