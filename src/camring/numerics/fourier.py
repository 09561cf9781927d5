"""Fourier coefficients of a periodic waveform given at quadrature points."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float


def harmonics(
    values: Float[Array, "*wave point"],
    weights: Float[Array, " point"],
    angle: Float[Array, " point"],
    step: int,
    count: int,
) -> Complex[Array, "*wave count"]:
    """`x_n = 1/period * integral x e^(-i n angle)` for n = step, 2 step, ..., count step.

    Parameters
    ----------
    values
        Waveforms at the quadrature points of one period, leading axes free.
    weights
        Quadrature weights over the period; their sum is the period.

    Notes
    -----
    The quadrature must resolve the highest harmonic: six Gauss points carry
    about 8 rad of phase in an element to 1e-5. Each harmonic's phases come
    from the one before by a complex product, so none needs a cosine.
    """
    turn = jnp.exp(-1j * step * angle)
    weighted = values * (weights / jnp.sum(weights))

    def next_harmonic(phase: Array, _: None) -> tuple[Array, Array]:
        coefficient = weighted @ phase.real + 1j * (weighted @ phase.imag)
        return phase * turn, coefficient

    _, found = jax.lax.scan(next_harmonic, turn, None, length=count, unroll=4)
    return jnp.moveaxis(found, 0, -1)
