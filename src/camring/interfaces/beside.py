"""What a result is judged against where it may be near zero itself.

A loss counts beside the power it is taken from, a pressure beside the highest one,
a lift beside the stroke: an error of a millionth of the input power matters little
whether the loss it sits in is large or small.
"""

from collections.abc import Mapping

BESIDE = {
    "line_loss": "input_power",
    "throttling_loss": "input_power",
    "leakage_loss": "input_power",
    "friction_loss": "input_power",
    "compression_loss": "input_power",
    "min_pressure": "max_pressure",
    "pressure_overshoot": "max_pressure",
    "pressure_undershoot": "max_pressure",
    "supply_pressure_swing": "max_pressure",
    "vapour_margin": "max_pressure",
    "air_release_margin": "max_pressure",
    "min_lift": "stroke",
    "max_lift": "stroke",
}


def scale_of(name: str, results: Mapping[str, float]) -> float:
    """The size of a result, or of what it is small beside if that is larger, SI."""
    return max(abs(results[name]), abs(results[BESIDE.get(name, name)]))
