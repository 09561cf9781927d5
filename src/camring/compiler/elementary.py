"""Functions that processors have no instruction for, in plain arithmetic.

Rational approximations of Moshier's Cephes library (1989), and for powers the logarithm
in two parts of Sun's fdlibm (1993): a few units in the last place from exact for every
finite number. Infinities and what is undefined come out as they do elsewhere. Only sines
and cosines have a limit, `LARGEST_ANGLE`, beyond which they are no number.

No result depends on whether a product and a sum are rounded once or twice: where the
rounding error of a product is needed, its factors are cut so short that it has none.
"""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array

MANTISSA = 52
BIAS = 1023
SMALLEST_NORMAL = 2.0**-1022
SHIFT = 1.5 * 2.0**52
"""Added to a whole number, it leaves that number in the lowest bits."""
SHIFT_BITS = np.float64(SHIFT).view(np.int64)
UPPER_HALF = np.int64(-1 << 27)
LARGEST_ANGLE = 1e8
"""Pi is subtracted in three parts, which are exact for so many quarters of a turn."""


def _polynomial(x: Array, *coefficients: float) -> Array:
    """Highest power first."""
    total = jnp.full_like(x, coefficients[0])
    for each in coefficients[1:]:
        total = total * x + each
    return total


def _bits(x: Array) -> Array:
    return lax.bitcast_convert_type(x, jnp.int64)


def _number(bits: Array) -> Array:
    return lax.bitcast_convert_type(bits, jnp.float64)


def _scaled(x: Array, exponent: Array) -> Array:
    """`x 2^exponent` for exponents of normal numbers."""
    return x * _number((_bits(exponent + SHIFT) + BIAS) << MANTISSA)


def _split(x: Array, least: float) -> tuple[Array, Array]:
    """Fraction from `least` on, below twice as much, and exponent; both of a positive number."""
    small = x < SMALLEST_NORMAL
    bits = _bits(jnp.where(small, x * 2.0**54, x))
    offset = np.float64(least).view(np.int64) - np.int64(BIAS << MANTISSA)
    exponent = lax.shift_right_arithmetic(bits - offset, np.int64(MANTISSA)) - BIAS
    fraction = _number(bits - (exponent << MANTISSA))
    whole = _number(exponent + SHIFT_BITS) - SHIFT
    return fraction, whole - jnp.where(small, 54.0, 0.0)


def _cut(x: Array) -> Array:
    """The upper half of the digits: products of such numbers are exact."""
    return _number(_bits(x) & UPPER_HALF)


def _undefined(x: Array) -> Array:
    """No number, whatever `x` is."""
    return (x - x) * jnp.inf


def _raised(r: Array, whole: Array) -> Array:
    """`exp(r) 2^whole` for small `r`; zero or infinite where that is all there is room for."""
    square = r * r
    odd = r * _polynomial(
        square, 1.26177193074810590878e-4, 3.02994407707441961300e-2, 9.99999999999999999910e-1
    )
    even = _polynomial(
        square,
        3.00198505138664455042e-6,
        2.52448340349684104192e-3,
        2.27265548208155028766e-1,
        2.0,
    )
    # In two steps: the largest and the smallest exponents have no normal power of two.
    half = jnp.floor(whole * 0.5)
    return _scaled(_scaled(1 + 2 * (odd / (even - odd)), half), whole - half)


def exp(x: Array) -> Array:
    inside = jnp.clip(x, -746.0, 710.0)
    whole = jnp.floor(inside * 1.4426950408889634 + 0.5)
    r = inside - whole * 6.93145751953125e-1 - whole * 1.42860682030941723212e-6
    return _raised(r, whole)


def exp2(x: Array) -> Array:
    inside = jnp.clip(x, -1076.0, 1024.0)
    whole = jnp.floor(inside + 0.5)
    return _raised((inside - whole) * np.log(2), whole)


def _logarithm(fraction: Array, power: Array) -> Array:
    """Of `(1 + fraction) 2^power`, the fraction between the roots of one half and two."""
    square = fraction * fraction
    over = _polynomial(
        fraction,
        1.01875663804580931796e-4,
        4.97494994976747001425e-1,
        4.70579119878881725854e0,
        1.44989225341610930846e1,
        1.79368678507819816313e1,
        7.70838733755885391666e0,
    )
    under = _polynomial(
        fraction,
        1.0,
        1.12873587189167450590e1,
        4.52279145837532221105e1,
        8.29875266912776603211e1,
        7.11544750618563894466e1,
        2.31251620126765340583e1,
    )
    rest = fraction * (square * (over / under)) - power * 2.121944400546905827679e-4
    return fraction + (rest - 0.5 * square) + power * 0.693359375


