"""One motor at one operating point: pressure, and how warm its films and its case become."""

import jax
import jax.numpy as jnp
from jax.lax import stop_gradient
from jaxtyping import Array, Float

from camring.physics.cycle import Cycle, nearby_cycle, periodic_cycle
from camring.physics.heat.balance import (
    missed,
    rise_of,
    settled_rise,
    with_rise,
    with_verdict,
)
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.piston_state import quadrature_samples
from camring.physics.resolution import Resolution

MESHES = 2
"""Times the mesh is laid: its nodes stand where the pressure meets a kink of a law, which the
warmth moves by a little."""
PASSES = 2
"""Times rise and pressure are brought up to date in turn on each: either hardly knows of the
other."""


def simulate(
    motor: Motor,
    fluid: AbstractFluid,
    point: OperatingPoint,
    resolution: Resolution | None = None,
    filled: Float[Array, ""] | None = None,
) -> Cycle:
    """The periodic cycle of a motor at an operating point.

    Traceable, differentiable, and batched with `vmap`. Faults are in
    `cycle.verdict`; nothing is raised. Where the motor has a heat balance, the rise that
    closes it is in `cycle.motor.thermal.rise`.

    Parameters
    ----------
    filled
        In place of the resolution's, as a number that may be traced: one program for both.
    """
    if motor.thermal is None:
        return periodic_cycle(motor, fluid, point, resolution, filled)
    frozen = jax.tree.map(stop_gradient, (motor, fluid, point))

    def up_to_date(cycle: Cycle, _: None) -> tuple[Cycle, None]:
        warm = with_rise(cycle.motor, settled_rise(cycle, quadrature_samples))
        return nearby_cycle(cycle, warm, cycle.fluid, cycle.point), None

    def on_a_mesh(rise: Array, _: None) -> tuple[Array, Cycle]:
        motor, fluid, point = frozen
        found = periodic_cycle(with_rise(motor, rise), fluid, point, resolution, filled)
        found, _ = jax.lax.scan(up_to_date, found, None, PASSES)
        return rise_of(found), found

    start = stop_gradient(motor.thermal.rise)
    _, found = jax.lax.scan(on_a_mesh, start, None, MESHES)
    last = jax.tree.map(lambda leaf: leaf[-1], found)
    return neighbour(last, motor, fluid, point)


def neighbour(cycle: Cycle, motor: Motor, fluid: AbstractFluid, point: OperatingPoint) -> Cycle:
    """The cycle of a motor very near to that of a cycle at hand, by one Newton step from it.

    At the cycle's own motor it is that cycle, with all its derivatives: the way to
    gradients that do not pay for solving once more. The rise takes a step of its own, whose
    slope is that of pressure and rise together (implicit function theorem).
    """
    if motor.thermal is None:
        return nearby_cycle(cycle, motor, fluid, point)
    known = stop_gradient(rise_of(cycle))
    given = motor, fluid, point

    def left(given: tuple[Motor, AbstractFluid, OperatingPoint], rise: Array) -> Array:
        motor, fluid, point = given
        return missed(nearby_cycle(cycle, with_rise(motor, rise), fluid, point), quadrature_samples)

    _, slope = jax.jvp(
        lambda rise: left(jax.tree.map(stop_gradient, given), rise),
        (known,),
        (jnp.ones_like(known),),
    )
    over = left(given, known)
    rise = known - over / stop_gradient(slope)
    return with_verdict(nearby_cycle(cycle, with_rise(motor, rise), fluid, point), over)
