"""What the pitch curve means for the roller: pressure angle, curvature, undercut."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.numerics.quantity import Q
from camring.numerics.spline import Jet


def pressure_angle(radius: Jet) -> Q[Float[Array, "*grid"], "rad"]:
    """Angle between the contact normal and the piston axis: tan(phi) = r'/r.

    docs/theory.md section 2.
    """
    return jnp.arctan2(radius.first, radius.value)


def pitch_curvature(radius: Jet) -> Q[Float[Array, "*grid"], "1/m"]:
    """Curvature of the pitch curve, positive where it bends round the shaft.

    `(r^2 + 2 r'^2 - r r'') / (r^2 + r'^2)^(3/2)`, docs/theory.md section 2.
    """
    squared_speed = radius.value**2 + radius.first**2
    bend = squared_speed + radius.first**2 - radius.value * radius.second
    return bend / (squared_speed * jnp.sqrt(squared_speed))


def undercut_factor(
    radius: Jet, roller_radius: Q[Float[Array, ""], "m"]
) -> Q[Float[Array, "*grid"], "1"]:
    """`1 + curvature * roller radius`: the ring's radius over the pitch curve's.

    Zero where the working surface, one roller radius outside the pitch curve,
    comes to a cusp; negative where the roller would have to cut into it.
    """
    return 1 + pitch_curvature(radius) * roller_radius
