"""What passes the valve plate beside the chambers: volumes at each end, and power lost."""

from typing import NamedTuple

import numpy as np

from camring.reference.laws import OilLaw
from camring.reference.machine import Machine


class PastPlate(NamedTuple):
    """Volumes a second at supply, return and case pressure, and the power they carry off."""

    supply: float = 0.0
    back: float = 0.0
    drain: float = 0.0
    power: float = 0.0
    heat: float = 0.0  # that stays in the case
    drain_mass: float = 0.0
    across: float = 0.0  # power lost from port to port


def past_plate(machine: Machine, oil: OilLaw) -> PastPlate:
    """Nothing of a machine whose plate does not leak."""
    m = machine
    if m.plate is None:
        return PastPlate()
    ends = (m.supply_pressure, m.return_pressure, m.case_pressure)
    to_case, back_to_case, across = m.plate.flows(m.film_viscosity, *ends)
    if not oil.aerated:
        power = (to_case + across) * (m.supply_pressure - m.return_pressure)
        drain = to_case + back_to_case
        heat = to_case * (ends[0] - ends[2]) + back_to_case * (ends[1] - ends[2])
        mass = m.oil.density * drain
        lost = across * (ends[0] - ends[1])
        return PastPlate(to_case + across, across - back_to_case, drain, power, heat, mass, lost)
    at_supply, at_return, at_case = (oil.density(each) for each in ends)
    to_case *= (at_supply + at_case) / 2
    back_to_case *= (at_return + at_case) / 2
    across *= (at_supply + at_return) / 2
    level = oil.enthalpy(np.array(ends))
    return PastPlate(
        (to_case + across) / at_supply,
        (across - back_to_case) / at_return,
        (to_case + back_to_case) / at_case,
        (to_case + across) * float(level[0] - level[1]),
        to_case * float(level[0] - level[2]) + back_to_case * float(level[1] - level[2]),
        to_case + back_to_case,
        across * float(level[0] - level[1]),
    )
