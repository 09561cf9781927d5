"""What a result is compared with where it may be near zero itself.

A loss counts beside the power it is taken from, a pressure beside the highest one,
a lift beside the stroke: an error of a millionth of the input power matters little
whether the loss it sits in is large or small.
"""

from collections.abc import Mapping

RIPPLES = (
    "torque_ripple",
    "torque_ripple_true_rms",
    "torque_ripple_peak_to_peak",
    "flow_ripple",
    "flow_ripple_true_rms",
    "return_flow_ripple",
    "return_flow_ripple_true_rms",
    "pressure_ripple",
    "pressure_ripple_true_rms",
)
"""Results that a good motor has near zero, shares of a mean."""

BESIDE = {
    "line_loss": "input_power",
    "return_line_loss": "input_power",
    "throttling_loss": "input_power",
    "leakage_loss": "input_power",
    "full_leakage_loss": "input_power",
    "friction_loss": "input_power",
    "compression_loss": "input_power",
    "case_heat": "input_power",
    "surface_heat": "input_power",
    "port_power": "input_power",
    "case_drain": "supply_flow",
    "return_flow": "supply_flow",
    "min_pressure": "max_pressure",
    "pressure_overshoot": "max_pressure",
    "pressure_undershoot": "max_pressure",
    "supply_pressure_swing": "max_pressure",
    "return_pressure_swing": "max_pressure",
    "vapour_margin": "max_pressure",
    "air_release_margin": "max_pressure",
    "min_lift": "stroke",
    "max_lift": "stroke",
}


def scale_of(name: str, results: Mapping[str, float]) -> float:
    """The size of a result, or of what it is small beside if that is larger, SI."""
    return max(abs(results[name]), abs(results[BESIDE.get(name, name)]))
