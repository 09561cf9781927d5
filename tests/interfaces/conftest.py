"""One motor simulated at two speeds, for all tests of what is written about it."""

import equinox as eqx
import motors
import pytest

from camring.physics.cycle import simulate
from camring.physics.resolution import Resolution
from camring.physics.system import System


@pytest.fixture(scope="session")
def simulated():
    case = motors.sound_case(0)
    slow = eqx.tree_at(lambda p: p.shaft_speed, case.point, case.point.shaft_speed / 2)
    system = System(case.motor, case.fluid, (case.point, slow))
    run = eqx.filter_jit(simulate)
    cycles = [
        run(system.motor, system.fluid, point, Resolution.coarse())
        for point in system.operating_points
    ]
    return system, cycles