def _where_defined(found: Array, x: Array) -> Array:
    """The logarithm of `x` as found, if there is one."""
    found = jnp.where(x > 0, found, jnp.where(x == 0, -jnp.inf, _undefined(x)))
    return jnp.where(x == jnp.inf, jnp.inf, found)


def log(x: Array) -> Array:
    near_one, power = _split(x, np.sqrt(0.5))
    return _where_defined(_logarithm(near_one - 1, power), x)


def log1p(x: Array) -> Array:
    near_one, power = _split(1 + x, np.sqrt(0.5))
    # Where it is near one already, `x` is the fraction, not rounded by adding one.
    return _where_defined(_logarithm(jnp.where(power == 0, x, near_one - 1), power), 1 + x)


def expm1(x: Array) -> Array:
    half = tanh(0.5 * x)
    return jnp.where(jnp.abs(x) < 1, 2 * half / (1 - half), exp(x) - 1)


def _binary_logarithm(x: Array) -> tuple[Array, Array]:
    """In two parts, the first of half as many digits; for positive finite numbers."""
    fraction, power = _split(x, np.sqrt(0.75))
    above = fraction >= np.sqrt(1.5)
    base = jnp.where(above, 1.5, 1.0)
    difference, total = fraction - base, fraction + base
    ratio = difference / total
    first, total_first = _cut(ratio), _cut(total)
    second = (
        (difference - first * total_first) - first * (fraction - (total_first - base))
    ) / total
    square = ratio * ratio
    fourth = _polynomial(
        square,
        2.06975017800338417784e-1,
        2.30660745775561754067e-1,
        2.72728123808534006489e-1,
        3.33333329818377432918e-1,
        4.28571428578550184252e-1,
        5.99999999999994648725e-1,
    )
    rest = square * square * fourth + second * (first + ratio)
    square = first * first
    term = _cut(3 + square + rest)
    left = rest - ((term - 3) - square)
    product = first * term
    left = second * term + left * ratio
    upper = _cut(product + left)
    lower = left - (upper - product)
    # Two thirds of the binary logarithm of e, and the binary logarithm of 1.5.
    large = 9.61796700954437255859e-1 * upper
    small = -7.02846165095275826516e-9 * upper + lower * 9.61796693925975554329e-1
    small = small + jnp.where(above, 1.35003920212974897128e-8, 0.0)
    step = jnp.where(above, 5.84962487220764160156e-1, 0.0)
    leading = _cut(((large + small) + step) + power)
    return leading, small - (((leading - power) - step) - large)


def power(base: Array, exponent: Array) -> Array:
    base, exponent = jnp.broadcast_arrays(base, exponent)
    size = jnp.abs(base)
    leading, rest = _binary_logarithm(size)
    times = jnp.clip(exponent, -1e300, 1e300)
    first = _cut(times)
    large, small = first * leading, (times - first) * leading + times * rest
    total = large + small
    whole = jnp.floor(jnp.clip(total, -1080.0, 1030.0) + 0.5)
    found = _raised(((large - whole) + small) * np.log(2), whole)
    # What is beyond all numbers, and what has no logarithm.
    grows = jnp.where((size == 0) | (size == jnp.inf), (size > 0) == (exponent > 0), total > 0)
    beyond = (jnp.abs(total) > 1079) | (size == 0) | (size == jnp.inf)
    found = jnp.where(beyond, jnp.where(grows, jnp.inf, 0.0), found)
    below = _bits(base) < 0
    half = 0.5 * times
    odd = (jnp.floor(times) == times) & (jnp.floor(half) != half)
    found = jnp.where(below & odd, -found, found)
    fractional = (base < 0) & (size < jnp.inf) & (jnp.floor(times) != times)
    found = jnp.where(fractional | (base != base) | (exponent != exponent), _undefined(base), found)
    return jnp.where((exponent == 0) | (base == 1), 1.0, found)


def tanh(x: Array) -> Array:
    square = x * x
    over = _polynomial(
        square, -9.64399179425052238628e-1, -9.92877231001918586564e1, -1.61468768441708447952e3
    )
    under = _polynomial(
        square, 1.0, 1.12811678491632931402e2, 2.23548839060100448583e3, 4.84406305325125486048e3
    )
    near = x + x * square * over / under
    far = jnp.sign(x) * (1 - 2 / (exp(2 * jnp.abs(x)) + 1))
    return jnp.where(jnp.abs(x) < 0.625, near, far)


