"""How results are named, grouped and written for people: label, unit, decimals, good direction."""

from dataclasses import dataclass
from math import isfinite, log10, pi

__all__ = ["GROUPS", "QUANTITIES", "Quantity", "change", "significant"]


@dataclass(frozen=True)
class Quantity:
    """A result of docs/theory.md section 10 in an engineer's unit.

    `better` is +1 when more is better, -1 when less is, 0 when neither.
    `relative` changes are given in per cent, others in the unit itself
    (percentages change by points). A `rare` result is left out where it is nil.
    """

    name: str
    label: str
    unit: str
    factor: float
    better: int = 0
    digits: int = 4
    relative: bool = True
    rare: bool = False

    def value(self, si: float) -> float:
        return si * self.factor

    def written(self, si: float) -> str:
        return significant(si * self.factor, self.digits)


def significant(value: float, digits: int = 4) -> str:
    """A number with so many significant digits, without an exponent where people avoid one."""
    if not isfinite(value):
        return "–"
    if value == 0 or abs(value) < 1e-12:
        return "0"
    power = int(log10(abs(value)) // 1)
    if power < -4 or power > 8:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    decimals = max(digits - 1 - power, 0)
    text = f"{value:,.{decimals}f}".replace(",", "\u2009")
    if float(text.replace("\u2009", "")) == 0:
        return "0"
    return text.replace("-", "−")


GROUPS: tuple[tuple[str, tuple[Quantity, ...]], ...] = (
    (
        "Torque",
        (
            Quantity("mean_torque", "Mean torque", "N·m", 1.0, 1),
            Quantity("torque_ripple", "Torque ripple, one-sided", "%", 100.0, -1, 3),
            Quantity("torque_ripple_true_rms", "Torque ripple, true rms", "%", 100.0, -1, 3),
            Quantity(
                "torque_ripple_peak_to_peak", "Torque ripple, peak to peak", "%", 100.0, -1, 3
            ),
            Quantity("ideal_torque", "Ideal torque", "N·m", 1.0),
        ),
    ),
    (
        "Flow and efficiency",
        (
            Quantity("displacement", "Displacement", "cm³/rev", 1e6),
            Quantity("supply_flow", "Supply flow", "L/min", 6e4),
            Quantity("return_flow", "Return flow", "L/min", 6e4),
            Quantity("case_drain", "Case drain", "L/min", 6e4, -1),
            Quantity("flow_ripple", "Supply flow ripple, one-sided", "%", 100.0, -1, 3),
            Quantity("return_flow_ripple", "Return flow ripple, one-sided", "%", 100.0, -1, 3),
            Quantity("efficiency", "Efficiency", "%", 100.0, 1, 4, False),
            Quantity("volumetric_efficiency", "Volumetric efficiency", "%", 100.0, 1, 4, False),
            Quantity(
                "hydromechanical_efficiency", "Hydromechanical efficiency", "%", 100.0, 1, 4, False
            ),
            Quantity("energy_efficiency", "Energy efficiency", "%", 100.0, 1, 4, False),
            Quantity("port_efficiency", "Efficiency between the ports", "%", 100.0, 1, 4, False),
        ),
    ),
    (
        "Power",
        (
            Quantity("input_power", "Hydraulic input", "kW", 1e-3),
            Quantity("output_power", "Shaft output", "kW", 1e-3, 1),
            Quantity("line_loss", "Loss in the supply line", "W", 1.0, -1, rare=True),
            Quantity("return_line_loss", "Loss in the return line", "W", 1.0, -1, rare=True),
            Quantity("throttling_loss", "Throttling loss", "W", 1.0, -1),
            Quantity("leakage_loss", "Leakage loss", "W", 1.0, -1),
            Quantity("friction_loss", "Friction loss", "W", 1.0, -1),
            Quantity("compression_loss", "Compression term", "W", 1.0),
            Quantity("port_power", "Hydraulic power between the ports", "kW", 1e-3),
            Quantity("full_leakage_loss", "Leakage loss down to the case", "W", 1.0, -1),
            Quantity("case_heat", "Heat that stays in the motor", "W", 1.0, -1),
            Quantity("surface_heat", "Heat given off by the surface", "W", 1.0, rare=True),
            Quantity(
                "case_temperature_rise", "Case above the oil that comes in", "K", 1.0, -1, rare=True
            ),
        ),
    ),
    (
        "Pressure",
        (
            Quantity("min_pressure", "Lowest chamber pressure", "bar", 1e-5, 1),
            Quantity("max_pressure", "Highest chamber pressure", "bar", 1e-5, -1),
            Quantity("pressure_overshoot", "Overshoot above supply", "bar", 1e-5, -1, 3),
            Quantity("pressure_undershoot", "Undershoot below return", "bar", 1e-5, -1, 3),
            Quantity(
                "supply_pressure_swing", "Supply pressure, peak to peak", "bar", 1e-5, -1, rare=True
            ),
            Quantity(
                "return_pressure_swing", "Return pressure, peak to peak", "bar", 1e-5, -1, rare=True
            ),
            Quantity("pressure_ripple", "Chamber pressure ripple, one-sided", "%", 100.0, 0, 3),
        ),
    ),
    (
        "Contact",
        (
            Quantity("max_contact_stress", "Highest contact stress", "GPa", 1e-9, -1),
            Quantity("min_contact_force", "Lowest radial contact force", "kN", 1e-3, 1),
            Quantity("l10_life", "Rating life L10 of ring and rollers", "h", 1 / 3600, 1),
            Quantity("min_undercut_factor", "Lowest undercut factor", "", 1.0, 1, 3),
            Quantity("max_pressure_angle", "Highest pressure angle", "deg", 180 / pi, -1, 3),
        ),
    ),
    (
        "Motion",
        (
            Quantity("stroke", "Stroke", "mm", 1e3),
            Quantity("max_velocity", "Highest piston velocity", "m/s", 1.0, -1),
            Quantity("max_acceleration", "Highest piston acceleration", "m/s²", 1.0, -1),
            Quantity("max_jerk", "Highest piston jerk", "km/s³", 1e-3, -1),
            Quantity("min_volume", "Smallest chamber volume", "cm³", 1e6),
        ),
    ),
    (
        "Derivation's indicators",
        (
            Quantity("jerk_objective", "Jerk objective", "", 1.0, -1, 3),
            Quantity("spectral_pressure", "Spectral sum, pressure", "", 1.0, 0, 3),
            Quantity("spectral_torque", "Spectral sum, torque", "", 1.0, -1, 3),
            Quantity("hydraulic_stiffness", "Hydraulic stiffness", "kN/mm", 1e-6),
            Quantity("natural_frequency", "Natural frequency", "rad/s", 1.0),
            Quantity("damping_ratio", "Damping ratio", "", 1.0, 0, 3),
        ),
    ),
)

QUANTITIES = {quantity.name: quantity for _, group in GROUPS for quantity in group}


def change(quantity: Quantity, before: float, after: float) -> tuple[str, int]:
    """The change in words and whether it is for the better (+1), the worse (-1) or neither (0).

    Changes below one part in ten thousand (or 0.005 points) count as none.
    """
    if not (isfinite(before) and isfinite(after)):
        return "–", 0
    if quantity.relative:
        if before <= 0 or after <= 0:  # the ratio of two negatives grows as they fall
            moved = (after - before) * quantity.factor
            small = abs(moved) < 1e-9
            text = "none" if small else f"{moved:+.3g} {quantity.unit}".rstrip()
        else:
            ratio = after / before
            small = abs(ratio - 1) < 5e-5
            text = _relative(ratio)
    else:
        moved = (after - before) * quantity.factor
        small = abs(moved) < 0.005
        text = f"{moved:+.2f} points"
    if small:
        return "none", 0
    better = quantity.better * (1 if after > before else -1)
    return text.replace("-", "−"), better


def _relative(ratio: float) -> str:
    if ratio <= 0.5:
        return f"÷ {1 / ratio:.3g}"
    if ratio >= 2:
        return f"× {ratio:.3g}"
    moved = 100 * (ratio - 1)
    return f"{moved:+.2g} %" if abs(moved) < 1 else f"{moved:+.1f} %"
