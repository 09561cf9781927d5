"""A manifold between a port's line and its windows, as a part of the motor."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real


class Manifold(eqx.Module):
    """A volume of oil common to all supply or all return windows, and its line to the port.

    docs/theory.md section 13; `coupling.py` has the equations. A motor with one is solved with
    all its pistons at once, and its batches go one by one.

    Examples
    --------
    >>> manifold = camring.Manifold(volume=2e-4, line_conductance=1e-9)  # m3, m3/(s Pa)
    >>> float(manifold.volume)
    0.0002
    """

    volume: Q[Float[Array, ""], "m3"] = eqx.field(converter=real)
    line_conductance: Q[Float[Array, ""], "m3/(s.Pa)"] = eqx.field(converter=real)
    """Volume flow through the line for each pascal between its ends; the line is laminar."""
