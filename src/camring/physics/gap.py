"""Gaps that leak: round a piston, with what its film holds back, and on the valve plate.

The plate's ports lie in a ring between two lands, half of it at supply and half at return
pressure. Oil leaves it through the film on both lands into the case, and from port to port
between them, past the chambers: what a chamber loses into the film belongs to its own leakage.
"""

from math import pi
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from camring.geometry.piston import Piston
from camring.geometry.valve_plate import Port, ValvePlate
from camring.numerics.quantity import Q, real
from camring.physics.leakage import LeakageEnds
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint


class PistonGap(eqx.Module):
    """A thin gap between piston and bore, filled with oil of one viscosity.

    Laminar flow between nearly parallel walls: clearance small against bore,
    the eccentricity that of parallel axes. Both effects come on top of the
    motor's coefficients. docs/theory.md section 13; Merritt (1967), section 2-4;
    Ivantysyn and Ivantysynova (2001), section 4.2.

    Examples
    --------
    >>> oil = camring.ConstantFluid(870.0, 1.4e9, 3e3, viscosity=46e-6)
    >>> gap, piston = camring.PistonGap(clearance=15e-6, length=0.04), camring.Piston(0.036, 0.5)
    >>> f"{float(gap.leakage_conductance(piston, oil)):.3g} m3/(s Pa)"
    '1.99e-14 m3/(s Pa)'
    >>> f"{float(gap.film_damping(piston, oil)):.3g} N s/m"
    '12.1 N s/m'
    """

    clearance: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    """Radial: half the difference of the diameters."""
    length: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    eccentricity: Q[Float[Array, ""], "1"] = eqx.field(converter=real, default=0.0)
    """Displacement of the axes over the clearance, in [0, 1]."""

    def leakage_conductance(
        self, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, ""], "m3/(s.Pa)"]:
        """`pi d c^3 (1 + 1.5 e^2) / (12 mu L)`: volume flow along the gap for each pascal."""
        height = self.clearance**3 * (1 + 1.5 * self.eccentricity**2)
        return pi * piston.bore * height / (12 * _dynamic_viscosity(fluid) * self.length)

    def leakage_flow(
        self, ends: LeakageEnds, piston: Piston, fluid: AbstractFluid
    ) -> Q[Float[Array, "*grid"], "m3/s"]:
        """Volume flow along the gap, out of the chamber."""
        return self.leakage_conductance(piston, fluid) * ends.drop

    def film_damping(self, piston: Piston, fluid: AbstractFluid) -> Q[Float[Array, ""], "N.s/m"]:
        """`mu pi d L / c`: shear force of the film for each metre a second, axes in line."""
        return _dynamic_viscosity(fluid) * pi * piston.bore * self.length / self.clearance


def _dynamic_viscosity(fluid: AbstractFluid) -> Q[Float[Array, ""], "Pa.s"]:
    return fluid.density * fluid.viscosity


class PlateFlows(NamedTuple):
    """Amounts a second, signed as the pressures are."""

    supply_to_case: Float[Array, "*batch"]
    return_to_case: Float[Array, "*batch"]
    supply_to_return: Float[Array, "*batch"]


class PlateGap(eqx.Module):
    """A plane film of even thickness over an inner and an outer land.

    `Q = pi h^3 dp / (12 mu) (1/ln(r2/r1) + 1/ln(r4/r3))` from each half of the port ring into the
    case, radial flow in a slit (Ivantysyn and Ivantysynova 2001, section 4.3), and
    `Q = 2 NL h^3 (r3 - r2) dp / (12 mu r_m psi)` from port to port, `psi` the angle between
    neighbouring slots. An idle lobe's supply slot counts as one of the return's. Constant in
    time: the film's own squeeze and tilt are left out, and so is its drag. docs/theory.md
    section 14.

    Examples
    --------
    >>> gap = camring.PlateGap(thickness=12e-6, land_radii=[0.040, 0.048, 0.062, 0.070])  # m
    >>> float(gap.thickness), gap.land_radii.shape
    (1.2e-05, (4,))
    """

    thickness: Q[Float[Array, ""], "m"] = eqx.field(converter=real)
    land_radii: Q[Float[Array, "4 *batch"], "m"] = eqx.field(converter=real)
    """Inner and outer edge of the inner land, then of the outer one."""

    def flows(self, plate: ValvePlate, fluid: AbstractFluid, point: OperatingPoint) -> PlateFlows:
        """Through the whole plate."""
        mobility = self.thickness**3 / (12 * fluid.density * fluid.viscosity)
        to_case, between = self._shapes(plate)
        fed = 1 - len(plate.idle_lobes) / plate.lobes
        from_supply, from_return, between = fed * to_case, (2 - fed) * to_case, fed * between
        supply, back, case = (
            (pressure, fluid.content(pressure))
            for pressure in (point.supply_pressure, point.return_pressure, point.case_pressure)
        )

        def amount(shape: Array, start: tuple[Array, Array], end: tuple[Array, Array]) -> Array:
            return (start[1] + end[1]) / 2 * mobility * shape * (start[0] - end[0])

        return PlateFlows(
            amount(from_supply, supply, case),
            amount(from_return, back, case),
            amount(between, supply, back),
        )

    def _shapes(self, plate: ValvePlate) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"]]:
        """Width over length of the paths into the case and from port to port."""
        inside, inner, outer, outside = (self.land_radii[k] for k in range(4))
        to_case = pi * (1 / jnp.log(inner / inside) + 1 / jnp.log(outside / outer))
        # A chamber is shut between windows that are so far apart, and as wide as its port is.
        land = plate.pitch / 2 - _slots_width(plate)
        between = 2 * plate.lobes * (outer - inner) / ((outer + inner) / 2 * land)
        return to_case, between


def _slots_width(plate: ValvePlate) -> Float[Array, "*batch"]:
    """Mean width of both kinds of slots: their windows without the port of a chamber."""
    supply, back = plate.supply, plate.return_
    if supply.ramp is None and back.ramp is None:
        return (supply.width + back.width) / 2 * (1 - _ramp(plate, supply) / 2)
    slots = [port.width * (1 - _ramp(plate, port) / 2) for port in (supply, back)]
    return (slots[0] + slots[1]) / 2


def _ramp(plate: ValvePlate, port: Port) -> Float[Array, "*batch"] | float:
    """Share of half a window in which it opens: the port of a chamber over half its window."""
    return getattr(plate.window_of(port), "ramp", 0.0)
