"""The loss model of a measured 107 cm3 axial unit: which laws its rows ask for.

Constants `Cf 0.0537, Ch 53.6, Cv 23.5e3, Cs 4.26e-9` in the form of Wilson (1950) with a term of
the square of speed: torque `dp D (1 - Cf) - Cv mu w D - Ch rho w^2 D^(5/3) / 2`, flow
`w D + Cs dp D / mu`, `D` the displacement for a radian. Nine pistons on one lobe of sine motion
move as those of a swash plate. What it shows and what not stands in docs/validation.md.
"""

from math import cos, pi

import numpy as np
import pytest

from camring.files.motor import parse_motor_file
from camring.fitting.fit import fit
from camring.fitting.measurements.table import parse_measured_table
from camring.physics.oil.presets import ZERO_CELSIUS, oil_data

DISPLACEMENT = 107e-6
CF, CH, CV, CS = 0.0537, 53.6, 23.5e3, 4.26e-9
OIL = "ISO VG 46"
PISTONS, BORE, MIDDLE = 9, 0.020, 0.060
ROWS = [
    (rpm, bar, celsius)
    for celsius in (40, 70)
    for bar in (50, 125, 200)
    for rpm in (500, 1000, 1500, 2000, 2500)
]
BACK = 2  # bar, return and case


def loss_model(rpm, bar, celsius):
    """Torque, N m, and flow, m3/s, of the measured unit."""
    oil = oil_data(OIL, ZERO_CELSIUS + celsius)
    speed, drop, radian = rpm * pi / 30, bar * 1e5, DISPLACEMENT / (2 * pi)
    viscosity = oil.density * oil.viscosity
    lost = CV * viscosity * speed * radian + CH * oil.density * speed**2 * radian ** (5 / 3) / 2
    return drop * radian * (1 - CF) - lost, speed * radian + CS * drop * radian / viscosity


def motor_text():
    """A motor of that displacement and motion, its constants those of a first guess."""
    stroke = DISPLACEMENT / (PISTONS * pi * BORE**2 / 4)
    phase = 2 * pi * np.arange(24) / 24
    # A spline through control values on a cosine swings by (2 + cos h)/3 of theirs.
    radii = MIDDLE - stroke / 2 * 3 / (2 + cos(phase[1])) * np.cos(phase)
    listed = ", ".join(f"{each:.9g}" for each in radii)
    return f"""
[motor]
pistons = {PISTONS}
lobes = 1
bore = "20 mm"
piston_mass = "50 g"
dead_volume = "0.3 cm^3"
viscous_damping = 0
leakage = "viscous"
leakage_coefficient = "5e-13 m^3/(s*Pa)"
reference_viscosity = "46 mm^2/s"
[motor.cam]
control_radii = [{listed}]
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[motor.roller]
radius = "8 mm"
length = "20 mm"
friction = 0.005
elastic_modulus = "206 GPa"
poisson_ratio = 0.3
[motor.gap]
clearance = "10 um"
length = "30 mm"
[motor.churning]
moment_coefficient = 0.1
radius = "80 mm"
[motor.valve_plate]
port_area = "200 mm^2"
discharge_coefficient = 0.65
supply_width = "180 deg"
return_width = "180 deg"
ramp = 0.1
[fluid]
oil = "{OIL}"
temperature = "50 degC"
[[operating_points]]
speed = "1500 rpm"
supply_pressure = "200 bar"
return_pressure = "{BACK} bar"
"""


def table():
    head = "speed [rpm],supply pressure [bar],oil temperature [degC],torque [Nm],flow [L/min]"
    rows = []
    for rpm, bar, celsius in ROWS:
        torque, flow = loss_model(rpm, bar, celsius)
        rows.append(f"{rpm},{bar + BACK},{celsius},{torque!r},{6e4 * flow!r}")
    return parse_measured_table("\n".join([head, *rows]))


OF = ["leakage_coefficient", "gap.clearance", "roller.friction", "churning.moment_coefficient"]


@pytest.fixture(scope="module")
def file():
    return parse_motor_file(motor_text())


def missed(found, result):
    """Root mean square of what is left over that of the measured."""
    here = found.of(result)
    left = (found.modelled - found.measured)[here]
    return float(np.sqrt(np.mean(left**2) / np.mean(found.measured[here] ** 2)))


def test_physical_constants_meet_the_measured_losses(file):
    found = fit(file, table(), OF)
    numbers = dict(zip((each.key for each in found.numbers), found.values, strict=True))
    print(numbers, missed(found, "mean_torque"), missed(found, "supply_flow"), found.warnings)
    assert found.squares.settled
    assert missed(found, "mean_torque") < 3e-3
    assert missed(found, "supply_flow") < 1e-3
    assert not found.tangled
    assert 3e-6 < numbers["motor.gap.clearance"] < 2e-5  # a lapped piston
    assert 0.005 < numbers["motor.roller.friction"] < 0.02
    assert 0.01 < numbers["motor.churning.moment_coefficient"] < 1


def test_without_churning_the_fit_says_what_is_missing(file):
    still = parse_motor_file(motor_text().replace("coefficient = 0.1\n", "coefficient = 0\n"))
    found = fit(still, table(), OF[:-1])
    assert missed(found, "mean_torque") > 3e-3
    said = " ".join(found.warnings)
    print(said)
    assert "goes with the square of the speed" in said
    assert "motor.churning.moment_coefficient is kept as given" in said
