"""The piston and the roller it carries."""

from math import pi

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.material import Material
from camring.numerics.quantity import Q, real


class ReturnSpring(eqx.Module):
    """A spring behind the piston that presses it on the cam, the less the further it is out.

    `preload - rate (s - min s)`; it gives back what it takes, so that no loss comes of it.
    docs/theory.md section 14. Holds while the spring presses at the outer dead centre as well.

    Examples
    --------
    >>> spring = camring.ReturnSpring(rate=4e3, preload=120.0)  # N/m, N
    >>> float(spring.force(0.012))  # N, 12 mm above the lowest place
    72.0
    """

    rate: Q[Float[Array, ""], "N/m"] = eqx.field(converter=real)
    preload: Q[Float[Array, ""], "N"] = eqx.field(converter=real)
    """Force at the inner dead centre, where it is pressed together most."""

    def force(self, above_lowest: Q[Float[Array, "*grid"], "m"]) -> Q[Float[Array, "*grid"], "N"]:
        """Outwards, at lifts above the lowest."""
        return self.preload - self.rate * above_lowest


class Piston(eqx.Module):
    """A radial piston; its mass includes the roller.

    Examples
    --------
    >>> round(float(camring.Piston(bore=0.036, mass=0.5).area) * 1e6, 1)  # mm2
    1017.9
    """

    bore: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    mass: Q[Float[Array, ""], "kg"] = eqx.field(converter=real)
    spring: ReturnSpring | None = None
    """None where pressure and inertia alone hold the roller on the cam."""

    @property
    def area(self) -> Q[Float[Array, ""], "m2"]:
        return pi * self.bore**2 / 4


class Roller(eqx.Module):
    """The cylinder that rolls on the inside of the cam ring.

    Examples
    --------
    >>> steel = camring.Material(elastic_modulus=210e9, poisson_ratio=0.3)
    >>> float(camring.Roller(radius=0.016, length=0.036, material=steel).length)
    0.036
    """

    radius: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    length: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    material: Material
