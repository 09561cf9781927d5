"""Everything a simulation needs: a motor, the oil in it, and what is asked of it."""

import equinox as eqx

from camring.physics.fluid import AbstractFluid
from camring.physics.motor import Motor
from camring.physics.operating_point import OperatingPoint


class System(eqx.Module):
    """A motor with its oil and duties: what one motor file describes, as one pytree.

    Any number in it may be a design variable, so a batch of designs is a
    `System` whose leaves have a leading axis.
    """

    motor: Motor
    fluid: AbstractFluid
    operating_points: tuple[OperatingPoint, ...]
