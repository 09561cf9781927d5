"""An elastic material, and how two of them share a contact."""

import equinox as eqx
from jaxtyping import Array, Float

from camring.numerics.quantity import Q, real


class Material(eqx.Module):
    """A linear elastic, isotropic material.

    Examples
    --------
    >>> camring.Material(elastic_modulus=210e9, poisson_ratio=0.3)
    Material(elastic_modulus=f64[], poisson_ratio=f64[])
    """

    elastic_modulus: Q[Float[Array, ""], "Pa"] = eqx.field(converter=real)
    poisson_ratio: Q[Float[Array, ""], "1"] = eqx.field(converter=real)


def contact_modulus(one: Material, other: Material) -> Q[Float[Array, ""], "Pa"]:
    """Effective modulus E' of two bodies in contact: 1/E' = sum of (1 - nu^2)/E.

    docs/theory.md section 4; Johnson (1985), eq. 4.2.
    """
    compliance = (1 - one.poisson_ratio**2) / one.elastic_modulus + (
        1 - other.poisson_ratio**2
    ) / other.elastic_modulus
    return 1 / compliance
