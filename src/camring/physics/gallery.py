"""The gallery before the supply windows, as a part of the motor."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real


class Manifold(eqx.Module):
    """A volume of oil common to all supply windows, fed through a line.

    model.md section 13; `manifold.py` has the equations.
    """

    volume: Q[Float[Array, ""], "m3"] = eqx.field(converter=real)
    line_conductance: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)
    """Volume flow through the line for each pascal between its ends; the line is laminar."""
