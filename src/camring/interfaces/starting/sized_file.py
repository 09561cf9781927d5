"""The motor file of a sketch: complete, commented, ready to simulate and to optimise."""

from math import degrees, pi

import numpy as np

from camring.geometry.profiles import control_values, sine
from camring.metrics.estimate import Sketch, pre_compression
from camring.objective import sizing_rules as rules
from camring.objective.sizing import Demand, Sketches, duty_of, shut_angle

_TEXT = """\
# {name}: a sine cam.
# Written by `camring new` from a catalogue's data: {displacement:.4g} L/rev, {pressure:.4g} bar,
# {speed:.4g} rpm{envelope}. Counts, bore, ring and roller come from stated
# rules (guide, "From a catalogue page to a motor file"); no maker's data are in it.
# Outer radius about {outer:.0f} mm. Expected: contact stress {stress:.2f} GPa, pressure angle
# {angle:.1f} deg, efficiency {efficiency:.0f} % at rated speed.
#
#   camring check FILE        facts, limits and margins
#   camring optimise FILE --out FOLDER

[motor]
name = "{name}"
pistons = {pistons}
lobes = {lobes}
bore = "{bore:.0f} mm"
piston_mass = "{mass} kg"                     # steel, with its roller: 9500 kg/m3 of bore cubed
viscous_damping = "{damping} N*s/m"           # film of 16 um round the piston; assumed
dead_volume = "{dead} cm^3"                   # four fifths of the swept volume; assumed
leakage_coefficient = "{leakage} m^3/(s*Pa)"  # piston and valve plate; assumed

# A sine of {stroke:.2f} mm stroke about {radius:.1f} mm. The radius is the roller centre's.
[motor.cam]
control_radii = [
{control_radii}
]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

[motor.roller]
radius = "{roller_radius:.1f} mm"
length = "{roller_length:.1f} mm"
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

# Alike for both directions of rotation; shut about each dead centre over {shut:.2f} deg, where
# full pre-compression takes {full:.2f} deg.{slow_says}
[motor.valve_plate]
port_area = "{port_area} mm^2"                # loses {drop:.2g} bar at the greatest piston speed
discharge_coefficient = 0.65
supply_width = "{width:.4g} deg"
return_width = "{width:.4g} deg"
shift = "0 deg"
ramp = {ramp}

[fluid]
density = "870 kg/m^3"
bulk_modulus = "1.4 GPa"
vapour_pressure = "3 kPa"

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

# Torque ripple weighs so much that it asks about as much of a design as efficiency does.
[objective]
torque_ripple = {weight}

[constraints]
min_pressure = "3 kPa"
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
    "# slow operating point that the rollers would lift off."
)
_MOST_MODES = 9  # of a lobe; more only wrinkle the ring


def control_count(phases: int) -> int:
    """Control values of a lobe: even, a multiple of the phases, near 16 and at least 12.

    Only then does a zero-ripple cam exist in the spline (model.md section 11), which a
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
    duty = duty_of(demand, one.return_pressure[0])
    phases = int(sketch.phases)
    pitch = 2 * pi / int(sketch.lobes)
    shut = shut_angle(sketch, duty)
    full = float(pre_compression(sketch, duty))
    litres, bar = demand.displacement * 1e3, demand.pressure / 1e5
    rpm = demand.shaft_speed * 30 / pi
    radii = _radii(sketch, phases)
    quoted = [f'"{1e3 * radius:.4f} mm"' for radius in radii]
    rows = [", ".join(quoted[start : start + 4]) for start in range(0, len(quoted), 4)]
    half = degrees(pitch / 2)
    return _aligned(
        _TEXT.format(
            name=(
                f"Motor of {litres:.4g} L/rev, {int(sketch.pistons)} pistons on "
                f"{int(sketch.lobes)} lobes"
            ),
            displacement=litres,
            pressure=bar,
            speed=rpm,
            slow=rules.SLOW * rpm,
            envelope=(
                f", outer radius {1e3 * demand.envelope:.4g} mm"
                if np.isfinite(demand.envelope)
                else ""
            ),
            outer=1e3 * one.outer_radius[0],
            stress=one.contact_stress[0] / 1e9,
            angle=degrees(one.pressure_angle[0]),
            efficiency=100 * one.efficiency[0],
            pistons=int(sketch.pistons),
            lobes=int(sketch.lobes),
            bore=1e3 * sketch.bore,
            mass=_short(sketch.piston_mass),
            damping=_short(sketch.viscous_damping),
            dead=_short(1e6 * sketch.dead_volume),
            leakage=_short(sketch.leakage_coefficient),
            stroke=1e3 * sketch.stroke,
            radius=1e3 * sketch.mean_radius,
            control_radii=",\n".join(f"    {row}" for row in rows) + ",",
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
    )


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


def _aligned(text: str) -> str:
    """Comments behind values in one column."""
    lines = []
    for line in text.split("\n"):
        value, mark, comment = line.partition("  # ")
        lines.append(f"{value.rstrip():<46}# {comment}" if mark and value.strip() else line)
    return "\n".join(lines)


def _short(value: float | np.ndarray) -> str:
    """Three digits, without an exponent where people would not write one."""
    number = float(value)
    return f"{number:.3g}" if abs(number) < 1000 else f"{number:.0f}"
