"""What to measure, so that rows tell a number that they do not."""

from collections.abc import Sequence

ELSEWHERE = "at other speeds and pressures"
OTHERWISE = f"measure {ELSEWHERE}"
SLOWER = "measure torque at lower speeds, or a starting torque"
IN_A_CHAMBER = "measure the highest and the lowest pressure in a chamber"
BETTER_MEASURED = {
    "motor.leakage_coefficient": "measure case drain",
    "motor.gap.clearance": "measure case drain",
    "motor.viscous_damping": "measure torque at higher speeds",
    "motor.roller.friction": "measure torque at other pressures",
    "motor.side_friction": "measure torque at other pressures",
    "motor.valve_plate.discharge_coefficient": "measure torque at higher speeds",
    "motor.valve_plate.supply_discharge_coefficient": IN_A_CHAMBER,
    "motor.valve_plate.return_discharge_coefficient": IN_A_CHAMBER,
    "fluid.bulk_modulus": "measure ripple",
    "motor.valve_plate.gap": "measure case drain",
    "motor.churning.moment_coefficient": "measure torque at higher speeds",
    "motor.roller.static_friction": SLOWER,
    "motor.roller.stribeck_speed": SLOWER,
    "motor.side_static_friction": SLOWER,
    "motor.side_stribeck_speed": SLOWER,
    "thermal.heat_transfer": "measure the temperature of the case",
}
ALIKE = (
    (
        {"motor.leakage_coefficient", "motor.gap.clearance", "motor.valve_plate.gap"},
        "measure case drain beside supply flow: all of them let oil pass with the pressure, and "
        "no speed or pressure tells them apart",
    ),
    (
        {"motor.churning.moment_coefficient", "motor.valve_plate.discharge_coefficient"},
        "measure the pressure drop of the unloaded motor: both cost torque with the square of "
        "the speed",
    ),
    (
        {
            "motor.valve_plate.discharge_coefficient",
            "motor.valve_plate.supply_discharge_coefficient",
            "motor.valve_plate.return_discharge_coefficient",
        },
        f"{IN_A_CHAMBER}: what either side's ports throttle costs torque with the square of the "
        "speed",
    ),
    (
        {"motor.roller.friction", "motor.side_friction"},
        "take one from elsewhere: both cost torque with the load",
    ),
)
"""Numbers that do the same to the rows of a bench, and what would tell them apart."""


def telling(keys: Sequence[str]) -> str:
    """What would tell numbers apart that these rows do not."""
    return next((said for alike, said in ALIKE if set(keys) <= alike), OTHERWISE)
