"""The machine does not care which metre, kilogram and second we use (house.md)."""

import typing

import numpy as np
import pytest
from both_solvers import RESULTS, run
from motors import STRUCTURES, Case, sound_case
from unit_systems import UnitSystem, dimension, unit_of

from camring.metrics.summary import Metrics

SYSTEMS = (
    UnitSystem(39.37, 1.0, 1.0),
    UnitSystem(1.0, 2.2046, 1.0),
    UnitSystem(1.0, 1.0, 1000.0),
    UnitSystem(3.2808, 0.0685, 0.0166),
)


def test_units_are_read_as_written():
    np.testing.assert_array_equal(dimension("Pa"), (-1, 1, -2))
    np.testing.assert_array_equal(dimension("m3/(s.Pa)"), (4, -1, 1))
    np.testing.assert_array_equal(dimension("N.s/m"), (0, 1, -1))
    np.testing.assert_array_equal(dimension("m/rad2"), (1, 0, 0))
    np.testing.assert_array_equal(dimension("1/m"), (-1, 0, 0))


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_result_is_the_same_quantity_in_other_units(system):
    case = sound_case(0, STRUCTURES[0])
    _, here = run(case)
    _, abroad = run(Case(*(system.convert(noun) for noun in case)))
    hints = typing.get_type_hints(Metrics, include_extras=True)
    # The rating of bearing steel is a measured number of newtons and metres.
    for name in set(RESULTS) - {"l10_life"}:
        expected = float(getattr(here, name)) * system.factor(unit_of(hints[name]))
        assert float(getattr(abroad, name)) == pytest.approx(expected, rel=1e-6, abs=1e-12), name
