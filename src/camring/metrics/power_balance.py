"""Where the hydraulic power goes: shaft, and four losses.

Each loss is the number of pistons times a mean over a period (model.md
sections 6 and 13). The balance closes to solver accuracy; what is left over
is reported, not hidden.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.metrics.spectrum import QuadratureSamples
from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.manifold import line_flow


class PowerBalance(eqx.Module):
    """Powers of the whole motor, all in W, and the supply flow behind them."""

    supply_flow: Q[Float[Array, ""], "m3/s"]
    input_power: Q[Float[Array, ""], "W"]
    output_power: Q[Float[Array, ""], "W"]
    line_loss: Q[Float[Array, ""], "W"]
    """In the line to the manifold; zero without one."""
    throttling_loss: Q[Float[Array, ""], "W"]
    leakage_loss: Q[Float[Array, ""], "W"]
    friction_loss: Q[Float[Array, ""], "W"]
    compression_loss: Q[Float[Array, ""], "W"]

    @property
    def residual(self) -> Q[Float[Array, ""], "1"]:
        """What the books do not explain, as a share of the input."""
        explained = (
            self.output_power
            + self.line_loss
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
    at_window = fluid.potential(piston.supply_pressure)
    at_return = fluid.potential(point.return_pressure)
    speed = point.shaft_speed
    damping = motor.viscous_damping(fluid)

    def of_all(power: Float[Array, "point element"]) -> Float[Array, ""]:
        return motor.pistons * samples.mean(power)

    amount_flow = of_all(piston.supply_flow)
    return PowerBalance(
        supply_flow=amount_flow / fluid.content(point.supply_pressure),
        input_power=amount_flow * (at_source - at_return),
        output_power=speed * of_all(piston.torque),
        throttling_loss=of_all(
            piston.supply_flow * (at_window - potential)
            + piston.return_flow * (at_return - potential)
        ),
        line_loss=_line_loss(cycle, samples, at_source - at_window),
        leakage_loss=of_all(piston.leakage_flow * (potential - at_return)),
        friction_loss=of_all(
            damping * (speed * piston.radius.first) ** 2 + speed * piston.friction_torque
        ),
        compression_loss=of_all(
            fluid.compression_power(
                piston.chamber_pressure,
                point.return_pressure,
                piston.chamber.volume,
                speed * samples.pressure_slope,
            )
        ),
    )


def _line_loss(
    cycle: Cycle, samples: QuadratureSamples, potential_drop: Float[Array, "point element"]
) -> Q[Float[Array, ""], "W"]:
    if cycle.motor.manifold is None:
        return jnp.zeros(())
    gallery = samples.piston.supply_pressure
    through = line_flow(cycle.motor, cycle.fluid, cycle.point, gallery)
    return samples.mean(through * potential_drop)
