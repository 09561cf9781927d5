"""Valve timing in an engineer's terms: what happens how far from which dead centre."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.numerics.selection import largest, smallest
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint

_SAMPLES = 4096


class Timing(eqx.Module):
    """Angles from a dead centre, positive after it; of the first lobe pitch.

    The gap is the angle in which a chamber sees neither port, negative where
    both are open and short-circuit. The needed angle is that in which the piston
    alone, sealed in, brings the oil from one port's pressure to the other's;
    infinite when its stroke does not suffice.
    """

    inner_dead_centre: Q[Float[Array, ""], "rad"]
    outer_dead_centre: Q[Float[Array, ""], "rad"]
    return_closes: Q[Float[Array, ""], "rad"]
    supply_opens: Q[Float[Array, ""], "rad"]
    supply_closes: Q[Float[Array, ""], "rad"]
    return_opens: Q[Float[Array, ""], "rad"]
    compression_needed: Q[Float[Array, ""], "rad"]
    expansion_needed: Q[Float[Array, ""], "rad"]

    @property
    def inner_gap(self) -> Q[Float[Array, ""], "rad"]:
        """Where pre-compression happens."""
        return self.supply_opens - self.return_closes

    @property
    def outer_gap(self) -> Q[Float[Array, ""], "rad"]:
        """Where pre-expansion happens."""
        return self.return_opens - self.supply_closes


def port_timing(motor: Motor, fluid: AbstractFluid, point: OperatingPoint) -> Timing:
    """Opening and closing of the ports about the dead centres of the first lobe pitch."""
    plate = motor.valve_plate
    pitch = plate.pitch
    angle = pitch * jnp.arange(_SAMPLES) / _SAMPLES
    radius = motor.cam.pitch_radius(angle).value
    inner, outer = angle[jnp.argmin(radius)], angle[jnp.argmax(radius)]
    supply, back = plate.supply, plate.return_

    def after(edge: Array, centre: Array) -> Array:
        distance = edge + plate.shift - centre
        return distance - pitch * jnp.round(distance / pitch)

    mean_pressure = (point.supply_pressure + point.return_pressure) / 2
    needed = point.pressure_drop / fluid.bulk_modulus_at(mean_pressure) / motor.piston.area

    def angle_before(place: Array, volume: Array) -> Array:
        # Radii in the half pitch before the dead centre, nearest first.
        back_from = jnp.roll(radius[::-1], jnp.argmin(jnp.abs(angle - place)) + 1)
        moved = jnp.abs(back_from - back_from[0])[: _SAMPLES // 2]
        enough = moved >= volume * needed
        found = jnp.argmax(enough) * (pitch / _SAMPLES)
        return jnp.where(jnp.any(enough), found, jnp.inf)

    stroke = largest(radius) - smallest(radius)
    return Timing(
        inner_dead_centre=inner,
        outer_dead_centre=outer,
        return_closes=after(back.centre + back.width / 2, inner),
        supply_opens=after(supply.centre - supply.width / 2, inner),
        supply_closes=after(supply.centre + supply.width / 2, outer),
        return_opens=after(back.centre - back.width / 2, outer),
        compression_needed=angle_before(inner, motor.dead_volume),
        expansion_needed=angle_before(outer, motor.dead_volume + motor.piston.area * stroke),
    )
