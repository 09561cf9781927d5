"""The motor file that `camring new` writes: a small wheel motor, every table explained."""

from collections.abc import Callable

import numpy as np

from camring.files.starting.filling import filled
from camring.geometry.profiles import LAWS, control_values, zero_ripple_cams

PISTONS, LOBES, CONTROL_COUNT = 8, 6, 16
BASE_RADIUS, STROKE = 0.085, 0.0118  # m
PROFILES = (*LAWS, "zero-ripple")

_SAID = {
    "sine": "A sine cam: the smoothest acceleration, but its torque ripples.",
    "constant-acceleration": (
        "A cam of constant acceleration, two parabolas a flank: the least peak\n"
        "# acceleration, endless jerk (rounded off here by the spline)."
    ),
    "trapezoid": "A modified trapezoid of acceleration: as steep as two parabolas, without jumps.",
    "zero-ripple": (
        "A spline cam whose geometric torque ripple is zero: its rising slope is a box of a\n"
        "# quarter of a lobe convolved with a kernel, so that the slopes of the pistons add up\n"
        "# to a constant."
    ),
}

_TEXT = """\
# A radial-piston motor: {pistons} pistons in a turning block inside a ring of {lobes} lobes.
#
# A number with a unit is text, "30 mm"; a bare number is SI. Pressures are absolute.
# `camring check` tells the facts of this motor, `camring simulate` runs it,
# `camring optimise` searches its design space for a better one.
#
# It is in the class of wheel motors, not a measured product. As given it loses what such a
# motor loses on the test bench (ISO 4409): with a sine cam hydromechanical efficiency 0.94 at
# 60 rpm, total 0.89 there and 0.91 at 300 rpm. Published for radial-piston motors:
# hydromechanical 0.938 to 0.948.

[motor]
name = "{name}"
pistons = {pistons}
lobes = {lobes}
bore = "30 mm"
piston_mass = "0.24 kg"                       # with its roller
dead_volume = "6 cm^3"                        # of a chamber at its smallest
leakage_coefficient = "9e-14 m^3/(s*Pa)"      # of the valve plate, for each chamber; assumed
viscous_damping = "0 N*s/m"                   # of one piston, beside the film in [motor.gap]
side_friction = 0.019                         # of the piston in its bore; source below

# {said}
# Control values of the spline r(angle), one lobe, equally spaced from the inner dead
# centre; r is the path of the roller's centre.
[motor.cam]
control_radii = [
{control_radii}
]
degree = 3                                    # 4 and 5 have smoother jerk
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
# outer_diameter = "250 mm"                   # of the ring's body; else 0.6 bores of wall

# Friction of roller and side: a Staffa HMC125's catalogue row is fitted by 0.0075 and 0.019;
# the roller's 0.009 brings hydromechanical efficiency to the published.
[motor.roller]
radius = "12 mm"
length = "28 mm"                              # of line contact
friction = 0.009
elastic_modulus = "206 GPa"
poisson_ratio = 0.3

# Leakage and film friction between piston and bore, beside the coefficients above; they
# follow the oil's viscosity. 28 um on the diameter, of the 7 to 41 um of the fit H7/g6.
[motor.gap]
clearance = "14 um"                           # radial
length = "30 mm"
eccentricity = 0.5                            # 0 concentric, 1 touching

# One supply and one return window in each lobe pitch of {pitch} deg, centred at a
# quarter and at three quarters of it; alike for both directions of rotation.
[motor.valve_plate]
port_area = "60 mm^2"                         # fully open
discharge_coefficient = 0.65
supply_width = "28.8 deg"
return_width = "28.8 deg"
return_centre = "45 deg"                      # three quarters of the lobe pitch
shift = "0 deg"                               # turns all windows against the cam
ramp = 0.35                                   # share of a window over which it opens and closes
# notch_angle = "1 deg"                       # a relief notch before each window ...
# notch_area = 0.02                           # ... and its share of the port area; one way only
# orifice = "laminar-turbulent"               # for cold oil and small openings

# The oil before the supply windows, fed through a line: its pressure then ripples, too.
# [motor.manifold]
# supply_volume = "200 cm^3"
# line_conductance = "40 L/min/bar"

# The same behind the return windows, emptied through a line; either may stand alone.
# [motor.return_manifold]
# return_volume = "200 cm^3"
# line_conductance = "80 L/min/bar"

[fluid]
oil = "ISO VG 46"                             # density, bulk modulus and viscosity ...
temperature = "50 degC"                       # ... at this temperature; each may be given
law = "aerated"                               # with air in it, mass conserved
air_fraction = 0.005                          # by volume, at atmospheric pressure

# What cools it: with this table case and films are as warm as their losses make them.
# [thermal]
# ambient_temperature = "20 degC"
# heat_transfer = "12 W/K"                    # of the whole surface

# As many as the motor has operating points; their weights make one objective of them. With
# rotation = "reverse" a valve exchanges the ports and the motor turns backwards.
[[operating_points]]
speed = "300 rpm"
supply_pressure = "250 bar"
return_pressure = "15 bar"                    # charge pressure
case_pressure = "2 bar"
weight = 0.6

[[operating_points]]
speed = "60 rpm"
supply_pressure = "350 bar"
return_pressure = "15 bar"
case_pressure = "2 bar"
weight = 0.4

# Where it must run, beside these: from a tenth of its speed and a fifth of its pressure. Every
# limit below holds there, and no point of it may become noisier, or half a point less
# efficient, than the motor of this file. return_pressure and temperature may have a range, too.
[envelope]
speed = ["30 rpm", "300 rpm"]
supply_pressure = ["70 bar", "350 bar"]
rotation = "both"                             # a vehicle drives both ways
max_ripple_ratio = 1
max_efficiency_loss = "0.5 %"

# What is to become small, with its weight; leave out what fits. These are the defaults but
# for torque ripple: at its 10 a point of efficiency would outweigh most of it.
[objective]
torque_ripple = 100
envelope_ripple = 100                         # its mean over the envelope
pressure_ripple = 0.02
efficiency = 1
spectrum = 1
jerk = 0.02

# What must hold. A limit that is not given is none; see also stroke, lift, max_velocity,
# max_acceleration, max_jerk, min_damping_ratio and min_mean_torque.
[constraints]
min_pressure = "1 bar"                        # below the atmosphere air comes out of the oil
max_pressure = "420 bar"
max_contact_stress = "1.9 GPa"
min_contact_force = "0 N"                     # rollers stay on the ring
max_pressure_angle = "30 deg"
min_undercut_factor = 0.25
displacement = ["396.36 cm^3", "404.36 cm^3"]

# What may change: any number above by its path, between two bounds, or by a share:
# "motor.dead_volume" = {{ relative = ["-10 %", "10 %"] }}
[design_space]
"motor.valve_plate.shift" = ["-2 deg", "1 deg"]
"motor.valve_plate.supply_width" = ["26 deg", "30 deg"]
"motor.valve_plate.return_width" = ["26 deg", "30 deg"]
"motor.valve_plate.return_centre" = ["44 deg", "46 deg"]
"motor.valve_plate.ramp" = [0.2, 0.6]

# The cam, by harmonics of the lobe up to `modes`; harmonic k changes a control radius by
# at most amplitude/k^2 (a share is of the range of the control radii).
[design_space.cam]
modes = 8
amplitude = "40 %"
mirror = true                                 # stays symmetric about its dead centres

# What scatters from one built motor to the next, plus or minus, for `camring tolerance` and
# `camring robust`; and amplitudes of waves round the ring by waves a revolution.
# [tolerances]
# "motor.valve_plate.shift" = "0.3 deg"
# "fluid.bulk_modulus" = {{ relative = "10 %", distribution = "normal" }}
# [tolerances.waviness]
# 3 = "5 um"

[search]
budget = 300                                  # model evaluations, at most
# method = "scbo"                             # learns from evaluations alone; no slopes
seed = 0
"""


def template(profile: str) -> str:
    """The text of a new motor file with one of `PROFILES`."""
    radii = BASE_RADIUS + STROKE * lift_control_values(profile)
    return filled(
        _TEXT,
        radii,
        pistons=PISTONS,
        lobes=LOBES,
        pitch=360 // LOBES,
        name=f"Wheel motor, 0.4 L/rev, {profile} cam",
        said=_SAID[profile],
    )


def lift_control_values(profile: str) -> np.ndarray:
    """Control values of one lobe of the template's motor, for a stroke of 1 from 0."""
    if profile in LAWS:
        law: Callable[[np.ndarray], np.ndarray] = LAWS[profile]
        return control_values(law, CONTROL_COUNT)
    cams = zero_ripple_cams(PISTONS, LOBES, CONTROL_COUNT)
    gentlest = min(cams, key=lambda cam: np.max(np.abs(np.diff(np.pad(cam.steps, 1)))))
    return gentlest.control_values(CONTROL_COUNT)
