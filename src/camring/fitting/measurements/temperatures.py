"""Temperatures that a bench measures: of the oil that comes in, and of the case."""

import numpy as np
from jaxtyping import Float

from camring.files.errors import InputError
from camring.fitting.measurements.names import CASE_TEMPERATURE
from camring.objective.measurable import CASE_RISE

OIL_TEMPERATURE = "oil_temperature"
Row = Float[np.ndarray, " row"]
Columns = dict[tuple[str, bool], Row]
"""By name, and whether they are standard deviations."""


def with_rise(names: Columns, shown: str) -> Columns:
    """Temperatures of the case as what they are above the oil that comes in.

    Raises
    ------
    InputError
        For temperatures of the case without those of the oil.
    """
    if (CASE_TEMPERATURE, False) not in names:
        return names
    if (OIL_TEMPERATURE, False) not in names:
        raise InputError(
            f"{shown}, case temperature,",
            "tells nothing without the temperature of the oil that comes in",
            "give that beside it, oil temperature [degC]",
        )
    rise = {(CASE_RISE, False): names[CASE_TEMPERATURE, False] - names[OIL_TEMPERATURE, False]}
    if (CASE_TEMPERATURE, True) in names:
        rise[CASE_RISE, True] = names[CASE_TEMPERATURE, True]
    return {key: each for key, each in names.items() if key[0] != CASE_TEMPERATURE} | rise
