"""Elementary functions in plain arithmetic against the C library's, of more digits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from camring.compiler.elementary import ELEMENTARY, LARGEST_ANGLE
from camring.compiler.program import NativeProgram
from camring.numerics.quantity import real

SMALLEST_NORMAL = np.finfo(float).smallest_normal
COUNT = 20_000

PRECISE = {
    "exp": np.exp,
    "exp2": np.exp2,
    "log": np.log,
    "log1p": np.log1p,
    "expm1": np.expm1,
    "tanh": np.tanh,
    "logistic": lambda x: 1 / (1 + np.exp(-x)),
    "cbrt": np.cbrt,
    "rsqrt": lambda x: 1 / np.sqrt(x),
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "atan": np.arctan,
    "asin": np.arcsin,
    "acos": np.arccos,
}
"""Called with 64 binary digits, where there are so many, the C library rounds correctly."""
UNITS = {"log": 1.0, "cbrt": 1.0, "log1p": 2.5, "asin": 2.5, "logistic": 2.5}
UNITS |= {"expm1": 3.0, "tan": 4.0}
"""Largest error in units of the last place; of all others 2. Measured: seven tenths of it on."""
PRECISE_OF_TWO = {"pow": np.power, "atan2": np.arctan2}

SMALL = [0, 1e-200, 1e-16, 1e-8, 0.5, 0.625, 1 - 2.0**-53, 1, 1 + 2.0**-52, 2, 2.5, 3]
LARGE = [707, 708, 708.5, 709, 709.5, 709.782, 710, 745, 746, 1023, 1024, 1075, 1e16, 1e200]
ENDS = [SMALLEST_NORMAL, np.pi / 2, np.pi, np.finfo(float).max, np.inf]
AWKWARD = np.array([*SMALL, *LARGE, *ENDS])
AWKWARD = np.concatenate([AWKWARD, -AWKWARD, [np.nan]])
SUBNORMAL = np.array([5e-324, -5e-324, 1e-310, -1e-310, 2e-308])


def numbers(seed=0) -> np.ndarray:
    """Of every size, most of them of sizes where something happens."""
    rng = np.random.default_rng(seed)
    signs = rng.choice([-1, 1], COUNT)
    return np.concatenate(
        [
            AWKWARD,
            rng.uniform(-1, 1, COUNT),
            rng.uniform(-30, 30, COUNT),
            rng.uniform(-1100, 1100, COUNT),
            1 + rng.uniform(-1e-3, 1e-3, COUNT),
            signs * np.exp(rng.uniform(-40, 0, COUNT)),
            signs * np.exp(rng.uniform(-700, 700, COUNT)),
        ]
    )


def machine(function, *arguments):
    """Compiled by the package; the function takes its arguments one by one."""
    return NativeProgram(lambda given: function(*given), arguments)(arguments)


def by_primitive(name):
    """What JAX's own primitive of that name becomes."""
    return getattr(jax.lax, name)


def units_off(found, precise) -> np.ndarray:
    """Errors in units of the last place of the precise result."""
    with np.errstate(all="ignore"):
        found, rounded = np.asarray(found), np.asarray(precise, float)
        place = np.spacing(np.maximum(np.abs(rounded), SMALLEST_NORMAL))
        off = np.asarray(np.abs(found - precise) / place, float)
    same = (found == rounded) | (np.isnan(found) & np.isnan(rounded))
    return np.where(same, 0, np.where(np.isfinite(off), off, np.inf))


def precise(function, *arguments) -> np.ndarray:
    with np.errstate(all="ignore"):
        return function(*(each.astype(np.longdouble) for each in arguments))


def assert_close(found, expected, units, *arguments):
    off = units_off(found, expected)
    worst = int(np.argmax(off))
    case = [each[worst] for each in arguments]
    assert off[worst] <= units, (off[worst], case, np.asarray(found)[worst], expected[worst])


def flushed(result):
    """What a compiler makes of it that knows no numbers below the smallest normal one."""
    return np.where(np.abs(result) < 2 * SMALLEST_NORMAL, 0, result)


