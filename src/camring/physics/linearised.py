"""The derivation's small-signal model of a chamber, about a nominal point.

`dP~/dt + (beta Ch/V) P~ = -(beta Ap/V) ds~/dt` with all conductance in one
number `Ch`: a high-pass from lift to pressure (docs/theory.md section 7). It says
how a stiff chamber turns motion into pressure; it does not know that the ports
open and close.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

from camring.numerics.quantity import Q, real
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint


class LinearChamber(eqx.Module):
    """A chamber of constant volume and conductance."""

    volume: Q[Float[Array, ""], "m3"] = eqx.field(converter=real)
    piston_area: Q[Float[Array, ""], "m2"] = eqx.field(converter=real)
    bulk_modulus: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    conductance: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)

    @property
    def time_constant(self) -> Q[Float[Array, ""], "s"]:
        """`tau_h = V/(beta Ch)`: how long a pressure disturbance lives."""
        return self.volume / (self.bulk_modulus * self.conductance)

    def transfer(
        self, frequency: Q[Float[Array, "*order"], "rad/s"]
    ) -> Q[Complex[Array, "*order"], "Pa/m"]:
        """`G = -(beta Ap/V) i w / (i w + beta Ch/V)`: pressure for each metre of lift.

        Limits: `-(Ap/Ch) i w` for slow motion, `-beta Ap/V` for fast.
        """
        stiffness = self.bulk_modulus * self.piston_area / self.volume
        return -stiffness * 1j * frequency / (1j * frequency + 1 / self.time_constant)


def port_conductance(
    motor: Motor, fluid: AbstractFluid, mean_flow: Q[Float[Array, ""], "m3/s"]
) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
    """`Cf = -dQ/dP` of one fully open supply port at the drop that passes the mean flow.

    With the smooth law `Q = K x/(x^2 + p^2)^(1/4)` both the drop and the slope
    are closed forms.
    """
    port = motor.valve_plate.supply
    gain = motor.orifice_of(port).gain(motor.valve_plate.area_of(port), fluid)
    transition = fluid.transition_pressure
    # notation: x^2 solves x^4 = (Q/K)^4 (x^2 + p^2)
    fourth = (mean_flow / gain) ** 4
    squared = (fourth + jnp.sqrt(fourth**2 + 4 * fourth * transition**2)) / 2
    total = squared + transition**2
    return gain * (squared / 2 + transition**2) / (total * jnp.sqrt(jnp.sqrt(total)))


def linear_chamber(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    mean_volume: Q[Float[Array, ""], "m3"],
    mean_flow: Q[Float[Array, ""], "m3/s"],
) -> LinearChamber:
    """The chamber linearised about mean volume and the mean flow of an open port."""
    middle = (point.supply_pressure + point.return_pressure) / 2
    leakage = motor.leakage_conductance(fluid, middle, point.case_pressure)
    return LinearChamber(
        volume=mean_volume,
        piston_area=motor.piston.area,
        bulk_modulus=fluid.bulk_modulus_at(middle),
        conductance=port_conductance(motor, fluid, mean_flow) + leakage,
    )


def torque_harmonics(
    force: Complex[Array, " order"], lift: Complex[Array, " order"], step: int = 1
) -> Complex[Array, " order"]:
    """Harmonics of `F ds/dtheta` from two-sided harmonics of force and lift.

    A product in angle is a convolution in order: `tau_n = sum_m F_(n-m) i m s_m`,
    so no single transfer function from lift to torque exists. Both arrays run
    from order -N to N in multiples of `step`; orders beyond N count as zero.
    """
    highest = (lift.shape[-1] - 1) // 2
    slope = 1j * step * jnp.arange(-highest, highest + 1) * lift
    return jnp.convolve(force, slope, mode="full")[highest : 3 * highest + 1]
