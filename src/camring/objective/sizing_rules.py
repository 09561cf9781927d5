"""The rules by which a motor is sketched from a catalogue's data, each with its reason.

Proportions are shares of the bore, so one rule serves 0.2 L and 30 L: contact stress,
gap friction and throttling of similar machines are alike at the same pressure. Where a
rule says "as the examples", it is read off the three example motors, whose numbers are
assumptions in the class of a machine and no maker's data.
"""

from math import pi

from camring.geometry.material import Material
from camring.numerics.quantity import real

# The ring and the rollers.
STEEL = Material(real(206e9), real(0.3))
ROLLER_RADIUS = 0.42  # bores; a roller of 0.84 bores lies in the piston's head with a rim
ROLLER_LENGTHS = (0.95, 1.1, 1.25)  # bores; the shortest that carries the load is the cheapest
RING_WALL = 0.6  # bores of ring and housing outside the deepest place; assumed
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
# Couette friction in the film round a piston: mu pi Lg/c of 0.04 Pa s, 1.2 bores, 16 um.
DAMPING_PER_SQUARED_BORE = 9430.0  # N s/m3
# Piston and valve plate together; as the examples (1.9 to 2.4e-10).
LEAKAGE_PER_AREA = 2.2e-10  # m/(s Pa)

# Both directions of rotation alike: windows stand symmetric about the dead centres, shut
# for three quarters of what full pre-compression takes. As the examples (0.73 to 0.76).
# Less where so much leaks away meanwhile, at a slow speed, that rollers would lift off.
SHUT_SHARE = 0.75
SLOW = 0.2  # of rated speed: the second operating point
LEAK_SPARE = 1e5  # Pa above the case that are left then
RAMP = 0.3

# Return pressure keeps the rollers on the ring on their way in, with this to spare.
RETURN_PRESSURES = (10e5, 30e5)  # Pa, the least and the most
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

# The oil: mineral, ISO VG 46, a little stiffer than it is with air in it.
DENSITY, BULK_MODULUS = 870.0, 1.4e9

# What a sketch is ranked by: each term is 1 for an ordinary motor, squared, and summed.
ORDINARY_LOSS = 0.05
ORDINARY_RIPPLE = 0.03
ORDINARY_SIZE = 1.6  # outer radius over the cube root of the displacement
ORDINARY_PISTONS = 12.0