@pytest.mark.parametrize("made_by", ["jax", "machine"])
@pytest.mark.parametrize("name", PRECISE)
def test_a_function_is_right_to_a_few_units_in_the_last_place(name, made_by):
    x = numbers()
    if name in ("sin", "cos", "tan"):
        x = x[~(np.abs(x) > LARGEST_ANGLE)]
        # Next to a zero an angle's own last digit is all there is of the result.
        x = x[~np.isin(np.abs(x), [np.pi, np.pi / 2])]
    by_jax = made_by == "jax"
    found = jax.jit(ELEMENTARY[name])(real(x)) if by_jax else machine(by_primitive(name), x)
    expected = precise(PRECISE[name], x)
    # JAX has no numbers below the smallest normal one, nor has 1 / (1 + exp(-x)).
    if by_jax or name == "logistic":
        found, expected = flushed(found), flushed(expected)
    assert_close(found, expected, UNITS.get(name, 2.0), x)


@pytest.mark.parametrize("name", PRECISE)
def test_the_smallest_numbers_have_functions_too(name):
    x = np.concatenate([SUBNORMAL, [0.0]])
    expected = precise(PRECISE[name], x)
    assert_close(machine(by_primitive(name), x), expected, UNITS.get(name, 2.0), x)


@pytest.mark.parametrize("made_by", ["jax", "machine"])
@pytest.mark.parametrize("name", PRECISE_OF_TWO)
def test_a_function_of_two_is_right_to_two_units_in_the_last_place(name, made_by):
    rng = np.random.default_rng(1)
    all_sizes = np.exp(rng.uniform(-700, 700, (2, COUNT))) * rng.choice([-1, 1], (2, COUNT))
    pairs = [
        np.array(np.meshgrid(AWKWARD, AWKWARD)).reshape(2, -1),
        all_sizes,
        np.array([np.abs(all_sizes[0]), rng.uniform(-1, 1, COUNT)]),
        np.array([1 + rng.uniform(-0.5, 1, COUNT), rng.uniform(-1000, 1000, COUNT)]),
        np.array([rng.uniform(-100, 100, COUNT), np.round(rng.uniform(-150, 150, COUNT))]),
        np.array([1 + rng.uniform(-1e-9, 1e-9, COUNT), rng.uniform(-1e11, 1e11, COUNT)]),
    ]
    if made_by == "machine":
        pairs.append(np.array(np.meshgrid(SUBNORMAL, AWKWARD)).reshape(2, -1))
        pairs.append(np.array(np.meshgrid(AWKWARD, SUBNORMAL)).reshape(2, -1))
    first, second = np.concatenate(pairs, axis=1)
    if made_by == "jax":
        found = jax.jit(ELEMENTARY[name])(real(first), real(second))
    else:
        found = machine(by_primitive(name), first, second)
    expected = precise(PRECISE_OF_TWO[name], first, second)
    if made_by == "jax":
        found, expected = flushed(found), flushed(expected)
    assert_close(found, expected, 2.0, first, second)


@pytest.mark.parametrize("name", ["atan", "asin", "cbrt"])
def test_zero_keeps_its_sign(name):
    zeros = np.array([0.0, -0.0])
    np.testing.assert_array_equal(np.signbit(machine(by_primitive(name), zeros)), [False, True])


def test_angles_between_all_directions_have_the_signs_of_their_zeros():
    ends = np.array([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf])
    y, x = np.array(np.meshgrid(ends, ends)).reshape(2, -1)
    found = machine(jnp.arctan2, y, x)
    np.testing.assert_allclose(found, np.arctan2(y, x), rtol=4e-16)
    np.testing.assert_array_equal(np.signbit(found), np.signbit(np.arctan2(y, x)))


@pytest.mark.parametrize("name", ["sin", "cos"])
def test_a_zero_of_a_wave_is_where_pi_is(name):
    """To what pi in three parts is worth: 31 digits of it."""
    quarters = np.arange(1, 2001)
    x = quarters * (np.pi / 2)
    expected = precise(PRECISE[name], x)
    error = np.abs(machine(by_primitive(name), x) - expected)
    assert np.all(error <= 1e-31 * x + 4e-16 * np.abs(expected))


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_angles_too_large_for_pi_in_three_parts_are_refused(name):
    x = np.array([LARGEST_ANGLE, 1.1 * LARGEST_ANGLE, -1e300, np.inf])
    np.testing.assert_array_equal(
        np.isnan(machine(by_primitive(name), x)), [False, True, True, True]
    )


def test_numbers_of_single_precision_are_computed_in_double():
    x = np.linspace(0.1, 3, 16, dtype=np.float32)
    found = machine(lambda x: jnp.exp(x) * jnp.log(x), x)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, np.exp(x) * np.log(x), rtol=3e-7, atol=1e-7)
