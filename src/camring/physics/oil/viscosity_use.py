"""Whether anything in a motor asks its oil how viscous it is."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.physics.chamber import Chamber
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.pressure import port_flows

__all__ = ["reads_viscosity"]


def reads_viscosity(motor: Motor, fluid: AbstractFluid, point: OperatingPoint) -> bool:
    """Whether flows of ports, plate and leakage, or film friction, change with the viscosity.

    Asked of the laws themselves, by following the viscosity through their traced
    formulas, so a law added later counts without being named here. Nothing is computed.
    """

    def losses(viscosity: Float[Array, ""]) -> tuple[Float[Array, ""], ...]:
        oil = eqx.tree_at(lambda each: each.viscosity, fluid, viscosity)
        half = motor.valve_plate.port_area / 2
        chamber = Chamber(half, half, motor.dead_volume, jnp.zeros(()))
        pressure = (point.supply_pressure + point.return_pressure) / 2
        flows = port_flows(motor, oil, point, chamber, pressure)
        found = (*flows, motor.viscous_damping(oil))
        return (*found, *(motor.plate_flows(oil, point) or ()))

    traced = jax.make_jaxpr(losses)(fluid.viscosity).jaxpr
    reached = {id(each) for each in traced.invars}
    for equation in traced.eqns:
        if any(id(each) in reached for each in equation.invars):
            reached.update(id(each) for each in equation.outvars)
    return any(id(each) in reached for each in traced.outvars)
