"""The rules by which a motor is sketched from a catalogue's data, each with its reason.

Proportions are shares of the bore, so one rule serves 0.2 L and 30 L: contact stress,
gap friction and throttling of similar machines are alike at the same pressure. Where a
rule says "as the examples", it is read off the three example motors, whose numbers are
assumptions in the class of a machine and no maker's data.
"""

from math import pi

import numpy as np
from jaxtyping import Float

from camring.geometry.material import Material
from camring.geometry.piston import Piston
from camring.numerics.quantity import Q, real
from camring.physics.gap import PistonGap
from camring.physics.oil.aerated_fluid import AeratedFluid
from camring.physics.oil.presets import ZERO_CELSIUS, oil_data

# The ring and the rollers.
STEEL = Material(real(206e9), real(0.3))
ROLLER_RADIUS = 0.42  # bores; a roller of 0.84 bores lies in the piston's head with a rim
ROLLER_LENGTHS = (0.95, 1.1, 1.25)  # bores; the shortest that carries the load is the cheapest
# The wall of ring and housing outside the deepest place: see `geometry.ring_body`.
PISTON_LENGTH = 1.2  # bores from the roller's centre inwards; as much guide as bore, or it tilts
LEAST_WALL = 0.15  # bores of block between two bores at their inner ends; assumed

# Contact stress: case-hardened bearing steel lives long under 1.5 to 2 GPa of line contact
# (Johnson 1985, chapters 4 and 9; rolling bearings are rated about there). A sketch stays
# below the limit, because quieter cams than a sine bend more sharply.
STRESS_LIMIT = 1.9e9  # Pa, written as a constraint
STRESS_WANTED = 1.8e9  # Pa, of a sketch
STRESS_EASY = 1.55e9  # Pa, below which a larger ring wins nothing

# Side force is tan(phi) of the piston's; 30 to 35 degrees is the customary end for
# followers that slide in a bore (Norton, Cam Design and Manufacturing Handbook, ch. 7).
ANGLE_LIMIT = 35 * pi / 180
ANGLE_WANTED = 28 * pi / 180
ANGLE_EASY = 23 * pi / 180

UNDERCUT_LIMIT = 0.25  # written as a constraint; at 0 the ring comes to a cusp
UNDERCUT_WANTED = 0.4

# Ports: a share of the piston's area, wide enough that no more than 1 % of the pressure
# difference is lost across an open one at rated speed; the windows have no room for more.
PORT_SHARE = (0.1, 0.2)
PORT_DROP_WANTED = 0.01
PORT_DROP_LIMIT = 0.02

# Chambers: passages take about as much room as the stroke. As the examples (0.72 to 0.85).
DEAD_SHARE = 0.8  # of the swept volume
# A hollow piston 1.2 bores long, three quarters of it steel, and a solid roller.
MASS_PER_CUBED_BORE = 9500.0  # kg/m3

# What leaks and rubs. The gap of a piston is a fifth above the middle of the fit H7/g6
# (ISO 286-2), whose tolerances grow with the cube root of the diameter; its film drags.
CLEARANCE_PER_CUBE_ROOT = 4.6e-5  # m of radial clearance for each cube root of a metre of bore
GUIDED_LENGTH = 1.05  # bores of gap
ECCENTRICITY = 0.5  # clearances; a piston is pressed to one side, but tilts and turns
# Of the valve plate alone, as the examples (1.3 to 1.4e-10); assumed, as catalogues give only
# the whole. A slow motor is made tighter: no more than a twentieth of the flow leaks at the
# second operating point, though never less than a fifth of the rule.
VALVE_LEAKAGE_PER_AREA = 1.3e-10  # m/(s Pa) of piston area
LEAST_VALVE_LEAKAGE_PER_AREA = VALVE_LEAKAGE_PER_AREA / 5
LEAK_SHARE = 0.05
# A Staffa HMC125's catalogue row is fitted by 0.0075 and 0.019 (tests/published/test_catalogues);
# 0.009 brings hydromechanical efficiency to the 0.938 to 0.948 of that catalogue.
ROLLER_FRICTION = 0.009
SIDE_FRICTION = 0.019

