"""Harmonics by shaft order, and what the number of pistons does to them.

`x_n = 1/(2 pi) integral x e^(-i n angle) d angle`, `n` counted per revolution
of the shaft (model.md section 5). A waveform that repeats with the cam holds
multiples of its repeats only; summing equally spaced pistons keeps the orders
that the number of pistons divides, times that number, and removes the rest.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from camring.numerics.fourier import harmonics
from camring.numerics.quadrature import gauss_legendre
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.piston_state import PistonState, sample_elements

QUADRATURE_POINTS = 4


class QuadratureSamples(NamedTuple):
    """The reference piston at Gauss points of every element, and their weights."""

    piston: PistonState
    pressure_slope: Q[Float[Array, "point element"], "Pa/rad"]
    """Slope of the solution itself, which meets the equation to solver accuracy only."""
    weights: Float[Array, "point element *lane"]

    def mean(self, values: Float[Array, "point element *lane"]) -> Float[Array, "*lane"]:
        """Mean over a period."""
        total = jnp.sum(self.weights * values, axis=(0, 1))
        return total / jnp.sum(self.weights, axis=(0, 1))


class Spectrum(NamedTuple):
    """Complex amplitudes at the orders that a periodic waveform can hold."""

    mean: Float[Array, ""]
    amplitude: Complex[Array, " order"]
    orders: np.ndarray

    def power(self) -> Float[Array, ""]:
        """Sum of squared amplitudes over positive orders: half the variance."""
        return jnp.sum(jnp.abs(self.amplitude) ** 2)

    def ripple(self) -> Float[Array, ""]:
        """`R_x`, one-sided as the derivation defines it. model.md section 5."""
        return jnp.sqrt(self.power()) / jnp.abs(self.mean)


def quadrature_samples(cycle: Cycle) -> QuadratureSamples:
    """Sample a cycle where its integrals are taken."""
    points, weights = gauss_legendre(QUADRATURE_POINTS)
    piston = sample_elements(cycle, jnp.asarray(points))
    slope = cycle.orbit.slope(jnp.asarray(points)) / cycle.fluid.state_slope(
        piston.chamber_pressure
    )
    return QuadratureSamples(piston, slope, jnp.asarray(weights)[:, None] * cycle.orbit.mesh.width)


def chamber_spectra(
    cycle: Cycle,
    samples: QuadratureSamples,
    waveforms: list[Float[Array, "point element"]],
    highest_order: int,
) -> list[Spectrum]:
    """Spectra of several waveforms of one piston, orders up to the highest."""
    step = cycle.motor.cam.repeats
    count = highest_order // step
    mesh = cycle.orbit.mesh
    orders = step * np.arange(1, count + 1)
    to_zero_angle = jnp.exp(-1j * orders * mesh.start[0])
    stacked = jnp.stack(waveforms)
    amplitudes = to_zero_angle * harmonics(stacked, mesh, cycle.motor.cam.period, count)
    return [
        Spectrum(samples.mean(wave), amplitude, orders)
        for wave, amplitude in zip(waveforms, amplitudes, strict=True)
    ]


def of_all_pistons(spectrum: Spectrum, pistons: int) -> Spectrum:
    """The spectrum of the sum over equally spaced pistons: the multiple-piston filter."""
    kept = spectrum.orders % pistons == 0
    return Spectrum(
        pistons * spectrum.mean, pistons * spectrum.amplitude[..., kept], spectrum.orders[kept]
    )


class OrderSpectrum(NamedTuple):
    """Peak amplitudes by shaft order, for display: `2 |x_n|`."""

    orders: np.ndarray
    torque: Float[Array, " order"]
    chamber_pressure: Float[Array, " order"]
    supply_flow: Float[Array, " order"]


def order_spectrum(cycle: Cycle, highest_order: int = 600) -> OrderSpectrum:
    """Peak amplitudes of shaft torque, N m, chamber pressure, Pa, and total supply flow, m3/s.

    Orders are the multiples of the cam's repeats; torque and flow are zero at
    those which the number of pistons does not divide.
    """
    samples = quadrature_samples(cycle)
    piston = samples.piston
    per_amount = 1 / cycle.fluid.content(cycle.point.supply_pressure)
    waves = [piston.torque, piston.chamber_pressure, piston.supply_flow * per_amount]
    torque, pressure, flow = chamber_spectra(cycle, samples, waves, highest_order)
    pistons = cycle.motor.pistons
    heard = jnp.where(pressure.orders % pistons == 0, pistons, 0)
    return OrderSpectrum(
        pressure.orders,
        2 * heard * jnp.abs(torque.amplitude),
        2 * jnp.abs(pressure.amplitude),
        2 * heard * jnp.abs(flow.amplitude),
    )
