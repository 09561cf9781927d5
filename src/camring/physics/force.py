"""The radial force that presses a piston and its roller on the cam."""

from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.numerics.quantity import Q
from camring.numerics.spline import Jet


def radial_force(
    piston: Piston,
    pressure: Q[Float[Array, "*grid"], "Pa"],
    case_pressure: Q[Float[Array, ""], "Pa"],
    radius: Jet,
    shaft_speed: Q[Float[Array, ""], "rad/s"],
    viscous_damping: Q[Float[Array, ""], "N.s/m"],
    lowest_radius: Q[Float[Array, ""], "m"] | None = None,
) -> Q[Float[Array, "*grid"], "N"]:
    """`F = Ap (P - P_case) - mp w^2 s'' - cm w s'`, and a return spring's; negative: lift-off.

    `lowest_radius` is that from which a return spring's travel counts; without a spring it is
    not needed. docs/theory.md sections 4 and 14. The radial acceleration is along the bore: the
    centrifugal part of the turning block is left out, as in the derivation.
    """
    force = (
        piston.area * (pressure - case_pressure)
        - piston.mass * shaft_speed**2 * radius.second
        - viscous_damping * shaft_speed * radius.first
    )
    if piston.spring is None:
        return force
    assert lowest_radius is not None
    return force + piston.spring.force(radius.value - lowest_radius)
