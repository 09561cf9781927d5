"""The motor file of a sketch: complete, commented, ready to simulate and to optimise."""

from math import degrees, floor, pi

import numpy as np

from camring.files.starting import sizing_rules as rules
from camring.files.starting.filling import filled
from camring.files.starting.sizing import Demand, Sketches, conditions_of, shut_angle
from camring.geometry.profiles import control_values, sine
from camring.geometry.ring_body import RING_WALL
from camring.metrics.estimate import Sketch, pre_compression

_TEXT = """\
# {name}: a sine cam.
# Written by `camring new` from a catalogue's data: {displacement:.4g} L/rev, {pressure:.4g} bar,
# {speed:.4g} rpm{asked}. Counts, bore, ring and roller come from stated
# rules (guide, "From a catalogue page to a motor file"); no maker's data are in it.
# Expected: contact stress {stress:.2f} GPa, pressure angle {angle:.1f} deg, efficiency
# {efficiency:.0f} % at rated speed.
#
#   camring check FILE        facts, limits and margins
#   camring optimise FILE --out FOLDER

[motor]
name = "{name}"
pistons = {pistons}
lobes = {lobes}
bore = "{bore:.0f} mm"
piston_mass = "{mass} kg"                     # steel, with its roller: 9500 kg/m3 of bore cubed
dead_volume = "{dead} cm^3"                   # four fifths of the swept volume; assumed
leakage_coefficient = "{leakage} m^3/(s*Pa)"  # of the valve plate; assumed, see [motor.gap]
viscous_damping = "0 N*s/m"                   # none beside the film in [motor.gap]
side_friction = {side}  # of the piston in its bore; source at [motor.roller]

# A sine of {stroke:.2f} mm stroke about {radius:.1f} mm. The radius is the roller centre's.
[motor.cam]
control_radii = [
{control_radii}
]
outer_diameter = "{outer} mm"  # {wall} bores of wall outside the deepest place
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

# Roller and side friction: a Staffa HMC125's catalogue row is fitted by 0.0075 and 0.019, and
# the roller's 0.009 brings hydromechanical efficiency to the published 0.938 to 0.948.
[motor.roller]
radius = "{roller_radius:.1f} mm"
length = "{roller_length:.1f} mm"
friction = {rolling}
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

# Piston in bore: a fifth above the middle of the fit H7/g6 (ISO 286-2). What leaks here
# follows the oil's viscosity; the rest is the valve plate's coefficient.
[motor.gap]
clearance = "{clearance:.1f} um"
length = "{guided:.1f} mm"
eccentricity = {eccentricity}

# Alike for both directions of rotation; shut about each dead centre over {shut:.2f} deg, where
# full pre-compression takes {full:.2f} deg.{slow_says}
[motor.valve_plate]
port_area = "{port_area} mm^2"                # loses {drop:.2g} bar at the greatest piston speed
discharge_coefficient = 0.65
supply_width = "{width:.4g} deg"
return_width = "{width:.4g} deg"
return_centre = "{centre:.6g} deg"            # three quarters of the lobe pitch
shift = "0 deg"
ramp = {ramp}

# Half a percent of air, as oil carries it in service; all of it dissolved above 30 bar.
[fluid]
oil = "{oil}"
temperature = "{celsius:.4g} degC"
law = "aerated"
air_fraction = {air}

[[operating_points]]
speed = "{speed:.6g} rpm"
supply_pressure = "{pressure:.6g} bar"
return_pressure = "{back:.4g} bar"            # keeps the rollers on the ring on their way in
case_pressure = "{case:.4g} bar"
weight = 0.6

[[operating_points]]
speed = "{slow:.6g} rpm"
supply_pressure = "{pressure:.6g} bar"
return_pressure = "{back:.4g} bar"
case_pressure = "{case:.4g} bar"
weight = 0.4

# Where it must run: from a tenth of its speed and a fifth of its pressure. Every limit below
# holds there, and no point may be noisier or half a point less efficient than this motor.
[envelope]
speed = ["{slowest:.6g} rpm", "{speed:.6g} rpm"]
supply_pressure = ["{lowest:.6g} bar", "{pressure:.6g} bar"]
rotation = "both"                             # "forward" for a motor that turns one way
max_ripple_ratio = 1
max_efficiency_loss = "0.5 %"

# Torque ripple weighs so much that it asks about as much of a design as efficiency does.
[objective]
torque_ripple = {weight}
envelope_ripple = {weight}

[constraints]
min_pressure = "{least:.4g} bar"              # below the atmosphere air comes out of the oil
max_pressure = "{most:.4g} bar"               # a fifth above supply
max_contact_stress = "{stress_limit:.2g} GPa"
min_contact_force = "0 N"
max_pressure_angle = "{angle_limit:.0f} deg"
min_undercut_factor = {undercut_limit}
displacement = ["{low:.6g} cm^3/rev", "{high:.6g} cm^3/rev"]

# What may change. The modes are harmonics of the lobe, added to the control radii at
# the same displacement; harmonic k changes a control radius by at most amplitude/k^2.
[design_space]
"motor.valve_plate.shift" = ["{shift_low:.3g} deg", "{shift_high:.3g} deg"]
"motor.valve_plate.supply_width" = ["{narrow:.4g} deg", "{wide:.4g} deg"]
"motor.valve_plate.return_width" = ["{narrow:.4g} deg", "{wide:.4g} deg"]
"motor.valve_plate.return_centre" = ["{centre_low:.6g} deg", "{centre_high:.6g} deg"]
"motor.valve_plate.ramp" = [0.2, 0.6]

[design_space.cam]
modes = {modes}
amplitude = "40 %"
mirror = true

[search]
budget = 300
seed = 0
"""

