"""Harmonics by shaft order, and what the number of pistons does to them.

`x_n = 1/(2 pi) integral x e^(-i n angle) d angle`, `n` counted per revolution
of the shaft (docs/theory.md section 5). A waveform that repeats with the cam holds
multiples of its repeats only; summing equally spaced pistons keeps the orders
that the number of pistons divides, times that number, and removes the rest.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

from camring.numerics.fourier import harmonics
from camring.physics.cycle import Cycle
from camring.physics.piston_state import QuadratureSamples, quadrature_samples


class Spectrum(NamedTuple):
    """Complex amplitudes at the orders that a periodic waveform can hold."""

    mean: Float[Array, ""]
    amplitude: Complex[Array, " order"]
    orders: np.ndarray

    def power(self) -> Float[Array, ""]:
        """Sum of squared amplitudes over positive orders: half the variance."""
        return jnp.sum(jnp.abs(self.amplitude) ** 2)

    def ripple(self) -> Float[Array, ""]:
        """`R_x`, one-sided as the derivation defines it. docs/theory.md section 5."""
        return jnp.sqrt(self.power()) / jnp.abs(self.mean)


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
