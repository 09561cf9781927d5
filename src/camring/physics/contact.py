"""Roller on ring: normal force and Hertz line contact."""

from math import pi

import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.contour import undercut_factor
from camring.geometry.material import Material, contact_modulus
from camring.geometry.piston import Roller
from camring.numerics.quantity import Q
from camring.numerics.selection import larger
from camring.numerics.spline import Jet


def normal_force(
    force: Q[Float[Array, "*grid"], "N"], radius: Jet
) -> Q[Float[Array, "*grid"], "N"]:
    """Contact force along the normal, `F / cos(phi)`. docs/theory.md section 4."""
    return force * jnp.sqrt(1 + (radius.first / radius.value) ** 2)


def hertz_stress(
    contact_force: Q[Float[Array, "*grid"], "N"],
    radius: Jet,
    roller: Roller,
    ring_material: Material,
) -> Q[Float[Array, "*grid"], "Pa"]:
    """Largest contact pressure of a roller on the inside of the ring.

    `sigma = sqrt(max(F_n, 0) E' / (pi Lc R'))`, `R' = Rf (1 + kappa Rf)`: the
    ring is concave, so it lies closer to the roller than a plane would
    (docs/theory.md section 4; Johnson 1985, eq. 4.45). Meaningless once the undercut
    factor is not positive; infinite there.
    """
    factor = undercut_factor(radius, roller.radius)
    relative_radius = roller.radius * factor
    pressing = larger(contact_force, 0)
    squared = (
        pressing
        * contact_modulus(roller.material, ring_material)
        / (pi * roller.length * jnp.where(factor > 0, relative_radius, 1))
    )
    # The square root's slope is infinite where the roller leaves the ring.
    root = jnp.sqrt(jnp.where(squared > 0, squared, 1))
    stress = jnp.where(squared > 0, root, 0)
    return jnp.where((factor <= 0) & (pressing > 0), jnp.inf, stress)