_SLOW_SAYS = (
    " Over more of it, so much would leak away at the\n"
    "# slowest speed that the rollers would lift off."
)
_MOST_MODES = 9  # of a lobe; more only wrinkle the ring


def control_count(phases: int) -> int:
    """Control values of a lobe: even, a multiple of the phases, near 16 and at least 12.

    Only then does a zero-ripple cam exist in the spline (docs/theory.md section 11), which a
    search may begin with.
    """
    step = phases if phases % 2 == 0 else 2 * phases
    return min(
        (step * k for k in range(1, 30) if step * k >= 12), key=lambda count: abs(count - 16)
    )


def sized_text(found: Sketches, place: int, demand: Demand) -> str:
    """The text of a motor file for one of the sketches."""
    one = found.taken(np.array([place]))
    sketch = Sketch(*(each[0] for each in one.sketch))
    conditions = conditions_of(demand, one.return_pressure[0])
    phases = int(sketch.phases)
    pitch = 2 * pi / int(sketch.lobes)
    shut = shut_angle(sketch, conditions)
    full = float(pre_compression(sketch, conditions))
    litres, bar = demand.displacement * 1e3, demand.pressure / 1e5
    rpm = demand.shaft_speed * 30 / pi
    half = degrees(pitch / 2)
    return filled(
        _TEXT,
        _radii(sketch, phases),
        name=(
            f"Motor of {litres:.4g} L/rev, {int(sketch.pistons)} pistons on "
            f"{int(sketch.lobes)} lobes"
        ),
        displacement=litres,
        pressure=bar,
        speed=rpm,
        slow=rules.SLOW * rpm,
        slowest=rules.SLOWEST * rpm,
        lowest=_lowest_pressure(demand, float(one.return_pressure[0])) / 1e5,
        asked=(
            f", at most {1e3 * demand.outer_diameter:.6g} mm outside"
            if np.isfinite(demand.outer_diameter)
            else ""
        ),
        outer=_rounded_down(2e3 * one.outer_radius[0]),
        wall=RING_WALL,
        stress=one.contact_stress[0] / 1e9,
        angle=degrees(one.pressure_angle[0]),
        efficiency=100 * one.efficiency[0],
        pistons=int(sketch.pistons),
        lobes=int(sketch.lobes),
        bore=1e3 * sketch.bore,
        mass=_short(sketch.piston_mass),
        dead=_short(1e6 * sketch.dead_volume),
        leakage=_short(sketch.leakage_coefficient - rules.gap_leakage(sketch.bore)),
        side=rules.SIDE_FRICTION,
        rolling=rules.ROLLER_FRICTION,
        clearance=1e6 * rules.clearance(sketch.bore),
        guided=1e3 * rules.GUIDED_LENGTH * sketch.bore,
        eccentricity=rules.ECCENTRICITY,
        oil=rules.OIL,
        celsius=rules.CELSIUS,
        air=rules.AIR_FRACTION,
        least=rules.LEAST_PRESSURE / 1e5,
        centre=1.5 * half,
        centre_low=1.5 * half - 0.5 * degrees(full),
        centre_high=1.5 * half + 0.5 * degrees(full),
        stroke=1e3 * sketch.stroke,
        radius=1e3 * sketch.mean_radius,
        roller_radius=1e3 * sketch.roller_radius,
        roller_length=1e3 * sketch.roller_length,
        port_area=_short(1e6 * sketch.port_area),
        shut=degrees(shut),
        full=degrees(full),
        slow_says=_SLOW_SAYS if shut < 0.99 * rules.SHUT_SHARE * full else "",
        drop=one.port_drop[0] / 1e5,
        width=half - degrees(shut),
        narrow=half - 1.5 * degrees(full),
        wide=half,
        shift_low=-0.75 * degrees(full),
        shift_high=0.4 * degrees(full),
        ramp=rules.RAMP,
        back=one.return_pressure[0] / 1e5,
        case=rules.CASE_PRESSURE / 1e5,
        weight=ripple_weight(float(one.torque_ripple[0])),
        most=1.2 * bar,
        stress_limit=rules.STRESS_LIMIT / 1e9,
        angle_limit=degrees(rules.ANGLE_LIMIT),
        undercut_limit=rules.UNDERCUT_LIMIT,
        low=0.99 * litres * 1e3,
        high=1.01 * litres * 1e3,
        modes=min(control_count(phases) // 2, _MOST_MODES),
    )


def _lowest_pressure(demand: Demand, back: float) -> float:
    """Supply pressure at the lower end of the envelope, Pa."""
    above = min(rules.LEAST_DROP, (demand.pressure - back) / 2)
    return max(rules.LOWEST * demand.pressure, back + above)


def ripple_weight(geometric_ripple: float) -> int:
    """A round weight at which squared ripple is about 0.6, as in the examples.

    Compressible oil adds about 0.8 % to the geometric ripple of a sine.
    """
    wanted = 0.65 / (geometric_ripple + 0.008) ** 2
    rounds = [digit * 10**power for power in range(1, 5) for digit in (1, 2, 3, 5)]
    return min(rounds, key=lambda each: abs(np.log(each / wanted)))


def _radii(sketch: Sketch, phases: int) -> np.ndarray:
    lift = control_values(sine, control_count(phases))
    return float(sketch.least_radius) + float(sketch.stroke) * lift


def _rounded_down(value: float) -> str:
    """To a hundredth, never above what was asked for."""
    return f"{floor(100 * value * (1 + 1e-12)) / 100:.6g}"


def _short(value: float | np.ndarray) -> str:
    """Three digits, without an exponent where people would not write one."""
    number = float(value)
    return f"{number:.3g}" if abs(number) < 1000 else f"{number:.0f}"
