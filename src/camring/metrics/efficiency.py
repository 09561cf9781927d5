"""What a test bench reads of power: efficiencies, and what the machine works as.

A bench knows torque, speed, pressures and flow, nothing of the oil: its hydraulic power
is pressure difference times supply flow (ISO 4409). The exact balance of the model takes
the oil's energy in its place, which with a compressible oil is a little more.
"""

from math import pi
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.metrics.power_balance import PowerBalance
from camring.numerics.quantity import ArrayLike, Q

MOTOR, PUMP, BRAKE = "motor", "pump", "brake"


class Efficiencies(NamedTuple):
    """Ratios of what comes out to what goes in, whichever way power flows."""

    total: Q[Float[Array, "*batch"], "1"]
    """The product of the next two; as ISO 4409 has it."""
    volumetric: Q[Float[Array, "*batch"], "1"]
    hydromechanical: Q[Float[Array, "*batch"], "1"]
    energy: Q[Float[Array, "*batch"], "1"]
    """Output over input of the exact power balance."""
    ports: Q[Float[Array, "*batch"], "1"]
    """The same by the power between the ports, in which drained oil gives nothing back."""


def efficiencies(
    power: PowerBalance,
    mean_torque: Q[Float[Array, "*batch"], "N.m"],
    pressure_drop: Q[Float[Array, "*batch"], "Pa"],
    displacement: Q[Float[Array, "*batch"], "m3"],
    shaft_speed: Q[Float[Array, "*batch"], "rad/s"],
) -> Efficiencies:
    """Efficiencies of a machine that is fed, or, where it feeds, those of a pump.

    Where the hydraulic input is negative each ratio is inverted: oil's power over the
    shaft's. A brake, which takes power at both ends, keeps a motor's ratios; torque makes
    them negative. The first four take the sign of the flow that comes in, the last that of
    the power between the ports: a machine whose intake all goes to the case feeds nothing.

    Notes
    -----
    `total = mean torque * speed / (pressure drop * supply flow)`, docs/theory.md sections 6
    and 14. Without sense where no flow passes or no torque turns the shaft.
    """
    feeds = power.input_power < 0
    gives = power.port_power < 0
    swept, flow = displacement * shaft_speed / (2 * pi), jnp.abs(power.supply_flow)
    ideal = jnp.abs(pressure_drop) * displacement / (2 * pi)
    torque = jnp.where(feeds, -mean_torque, mean_torque)

    def ratio(
        above: Float[Array, "*batch"], below: Float[Array, "*batch"]
    ) -> Q[Float[Array, "*batch"], "1"]:
        return jnp.where(feeds, below, above) / jnp.where(feeds, above, below)

    volumetric, hydromechanical = ratio(swept, flow), ratio(torque, ideal)
    return Efficiencies(
        total=volumetric * hydromechanical,
        volumetric=volumetric,
        hydromechanical=hydromechanical,
        energy=ratio(power.output_power, power.input_power),
        ports=jnp.where(gives, power.port_power, power.output_power)
        / jnp.where(gives, power.output_power, power.port_power),
    )


def working_as(input_power: ArrayLike, output_power: ArrayLike) -> np.ndarray:
    """`MOTOR`, `PUMP` (gives oil) or `BRAKE` (takes both powers), a word for each pair."""
    feeds, driven = np.asarray(input_power) < 0, np.asarray(output_power) < 0
    return np.where(feeds, PUMP, np.where(driven, BRAKE, MOTOR))
