"""Fourier coefficients of a periodic waveform known on the elements of a mesh.

The waveform is taken as a polynomial through its Gauss points in each element
and integrated four times, exactly, however thin the element. The integral is
smooth enough to be sampled on a uniform grid for a fast Fourier transform,
whose coefficients are then differentiated four times. What would alias is
damped fourfold: order `m` picks up order `K - m` times `(m/(K - m))^4` only,
`K` being the number of samples.
"""

from functools import cache

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from camring.numerics.mesh import Mesh
from camring.numerics.quadrature import gauss_legendre

SAMPLES_PER_HARMONIC = 20
INTEGRATIONS = 4
"""Five would lose the six hundredth order of a free ring to rounding."""


@cache
def _powers_matrix(points: int) -> np.ndarray:
    """Powers 0 to n - 1 of the polynomial through values at Gauss points; shape (n, n)."""
    at, _ = gauss_legendre(points)
    return np.linalg.inv(at[:, None] ** np.arange(points))


def _samples(count: int) -> int:
    """Enough of them for so many harmonics, and a size that transforms fast."""
    least = SAMPLES_PER_HARMONIC * count
    step = 2 ** max(least.bit_length() - 3, 0)
    return -(-least // step) * step


def integral(
    powers: list[Array], width: Float[Array, " element *batch"], axis: int = -1
) -> list[Array]:
    """The periodic integral of a piecewise polynomial, up to a constant: one power more.

    Coefficients in ascending powers of the element fraction, elements along an axis. The
    mean is taken off first, so that what remains closes over the period.
    """
    over = [width / (power + 1) * each for power, each in enumerate(powers)]
    whole = _total(over)
    mean = jnp.sum(whole, axis=axis, keepdims=True) / jnp.sum(width, axis=axis, keepdims=True)
    over[0] = over[0] - width * mean
    whole = whole - width * mean
    before = jnp.cumsum(whole, axis=axis) - whole
    return [before, *over]


def _total(arrays: list[Array]) -> Array:
    total = arrays[0]
    for each in arrays[1:]:
        total = total + each
    return total


def harmonics(
    values: Float[Array, "wave point element"],
    mesh: Mesh,
    period: float,
    count: int,
) -> Complex[Array, "wave count"]:
    """`1/period * integral x e^(-2 pi i m (x - x0)/period)` for m = 1 ... count.

    Parameters
    ----------
    values
        Waveforms at the Gauss-Legendre points of every element.

    Notes
    -----
    Positions count from the first node `x0` of the mesh, so phases do too.
    """
    points = values.shape[1]
    powers = [
        _total([float(row[i]) * values[:, i] for i in range(points)])
        for row in _powers_matrix(points)
    ]
    for _ in range(INTEGRATIONS):
        powers = integral(powers, mesh.width)

    samples = _samples(count)
    element, fraction = mesh.locate(mesh.start[0] + period / samples * jnp.arange(samples))
    sampled = powers[-1][:, element]
    for each in powers[-2::-1]:
        sampled = sampled * fraction + each[:, element]
    found = jnp.fft.rfft(sampled, axis=-1)[:, 1 : count + 1] / samples
    return found * (2j * np.pi / period * np.arange(1, count + 1)) ** INTEGRATIONS
