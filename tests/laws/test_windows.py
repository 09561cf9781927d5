"""Laws of the valve plate's windows."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camring.geometry.valve_plate import LinearWindow, Port, ValvePlate

angles = st.floats(-20, 20)
lobes = st.sampled_from([1, 4, 9])  # each count compiles anew
shares = st.floats(0.05, 1.0)


def plate_of(lobes, width, ramp, shift=0.0, centre=None):
    pitch = 2 * pi / lobes
    centre = pitch / 4 if centre is None else centre
    return ValvePlate(
        6e-5,
        Port(width * pitch, centre),
        Port(width * pitch, centre + pitch / 2),
        LinearWindow(ramp),
        shift,
        lobes=lobes,
    )


@settings(max_examples=40)
@given(lobes=lobes, width=shares, ramp=shares, shift=st.floats(-3, 3), angle=angles)
def test_the_opening_is_the_clipped_ramp_of_model_md(lobes, width, ramp, shift, angle):
    plate = plate_of(lobes, width, ramp, shift)
    pitch, half = plate.pitch, width * plate.pitch / 2
    distance = min(
        abs(angle - pitch / 4 - shift - pitch * k) for k in range(-60 * lobes, 60 * lobes)
    )
    expected = min(max((half - distance) / (ramp * half), 0.0), 1.0)
    assert float(plate.opening(plate.supply, angle)) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=40)
@given(lobes=lobes, width=shares, ramp=shares)
def test_a_window_opens_for_its_width_less_one_ramp(lobes, width, ramp):
    """The area under a trapezoid: it replaces a port of this width that opens at once."""
    plate = plate_of(lobes, width, ramp)
    edges = np.sort(np.asarray(plate.breakpoints()))
    edges = np.concatenate([[0.0], edges, [plate.pitch]])
    opening = np.asarray(plate.opening(plate.supply, edges))
    area = np.sum(np.diff(edges) * (opening[1:] + opening[:-1]) / 2)
    assert area == pytest.approx(width * plate.pitch * (1 - ramp / 2), rel=1e-9)


@settings(max_examples=40)
@given(lobes=lobes, width=shares, ramp=shares, shift=st.floats(-3, 3), turn=angles)
def test_turning_the_plate_turns_the_openings(lobes, width, ramp, shift, turn):
    angle = np.linspace(0, 2 * pi, 37)
    still, turned = plate_of(lobes, width, ramp, shift), plate_of(lobes, width, ramp, shift + turn)
    for port in ("supply", "return_"):
        one = still.opening(getattr(still, port), angle)
        other = turned.opening(getattr(turned, port), angle + turn)
        np.testing.assert_allclose(one, other, atol=1e-9)


@settings(max_examples=40)
@given(lobes=lobes, width=shares, ramp=shares, centre=st.floats(-2, 2))
def test_a_window_is_straight_between_its_breakpoints_and_bends_at_them(lobes, width, ramp, centre):
    plate = plate_of(lobes, width, ramp, centre=centre)
    edges = np.sort(np.asarray(plate.breakpoints()))
    edges = np.append(edges, edges[0] + plate.pitch)
    for port in (plate.supply, plate.return_):
        at = edges[:-1] + np.diff(edges) * np.array([[0.0], [0.5], [1.0]])
        opening = np.asarray(plate.opening(port, at))
        np.testing.assert_allclose(opening[1], (opening[0] + opening[2]) / 2, atol=1e-9)


@settings(max_examples=40)
@given(lobes=lobes, width=st.floats(0.05, 0.5), ramp=shares, angle=angles)
def test_windows_no_wider_than_half_a_pitch_never_join_supply_and_return(lobes, width, ramp, angle):
    plate = plate_of(lobes, width, ramp)
    both = plate.opening(plate.supply, angle) * plate.opening(plate.return_, angle)
    assert float(both) < 1e-12
