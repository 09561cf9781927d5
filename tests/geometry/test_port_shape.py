"""Ports that are cut as drawn open as the model says."""

from math import pi, sqrt

import numpy as np
import pytest

from camring.geometry.notch import ReliefNotch
from camring.geometry.port_shape import PortError, ports_of
from camring.geometry.valve_plate import Port, ValvePlate
from camring.geometry.window import LinearWindow, RoundWindow, TabulatedWindow

AREA, LOBES = 60e-6, 6
PITCH = 2 * pi / LOBES


def plate(window=None, widths=(0.49, 0.49), notch=None, shift=0.01, area=AREA):
    return ValvePlate(
        area,
        Port(widths[0], PITCH / 4),
        Port(widths[1], 3 * PITCH / 4),
        window or LinearWindow(0.35),
        shift,
        notch,
        lobes=LOBES,
    )


def test_the_overlap_of_the_sectors_is_the_opening_of_the_model():
    given = plate()
    ports = ports_of(given, 0.0425)
    slot = next(slot for slot in ports.slots if slot.kind == "supply")
    angle = np.linspace(slot.centre - 0.4, slot.centre + 0.4, 801)
    half = ports.chamber_width / 2
    shared = np.minimum(angle + half, slot.end) - np.maximum(angle - half, slot.start)
    shared = np.maximum(shared, 0.0)
    area = shared * (ports.outer**2 - ports.inner**2) / 2
    opening = np.asarray(given.opening(given.supply, angle))
    np.testing.assert_allclose(area, AREA * opening, atol=1e-12 * AREA)


def test_a_round_port_over_a_round_ended_slot_opens_as_the_model_says():
    given = plate(RoundWindow(0.35))
    ports = ports_of(given, 1.0)
    assert ports.height == pytest.approx(sqrt(4 * AREA / pi))
    slot = next(slot for slot in ports.slots if slot.kind == "supply")
    radius = ports.height / 2
    # Port and end of the slot are circles; the distance of their centres along the port circle.
    opening = np.linspace(slot.opens, slot.full_from, 101)
    apart = ports.circle * (slot.start + ports.chamber_width / 2 - opening)
    lens = 2 * radius**2 * np.arccos(np.clip(apart / (2 * radius), -1, 1)) - apart / 2 * np.sqrt(
        np.maximum(4 * radius**2 - apart**2, 0.0)
    )
    expected = AREA * np.asarray(given.opening(given.supply, opening))
    np.testing.assert_allclose(lens, expected, atol=1e-9 * AREA)


def test_windows_open_and_close_where_the_model_has_them():
    for window in (LinearWindow(0.35), RoundWindow(0.6), TabulatedWindow([-1, 0, 1], [0, 1, 0])):
        given = plate(window, widths=(0.49, 0.45))
        for slot in ports_of(given, 0.05).slots:
            port = given.supply if slot.kind == "supply" else given.return_
            just_in = np.array([slot.opens + 1e-6, slot.closes - 1e-6])
            just_out = np.array([slot.opens - 1e-6, slot.closes + 1e-6])
            assert np.all(given.opening(port, just_in) > 0)
            assert np.all(given.opening(port, just_out) == 0)


def test_every_lobe_has_a_slot_of_each_kind_in_turn():
    slots = ports_of(plate(), 0.0425).slots
    assert [slot.kind for slot in slots] == ["supply", "return"] * LOBES
    assert {slot.number for slot in slots} == set(range(1, LOBES + 1))
    np.testing.assert_allclose(np.diff([slot.centre for slot in slots]), PITCH / 2)


def test_the_notch_ends_where_the_opening_begins():
    given = plate(notch=ReliefNotch(0.03, 0.05))
    slot = next(slot for slot in ports_of(given, 0.0425).slots if slot.kind == "supply")
    assert slot.start - slot.notch_tip == pytest.approx(0.03)
    # The edge of a chamber port reaches the tip where the groove begins to let oil through.
    lead = slot.opens - 0.03
    assert float(given.opening(given.supply, np.asarray(lead + 1e-4))) > 0
    assert float(given.opening(given.supply, np.asarray(lead - 1e-4))) == 0


def test_unequal_windows_keep_their_edges_and_own_to_the_ramp():
    ports = ports_of(plate(widths=(0.49, 0.45)), 0.0425)
    assert ports.ramp_error == pytest.approx(0.45 / 0.49 - 1)
    assert ports_of(plate(), 0.0425).ramp_error == 0.0


def test_a_port_circle_too_small_for_the_area_is_refused_with_one_that_does():
    for window in (LinearWindow(0.35), RoundWindow(0.35)):
        with pytest.raises(PortError) as refused:
            ports_of(plate(window), 0.0425, circle=0.01)
        enough = refused.value.least_radius
        assert ports_of(plate(window), 0.0425, circle=1.0001 * enough).inner >= 0


def test_slots_that_run_into_each_other_are_refused():
    with pytest.raises(PortError, match="run into each other"):
        ports_of(plate(LinearWindow(0.1), widths=(0.6, 0.6)), 0.08)
