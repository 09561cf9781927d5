"""Oil in the case that the turning block drags along."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real
from camring.physics.oil.fluid import AbstractFluid


class Churning(eqx.Module):
    """Torque of a block that turns in a case full of oil: `T = C rho w^2 R^5 / 2`.

    The form is that of a disc in a housing (Daily and Nece 1960), whose coefficient hardly
    changes with speed once the flow is turbulent: 0.003 to 0.01 for both faces of a smooth
    disc; pistons and rollers that stick out have many times that. docs/theory.md section 14.
    Nothing of it in a drained case.

    Examples
    --------
    >>> oil = camring.ConstantFluid(870.0, 1.4e9, 3e3)
    >>> churning = camring.Churning(moment_coefficient=0.05, radius=0.1)
    >>> round(float(churning.torque(oil, 100.0)), 3)  # N m, at 100 rad/s
    2.175
    """

    moment_coefficient: Q[Float[Array, ""], "1"] = eqx.field(converter=real)
    radius: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    """Of the block, pistons at their outermost included."""

    def torque(
        self, fluid: AbstractFluid, shaft_speed: Q[Float[Array, ""], "rad/s"]
    ) -> Q[Float[Array, ""], "N.m"]:
        """Against the rotation, of the whole block."""
        pressure = fluid.density * shaft_speed**2 / 2
        return self.moment_coefficient * pressure * self.radius**5
