"""Where the hydraulic power goes: shaft, and four losses.

Each loss is the number of pistons times a mean over a period (docs/theory.md
sections 6 and 13). The balance closes to solver accuracy; what is left over
is reported, not hidden.

Input and leakage count the oil of the case as if it left with the return. Beside them stand
both as they are, that oil down to the case's own pressure: one number is added to either side,
so that the balance closes as before, and what leaks never gains (section 14).
"""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.manifold.coupling import line_flow
from camring.physics.manifold.sides import RETURN, SUPPLY, Side
from camring.physics.piston_state import QuadratureSamples


class PowerBalance(eqx.Module):
    """Powers of the whole motor, all in W, and the mean flows behind them."""

    supply_flow: Q[Float[Array, ""], "m3/s"]
    """Into the motor, as a volume at supply pressure."""
    return_flow: Q[Float[Array, ""], "m3/s"]
    """Out of its return port, as a volume at return pressure."""
    case_drain: Q[Float[Array, ""], "m3/s"]
    """Out of its case, as a volume at case pressure."""
    input_power: Q[Float[Array, ""], "W"]
    output_power: Q[Float[Array, ""], "W"]
    line_loss: Q[Float[Array, ""], "W"]
    """In the line to the supply manifold; zero without one."""
    return_line_loss: Q[Float[Array, ""], "W"]
    """In the line from the return manifold; zero without one."""
    throttling_loss: Q[Float[Array, ""], "W"]
    leakage_loss: Q[Float[Array, ""], "W"]
    friction_loss: Q[Float[Array, ""], "W"]
    compression_loss: Q[Float[Array, ""], "W"]
    port_power: Q[Float[Array, ""], "W"]
    """What the oil gives between the two ports, counted from the case's pressure; negative where
    it takes."""
    full_leakage_loss: Q[Float[Array, ""], "W"]
    """What all leaking oil loses from where it leaves to where it arrives; never negative."""
    case_heat: Q[Float[Array, ""], "W"]
    """What of friction and leakage stays in the motor, with the oil of its case."""

    @property
    def residual(self) -> Q[Float[Array, ""], "1"]:
        """What the books do not explain, as a share of the input."""
        explained = (
            self.output_power
            + self.line_loss
            + self.return_line_loss
            + self.throttling_loss
            + self.leakage_loss
            + self.friction_loss
            + self.compression_loss
        )
        return (self.input_power - explained) / self.input_power


def power_balance(cycle: Cycle, samples: QuadratureSamples) -> PowerBalance:
    """Input, output and losses of all pistons."""
    motor, fluid, point, piston = cycle.motor, cycle.fluid, cycle.point, samples.piston
    potential = fluid.potential(piston.chamber_pressure)
    at_source = fluid.potential(point.supply_pressure)
    at_return = fluid.potential(point.return_pressure)
    before = _in_manifold(cycle, samples, SUPPLY, at_source)
    behind = _in_manifold(cycle, samples, RETURN, at_return)
    speed = point.shaft_speed
    damping = motor.viscous_damping(fluid)

    def of_all(power: Float[Array, "point element"]) -> Float[Array, ""]:
        return motor.pistons * samples.mean(power)

    amount_flow, back = of_all(piston.supply_flow), -of_all(piston.return_flow)
    drained = of_all(piston.leakage_flow)
    leaking = of_all(piston.leakage_flow * (potential - at_return))
    rubbing = of_all(damping * (speed * piston.radius.first) ** 2 + speed * piston.friction_torque)
    # The case's oil still has its pressure when it leaves, and what passes from port to port
    # leaves with the return.
    left = leaking
    plate = motor.plate_flows(fluid, point)
    if plate is not None:
        past_plate = plate.supply_to_case + plate.supply_to_return
        amount_flow = amount_flow + past_plate
        leaking = leaking + past_plate * (at_source - at_return)
        left = leaking - plate.supply_to_return * (at_source - at_return)
        back = back + plate.supply_to_return - plate.return_to_case
        drained = drained + plate.supply_to_case + plate.return_to_case
    # All that the case drains, from the return's pressure down to its own.
    down_to_case = drained * (at_return - fluid.potential(point.case_pressure))
    input_power = amount_flow * (at_source - at_return)
    return PowerBalance(
        supply_flow=amount_flow / fluid.content(point.supply_pressure),
        return_flow=back / fluid.content(point.return_pressure),
        case_drain=drained / fluid.content(point.case_pressure),
        input_power=input_power,
        output_power=speed * of_all(piston.torque),
        throttling_loss=of_all(
            piston.supply_flow * (before.potential - potential)
            + piston.return_flow * (behind.potential - potential)
        ),
        line_loss=before.line_loss,
        return_line_loss=behind.line_loss,
        leakage_loss=leaking,
        friction_loss=rubbing,
        port_power=input_power + down_to_case,
        full_leakage_loss=leaking + down_to_case,
        case_heat=rubbing + left + down_to_case,
        compression_loss=of_all(
            fluid.compression_power(
                piston.chamber_pressure,
                point.return_pressure,
                piston.chamber.volume,
                speed * samples.pressure_slope,
            )
        ),
    )


class _InManifold(NamedTuple):
    potential: Float[Array, "*grid"]
    line_loss: Q[Float[Array, ""], "W"]


def _in_manifold(
    cycle: Cycle, samples: QuadratureSamples, side: Side, at_port: Float[Array, "*batch"]
) -> _InManifold:
    """The oil's potential at the windows of a side, and what its line takes."""
    manifold = side.of(cycle.motor)
    if manifold is None:
        return _InManifold(at_port, jnp.zeros(()))
    fluid, pressure = cycle.fluid, getattr(samples.piston, side.pressure)
    potential = fluid.potential(pressure)
    through = line_flow(manifold, fluid, side.set_pressure(cycle.point), pressure)
    return _InManifold(potential, samples.mean(through * (at_port - potential)))