# Both directions of rotation alike: windows stand symmetric about the dead centres, shut
# for three fifths of what full pre-compression takes. As the examples (0.58 to 0.63).
# Less where so much leaks away meanwhile, at the slowest speed, that rollers would lift off.
SHUT_SHARE = 0.6
SLOW = 0.2  # of rated speed: the second operating point
SLOWEST = 0.1  # of rated speed: the lower end of the envelope
LOWEST = 0.2  # of rated pressure: likewise ...
LEAST_DROP = 20e5  # Pa, ... and so much above the return port's at least
LEAK_SPARE = 1e5  # Pa above the case that are left then
RAMP = 0.3

# Return pressure keeps the rollers on the ring on their way in, with this to spare. Makers ask
# for 15 bar of charge pressure: Hagglunds, Compact CB, product manual EN734-7h (2011).
RETURN_PRESSURES = (15e5, 30e5)  # Pa, the least and the most
RETURN_SPARE = 2e5  # Pa
CASE_PRESSURE = 2e5  # Pa

# Counts: an even set of pistons whose number shares a divisor with the lobes, so that the
# radial load on the shaft cancels; more pistons than lobes, at most twice as many; three
# phases at least, or there are places where the motor cannot start.
PISTONS = range(5, 25)
LOBES = range(4, 17)
LEAST_PHASES = 3
MOST_PISTONS_A_LOBE = 2.0
LEAST_DIVISOR = 2

STROKES = (0.2, 0.75)  # bores; shorter wastes dead volume, longer tilts the piston
RADII = (1.5, 8.0)  # bores of mean pitch radius that are looked at

# The oil: mineral, at the temperature of a warm case, with air as in service.
OIL, CELSIUS, AIR_FRACTION = "ISO VG 46", 50.0, 0.005
_DATA = oil_data(OIL, ZERO_CELSIUS + CELSIUS)
DENSITY, BULK_MODULUS = _DATA.density, _DATA.bulk_modulus
LEAST_PRESSURE = 1e5  # Pa, written as a constraint: below the atmosphere air comes out of the oil

# What a sketch is ranked by: each term is 1 for an ordinary motor, squared, and summed.
ORDINARY_LOSS = 0.08
ORDINARY_RIPPLE = 0.03
ORDINARY_SIZE = 1.6  # outer radius over the cube root of the displacement
ORDINARY_PISTONS = 12.0


Bores = Q[Float[np.ndarray, "*sketch"], "m"]


def clearance(bore: Bores) -> Q[Float[np.ndarray, "*sketch"], "m"]:
    """Radial, of a piston in its bore."""
    return CLEARANCE_PER_CUBE_ROOT * np.cbrt(bore)


def gap_leakage(bore: Bores) -> Q[Float[np.ndarray, "*sketch"], "m3/(s.Pa)"]:
    """Volume flow along the piston for each pascal, `PistonGap`'s."""
    return np.asarray(_gap(bore).leakage_conductance(_piston(bore), _OIL))


def film_damping(bore: Bores) -> Q[Float[np.ndarray, "*sketch"], "N.s/m"]:
    """Drag of the film round the piston for each metre a second, `PistonGap`'s."""
    return np.asarray(_gap(bore).film_damping(_piston(bore), _OIL))


_OIL = AeratedFluid(
    density=real(DENSITY),
    bulk_modulus=real(BULK_MODULUS),
    vapour_pressure=real(_DATA.vapour_pressure),
    viscosity=real(_DATA.viscosity),
    air_fraction=real(AIR_FRACTION),
)


def _gap(bore: Bores) -> PistonGap:
    return PistonGap(real(clearance(bore)), real(GUIDED_LENGTH * bore), real(ECCENTRICITY))


def _piston(bore: Bores) -> Piston:
    return Piston(real(bore), real(MASS_PER_CUBED_BORE * bore**3))
