"""The motor: its hardware and the laws that hold in it."""

from math import gcd, lcm
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import AbstractCam
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.valve_plate import ValvePlate
from camring.numerics.mesh import LAYER_ELEMENTS, Breakpoints
from camring.numerics.quantity import Q, real
from camring.physics.fluid import AbstractFluid
from camring.physics.friction import AbstractFriction
from camring.physics.gallery import Manifold
from camring.physics.gap import PistonGap
from camring.physics.leakage import AbstractLeakage
from camring.physics.orifice import AbstractOrifice

SAME_ANGLE = 1e-9
"""Breakpoints nearer than this, in rad, count as one."""


class Motor(eqx.Module):
    """A radial-piston motor: `pistons` in a block that turns inside a ring of `lobes`.

    Housing, ring and valve plate stand still (model.md section 1). Every number
    is an array leaf, so a batch of motors is a `Motor` whose leaves have a
    leading axis; the counts are static.
    """

    cam: AbstractCam
    piston: Piston
    roller: Roller
    ring_material: Material
    valve_plate: ValvePlate
    dead_volume: Q[Float[Array, ""], "m3"] = eqx.field(converter=real)
    orifice: AbstractOrifice
    leakage: AbstractLeakage
    friction: AbstractFriction
    gap: PistonGap | None = None
    manifold: Manifold | None = None
    """None where the supply windows see the set pressure itself."""
    given_reference_radius: Q[Float[Array, ""], "m"] = eqx.field(
        converter=real, default=float("nan")
    )
    reference: Literal["minimum", "mean", "given"] = eqx.field(static=True, default="minimum")
    pistons: int = eqx.field(static=True, kw_only=True)
    lobes: int = eqx.field(static=True, kw_only=True)
    name: str = eqx.field(static=True, default="", kw_only=True)
    from_behind: bool = eqx.field(static=True, default=False, kw_only=True)
    """Seen from the other end of the shaft, its ports exchanged; see `rotation.turned`."""

    @property
    def distinct_phases(self) -> int:
        """Different places in a cam period at which pistons stand at one instant.

        `Np / gcd(Np, NL)` when all lobes are alike, every piston's own on a free ring.
        """
        return self.pistons // gcd(self.pistons, self.cam.repeats)

    @property
    def surviving_order(self) -> int:
        """Torque of identical lobes and pistons holds multiples of this order only.

        For a ring without lobe symmetry it is the number of pistons.
        """
        return lcm(self.pistons, self.cam.repeats)

    def leakage_conductance(self, fluid: AbstractFluid) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
        """Volume flow past one piston for each pascal between chamber and case."""
        coefficient = self.leakage.conductance(self.piston, fluid)
        if self.gap is None:
            return coefficient
        return coefficient + self.gap.leakage_conductance(self.piston, fluid)

    def viscous_damping(self, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """Force against one piston's motion for each metre a second."""
        coefficient = self.friction.viscous_damping(self.piston, fluid)
        if self.gap is None:
            return coefficient
        return coefficient + self.gap.film_damping(self.piston, fluid)

    def breakpoints(self) -> Breakpoints:
        """Angles in one cam period where cam or openings are not smooth.

        The window edges are the sharp ones: a kink of the opening is a kink of
        the pressure's rate, a knot of the cam only one of its second derivative.
        """
        knots = self.cam.breakpoints()
        edges = self.valve_plate.breakpoints()
        turns = self.valve_plate.pitch * jnp.arange(self.lobes // self.cam.repeats)
        around = (edges + turns[:, None]).reshape(-1)
        angle = jnp.concatenate([knots, around]) % self.cam.period
        sharp = np.concatenate([np.zeros(knots.shape, bool), np.ones(around.shape, bool)])
        # An edge on a knot goes last, so that the element behind both knows it is sharp.
        order = jnp.lexsort((jnp.asarray(sharp), jnp.round(angle / SAME_ANGLE)))
        ascending = jax.lax.associative_scan(jnp.maximum, angle[order])
        return Breakpoints(ascending, jnp.asarray(sharp)[order])

    def promised_elements(self) -> int:
        """Mesh elements that the breakpoints of one cam period take for themselves."""
        edges = self.valve_plate.edge_count * (self.lobes // self.cam.repeats)
        return self.cam.control_count + (1 + LAYER_ELEMENTS) * edges
