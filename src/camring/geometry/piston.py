"""The piston and the roller it carries."""

from math import pi

import equinox as eqx
from jaxtyping import Array, Float

from camring.geometry.material import Material
from camring.numerics.quantity import Q, real


class Piston(eqx.Module):
    """A radial piston; its mass includes the roller."""

    bore: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    mass: Q[Float[Array, ""], "kg"] = eqx.field(converter=real)

    @property
    def area(self) -> Q[Float[Array, ""], "m2"]:
        return pi * self.bore**2 / 4


class Roller(eqx.Module):
    """The cylinder that rolls on the inside of the cam ring."""

    radius: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    length: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    material: Material
