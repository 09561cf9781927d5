"""The motor: its hardware and the laws that hold in it."""

from math import gcd, lcm
from operator import attrgetter
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from camring.geometry.cam import AbstractCam
from camring.geometry.material import Material
from camring.geometry.piston import Piston, Roller
from camring.geometry.valve_plate import Port, ValvePlate
from camring.numerics.mesh import LAYER_ELEMENTS, Breakpoints
from camring.numerics.quantity import Q, real
from camring.numerics.readable import readable
from camring.physics.friction import AbstractFriction, SlidingContacts
from camring.physics.gap import PistonGap, PlateFlows, PlateGap
from camring.physics.heat.thermal import Thermal
from camring.physics.leakage import AbstractLeakage, LeakageEnds
from camring.physics.manifold.manifold import Manifold
from camring.physics.oil.churning import Churning
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint
from camring.physics.orifice import AbstractOrifice

SAME_ANGLE = 1e-9
"""Breakpoints nearer than this, in rad, count as one."""


class Motor(eqx.Module):
    """A radial-piston motor: `pistons` in a block that turns inside a ring of `lobes`.

    Housing, ring and valve plate stand still (docs/theory.md section 1). Every number
    is an array leaf, so a batch of motors is a `Motor` whose leaves have a
    leading axis; the counts are static.

    Examples
    --------
    >>> motor = camring.read_motor_file("motor.toml").system.motor
    >>> motor.pistons, motor.lobes, round(1e6 * float(motor.dead_volume), 6)  # cm3
    (8, 6, 5.0)
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
    return_manifold: Manifold | None = None
    """None where the return windows do."""
    plate_gap: PlateGap | None = None
    """None where no oil passes the valve plate beside the chambers."""
    thermal: Thermal | None = None
    """None where films and leakage have the viscosity of the oil that comes in."""
    churning: Churning | None = None
    """None where the block drags no oil along."""
    given_reference_radius: Q[Float[Array, ""], "m"] = eqx.field(
        converter=real, default=float("nan")
    )
    reference: Literal["minimum", "mean", "given"] = eqx.field(static=True, default="minimum")
    pistons: int = eqx.field(static=True, kw_only=True)
    lobes: int = eqx.field(static=True, kw_only=True)
    name: str = eqx.field(static=True, default="", kw_only=True)
    from_behind: bool = eqx.field(static=True, default=False, kw_only=True)
    """Seen from the other end of the shaft, its ports exchanged; see `rotation.turned`."""

    __repr__ = readable

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

    def orifice_of(self, port: Port) -> AbstractOrifice:
        """The law of flow through one kind of port, with its own coefficient if it has one."""
        own = port.discharge_coefficient
        if own is None:
            return self.orifice
        return eqx.tree_at(attrgetter("discharge_coefficient"), self.orifice, own)

    def film_oil(self, fluid: AbstractFluid) -> AbstractFluid:
        """The oil as it is in films and leakage paths."""
        return fluid if self.thermal is None else self.thermal.film_oil(fluid)

    def leakage_flow(
        self,
        fluid: AbstractFluid,
        chamber_pressure: Q[Float[Array, "*grid"], "Pa"],
        case_pressure: Q[Float[Array, ""], "Pa"],
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        """Volume flow past one piston, out of its chamber into the case."""
        ends, fluid = LeakageEnds(chamber_pressure, case_pressure), self.film_oil(fluid)
        flow = self.leakage.flow(ends, self.piston, fluid)
        if self.gap is None:
            return flow
        return flow + self.gap.leakage_flow(ends, self.piston, fluid)

    def leakage_conductance(
        self,
        fluid: AbstractFluid,
        chamber_pressure: Q[Float[Array, "*grid"], "Pa"],
        case_pressure: Q[Float[Array, ""], "Pa"],
    ) -> Q[Float[Array, "*grid"], "m3/(s.Pa)"]:
        """By how much the flow past one piston rises for each pascal more in its chamber."""

        def flow(pressure: Array) -> Array:
            return self.leakage_flow(fluid, pressure, case_pressure)

        pressure = jnp.asarray(chamber_pressure)
        return jax.jvp(flow, (pressure,), (jnp.ones_like(pressure),))[1]

    def viscous_damping(self, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """Force against one piston's motion for each metre a second."""
        fluid = self.film_oil(fluid)
        coefficient = self.friction.viscous_damping(self.piston, fluid)
        if self.gap is None:
            return coefficient
        return coefficient + self.gap.film_damping(self.piston, fluid)

    def contact_loss(
        self, contacts: SlidingContacts, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "N.m"]:
        """Torque that one piston loses in its contacts, with its share of what the block drags."""
        lost = self.friction.loss_torque(contacts, self.piston, self.film_oil(fluid))
        if self.churning is None:
            return lost
        return lost + self.churning.torque(fluid, contacts.shaft_speed) / self.pistons

    def plate_flows(self, fluid: AbstractFluid, point: OperatingPoint) -> PlateFlows | None:
        """Past the valve plate beside the chambers; None where nothing passes."""
        if self.plate_gap is None:
            return None
        return self.plate_gap.flows(self.valve_plate, self.film_oil(fluid), point)

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
