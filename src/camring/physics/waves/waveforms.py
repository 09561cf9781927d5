"""Waveforms over shaft angle: one piston, and the torque of the whole shaft."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.physics.cycle import Cycle
from camring.physics.piston_state import sample_angles


class Waveforms(eqx.Module):
    """What a report shows over shaft angle: one piston, and the torque of the shaft."""

    angle: Q[Float[Array, " angle"], "rad"]
    lift: Q[Float[Array, " angle"], "m"]
    velocity: Q[Float[Array, " angle"], "m/s"]
    acceleration: Q[Float[Array, " angle"], "m/s2"]
    jerk: Q[Float[Array, " angle"], "m/s3"]
    volume: Q[Float[Array, " angle"], "m3"]
    chamber_pressure: Q[Float[Array, " angle"], "Pa"]
    manifold_pressure: Q[Float[Array, " angle"], "Pa"] | None
    """Before the supply windows; None without a manifold."""
    return_manifold_pressure: Q[Float[Array, " angle"], "Pa"] | None
    """Behind the return windows; None without a manifold there."""
    supply_flow: Q[Float[Array, " angle"], "m3/s"]
    return_flow: Q[Float[Array, " angle"], "m3/s"]
    leakage_flow: Q[Float[Array, " angle"], "m3/s"]
    contact_force: Q[Float[Array, " angle"], "N"]
    contact_stress: Q[Float[Array, " angle"], "Pa"]
    torque: Q[Float[Array, " angle"], "N.m"]


def shaft_torque(
    cycle: Cycle, angle: Q[Float[Array, " angle"], "rad"]
) -> Q[Float[Array, " angle"], "N.m"]:
    """Torque of all pistons together at shaft angles, piston 0 standing at the angle."""
    return sum_over_pistons(cycle, lambda at: sample_angles(cycle, at).torque, angle)


def sum_over_pistons(
    cycle: Cycle,
    waveform: Callable[[Float[Array, "*grid"]], Float[Array, "*grid"]],
    angle: Q[Float[Array, "*grid"], "rad"],
) -> Float[Array, "*grid"]:
    """A waveform of one piston added up over the pistons, equal ones counted once."""
    motor = cycle.motor
    phases = motor.distinct_phases
    shifts = motor.cam.period / phases * jnp.arange(phases)
    total = jnp.sum(waveform(angle[..., None] + shifts), axis=-1)
    return motor.pistons // phases * total


def waveforms(cycle: Cycle, angle: Q[Float[Array, " angle"], "rad"]) -> Waveforms:
    """Waveforms of the reference piston, flows as volumes at supply density.

    Parameters
    ----------
    angle
        Shaft rotation, rad, any range, of shape (angle,); the shaft's torque is over the same.

    Returns
    -------
    A tuple of arrays of that shape, SI: pressure, flows, forces, stress, motion, torque.

    Examples
    --------
    >>> import numpy as np
    >>> [cycle] = camring.simulate("motor.toml")
    >>> waves = camring.waveforms(cycle, np.linspace(0, np.pi / 3, 361))  # one lobe
    >>> waves.torque.shape, round(float(waves.chamber_pressure.max()) / 1e5, 1)  # bar
    ((361,), 249.1)
    """
    piston, speed = sample_angles(cycle, angle), cycle.point.shaft_speed
    per_amount = 1 / cycle.fluid.content(cycle.point.supply_pressure)
    return Waveforms(
        angle=angle,
        lift=piston.lift,
        velocity=speed * piston.radius.first,
        acceleration=speed**2 * piston.radius.second,
        jerk=speed**3 * piston.radius.third,
        volume=piston.chamber.volume,
        chamber_pressure=piston.chamber_pressure,
        manifold_pressure=piston.supply_pressure,
        return_manifold_pressure=piston.return_pressure,
        supply_flow=piston.supply_flow * per_amount,
        return_flow=piston.return_flow * per_amount,
        leakage_flow=piston.leakage_flow * per_amount,
        contact_force=piston.contact_force,
        contact_stress=piston.contact_stress,
        torque=shaft_torque(cycle, angle),
    )