def _arc(x: Array) -> Array:
    """Arc tangent between 0 and 1."""
    far = x > 0.66
    x = jnp.where(far, (x - 1) / (x + 1), x)
    square = x * x
    over = _polynomial(
        square,
        -8.750608600031904122785e-1,
        -1.615753718733365076637e1,
        -7.500855792314704667340e1,
        -1.228866684490136173410e2,
        -6.485021904942025371773e1,
    )
    under = _polynomial(
        square,
        1.0,
        2.485846490142306297962e1,
        1.650270098316988542046e2,
        4.328810604912902668951e2,
        4.853903996359136964868e2,
        1.945506571482613964425e2,
    )
    return x * (square * (over / under)) + x + jnp.where(far, np.pi / 4, 0.0)


def atan2(y: Array, x: Array) -> Array:
    y, x = jnp.broadcast_arrays(y, x)
    across, along = jnp.abs(y), jnp.abs(x)
    smaller, larger = jnp.minimum(across, along), jnp.maximum(across, along)
    # Equal also where both are zero or infinite, but zero has no diagonal.
    share = jnp.where(smaller == jnp.inf, 1.0, smaller / jnp.where(larger == 0, 1.0, larger))
    angle = _arc(share)
    angle = jnp.where(across > along, np.pi / 2 - angle, angle)
    angle = jnp.where(_bits(x) < 0, np.pi - angle, angle)
    return jnp.where(_bits(y) < 0, -angle, angle)


def _turned(x: Array, quarter: int) -> Array:
    """Sine of `x` plus so many quarters of a turn."""
    number = jnp.floor(x * (2 / np.pi) + 0.5)
    r = x - number * 1.57079625129699707031e0
    r = r - number * 7.54978941586159635335e-8 - number * 5.39030285815811905290e-15
    square = r * r
    sine = r + r * square * _polynomial(
        square,
        1.58962301576546568060e-10,
        -2.50507477628578072866e-8,
        2.75573136213857245213e-6,
        -1.98412698295895385996e-4,
        8.33333333332211858878e-3,
        -1.66666666666666307295e-1,
    )
    fourth = _polynomial(
        square,
        -1.13585365213876817300e-11,
        2.08757008419747316778e-9,
        -2.75573141792967388112e-7,
        2.48015872888517045348e-5,
        -1.38888888888730564116e-3,
        4.16666666666665929218e-2,
    )
    cosine = 1 - square / 2 + square * square * fourth
    which = number + quarter
    which = which - 4 * jnp.floor(which * 0.25)
    even = (which == 0) | (which == 2)
    found = jnp.where(even, sine, cosine)
    found = jnp.where(which >= 2, -found, found)
    return jnp.where(jnp.abs(x) <= LARGEST_ANGLE, found, _undefined(x))


def sin(x: Array) -> Array:
    return _turned(x, 0)


def cos(x: Array) -> Array:
    return _turned(x, 1)


def cbrt(x: Array) -> Array:
    size = jnp.abs(x)
    root = exp(log(size) * (1 / 3))
    root = root + (size / (root * root) - root) * (1 / 3)
    root = jnp.where(x < 0, -root, root)
    return jnp.where((size > 0) & (size < jnp.inf), root, x)


def asin(x: Array) -> Array:
    return atan2(x, jnp.sqrt((1 - x) * (1 + x)))


def acos(x: Array) -> Array:
    return atan2(jnp.sqrt((1 - x) * (1 + x)), x)


def _in_double(function: Callable) -> Callable:
    """For numbers of any kind, which the approximations are not."""

    def found(*arguments: Array) -> Array:
        result = function(*(each.astype(jnp.float64) for each in arguments))
        return result.astype(arguments[0].dtype)

    return found


_IN_DOUBLE: dict[str, Callable] = {
    "exp": exp,
    "exp2": exp2,
    "log": log,
    "log1p": log1p,
    "expm1": expm1,
    "pow": power,
    "tanh": tanh,
    "logistic": lambda x: 1 / (1 + exp(-x)),
    "cbrt": cbrt,
    "rsqrt": lambda x: 1 / jnp.sqrt(x),
    "sin": sin,
    "cos": cos,
    "tan": lambda x: sin(x) / cos(x),
    "atan": lambda x: atan2(x, jnp.ones_like(x)),
    "atan2": atan2,
    "asin": asin,
    "acos": acos,
}

ELEMENTARY = {name: _in_double(function) for name, function in _IN_DOUBLE.items()}
"""By the names of JAX's primitives."""
