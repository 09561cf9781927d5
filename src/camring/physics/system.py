"""Everything a simulation needs: a motor, the oil in it, and what is asked of it."""

import equinox as eqx

from camring.numerics.readable import readable
from camring.physics.motor import Motor
from camring.physics.oil.fluid import AbstractFluid
from camring.physics.operating_point import OperatingPoint


class System(eqx.Module):
    """A motor, its oil and its operating points: what one motor file describes, as one pytree.

    Any number in it may be a design variable, so a batch of designs is a
    `System` whose leaves have a leading axis.

    Examples
    --------
    >>> system = camring.read_motor_file("motor.toml").system
    >>> system.motor.pistons, len(system.operating_points)
    (8, 1)
    """

    motor: Motor
    fluid: AbstractFluid
    operating_points: tuple[OperatingPoint, ...]

    __repr__ = readable
