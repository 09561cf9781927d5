"""A motor reads the oil's viscosity where its flows and friction change with it, nowhere else."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest
from motor_files import SOUND, added, without_table

from camring.analyses.oil_use import unread_viscosity
from camring.files.motor import parse_motor_file
from camring.files.motor.laws import SLOTS, laws_of
from camring.physics.chamber import Chamber
from camring.physics.oil.viscosity_use import reads_viscosity
from camring.physics.pressure import port_flows

OIL = without_table("[fluid]") + '\n[fluid]\noil = "ISO VG 46"\ntemperature = "50 degC"\n'
GAP = ("[motor.gap]", 'clearance = "15 um"\nlength = "30 mm"')
ORIFICES = laws_of(next(slot for slot in SLOTS if slot.chooser == "orifice"))


def losses(system, viscosity):
    """Flows of a half-open chamber and film friction, each a number."""
    oil = eqx.tree_at(lambda each: each.viscosity, system.fluid, jnp.asarray(viscosity))
    motor, point = system.motor, system.operating_points[0]
    half = motor.valve_plate.port_area / 2
    chamber = Chamber(half, half, motor.dead_volume, jnp.zeros(()))
    flows = port_flows(motor, oil, point, chamber, (point.supply_pressure + 1e5) / 2)
    return np.array([*map(float, flows), float(motor.viscous_damping(oil))])


@pytest.mark.parametrize("gap", [False, True])
@pytest.mark.parametrize("law", ["constant", "aerated"])
@pytest.mark.parametrize("orifice", ORIFICES)
def test_what_is_traced_is_what_changes(orifice, law, gap):
    text = added("[motor.valve_plate]", f'orifice = "{orifice}"', OIL)
    text = added("[fluid]", f'law = "{law}"', text)
    file = parse_motor_file(added(*GAP, text) if gap else text)
    system = file.system
    changes = not np.array_equal(losses(system, 1e-5), losses(system, 1e-4))
    assert reads_viscosity(system.motor, system.fluid, system.operating_points[0]) == changes
    assert bool(unread_viscosity(file)) == (not changes)


def test_a_named_oil_that_nothing_reads_is_said_with_the_way_out():
    [said] = unread_viscosity(parse_motor_file(OIL))
    assert "fluid.oil and fluid.temperature set density, bulk modulus" in said
    assert "[motor.gap]" in said
    assert 'orifice = "laminar-turbulent"' in said
    # The way out is one.
    assert not unread_viscosity(parse_motor_file(added(*GAP, OIL)))
    # Who names no oil asks for nothing.
    assert not unread_viscosity(parse_motor_file(SOUND))


def test_temperatures_of_an_envelope_are_named_too():
    envelope = (
        'speed = ["20 rpm", "100 rpm"]\nsupply_pressure = ["100 bar", "250 bar"]\n'
        'temperature = ["20 degC", "80 degC"]'
    )
    [said] = unread_viscosity(parse_motor_file(added("[envelope]", envelope, OIL)))
    assert "fluid.oil, fluid.temperature and envelope.temperature" in said


def test_a_bare_viscosity_without_effect_is_said():
    text = added("[fluid]", 'viscosity = "46 mm^2/s"')
    [said] = unread_viscosity(parse_motor_file(text))
    assert said.startswith("fluid.viscosity has no effect")
