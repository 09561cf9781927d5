"""The chamber's pressure equation, one for every fluid and orifice law.

Amount of oil in a chamber changes by what the two ports bring and leakage
takes, and by the chamber's own volume (docs/theory.md sections 3 and 13):

    content'(P) V w dP/dtheta = m_supply + m_return - m_leak - content(P) Ap w s'
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.valve_plate import Port
from camring.numerics.quantity import Q
from camring.numerics.smooth import inverse
from camring.physics.chamber import Chamber
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid, OilAt
from camring.physics.operating_point import OperatingPoint


class PortFlows(NamedTuple):
    """Amounts a second into the chamber from each port, and out of it past the piston."""

    supply: Float[Array, "*grid"]
    return_: Float[Array, "*grid"]
    leakage: Float[Array, "*grid"]


def port_flows(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    chamber: Chamber,
    pressure: Q[Float[Array, "*grid"], "Pa"],
) -> PortFlows:
    """Signed flows at a chamber pressure, in the fluid's amounts a second."""
    return _flows(motor, fluid, point, chamber, pressure, fluid.at(pressure))


def _flows(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    chamber: Chamber,
    pressure: Q[Float[Array, "*grid"], "Pa"],
    here: OilAt,
) -> PortFlows:
    plate = motor.valve_plate

    def through(
        port: Port, area: Q[Float[Array, "*grid"], "m2"], port_pressure: Q[Float[Array, ""], "Pa"]
    ) -> Float[Array, "*grid"]:
        there = fluid.at(port_pressure)
        density = (here.density + there.density) / 2
        flow = motor.orifice_of(port)(area, port_pressure - pressure, density, fluid)
        return (here.content + there.content) / 2 * flow

    back = through(plate.return_, chamber.return_area, point.return_pressure)
    if chamber.idle_area is not None:
        back = back + through(plate.supply, chamber.idle_area, point.return_pressure)
    in_case = fluid.at(point.case_pressure).content
    leakage = motor.leakage_flow(fluid, pressure, point.case_pressure)
    return PortFlows(
        through(plate.supply, chamber.supply_area, point.supply_pressure),
        back,
        (here.content + in_case) / 2 * leakage,
    )


def pressure_slope(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    chamber: Chamber,
    pressure: Q[Float[Array, "*grid"], "Pa"],
) -> Q[Float[Array, "*grid"], "Pa/rad"]:
    """dP/dtheta of a chamber, docs/theory.md sections 3 and 13."""
    here = fluid.at(pressure)
    flows = _flows(motor, fluid, point, chamber, pressure, here)
    net = (flows.supply + flows.return_ - flows.leakage) / point.shaft_speed
    capacity = here.content_slope * chamber.volume
    return (net - here.content * chamber.volume_slope) * inverse(capacity)


def state_rate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    chamber: Chamber,
    state: Float[Array, "*grid"],
) -> Float[Array, "*grid"]:
    """The same in the state that the fluid is solved in, 1/rad."""
    pressure = fluid.pressure(state)
    slope = pressure_slope(motor, fluid, point, chamber, pressure)
    return fluid.state_slope(pressure) * slope


def exchange_rate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    chamber: Chamber,
    pressure: Q[Float[Array, "*grid"], "Pa"],
) -> Q[Float[Array, "*grid"], "1/rad"]:
    """Rate at which flows carry away a small excess of oil.

    Its integral over a period is minus the logarithm of the Floquet multiplier,
    free of the chamber's own compression, which cancels over a period.
    """

    def net(at: Q[Float[Array, "*grid"], "Pa"]) -> Float[Array, "*grid"]:
        flows = port_flows(motor, fluid, point, chamber, at)
        return flows.supply + flows.return_ - flows.leakage

    _, slope = jax.jvp(net, (pressure,), (jnp.ones_like(pressure),))
    capacity = fluid.at(pressure).content_slope * chamber.volume
    return -slope / (capacity * point.shaft_speed)


def kinks(
    motor: Motor, fluid: AbstractFluid, *port_pressures: Q[Float[Array, ""], "Pa"]
) -> tuple[Float[Array, ""], ...]:
    """States at which a law bends: the fluid's own, and those of ports where the orifice does."""
    ports = port_pressures if motor.orifice.bends_at_zero else ()
    return tuple(fluid.state(pressure) for pressure in (*fluid.kinks(), *ports))
