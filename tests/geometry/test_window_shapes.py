"""Round and tabulated windows, and relief notches on any of them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from detailed_motors import lens_area_by_quadrature
from hypothesis import given, settings
from hypothesis import strategies as st

from camring.geometry.notch import ReliefNotch
from camring.geometry.window import (
    LinearWindow,
    RoundWindow,
    TabulatedWindow,
    lens_overlap,
    lens_share,
)
from camring.reference.laws import opening, opening_kinks
from camring.reference.parts import Window

WIDTH = 0.4
SHAPES = (
    LinearWindow(0.35),
    RoundWindow(0.6),
    RoundWindow(1.0),
    TabulatedWindow([-1.0, -0.7, -0.2, 0.3, 1.0], [0.0, 0.3, 1.0, 1.0, 0.0]),
)


@pytest.mark.parametrize("overlap", [0.001, 0.05, 0.3, 0.5, 0.9, 1.0])
def test_a_round_port_opens_by_the_area_two_circles_share(overlap):
    found = float(lens_share(jnp.asarray(overlap)))
    assert found == pytest.approx(lens_area_by_quadrature(overlap), rel=2e-6)


@given(share=st.floats(0, 1))
def test_overlap_and_share_of_a_lens_are_inverse(share):
    assert float(lens_share(lens_overlap(jnp.asarray(share)))) == pytest.approx(share, abs=1e-14)


@pytest.mark.parametrize("overlap", [0.0, 1e-9, 0.4, 1.0])
def test_the_lens_has_a_finite_slope_even_where_the_circles_touch(overlap):
    slope = float(jax.grad(lens_share)(overlap))
    assert slope == pytest.approx(4 / np.pi * np.sqrt(overlap * (2 - overlap)), rel=1e-12)


def second_solver(window, notch=None):
    shape = {"LinearWindow": "linear", "RoundWindow": "round"}.get(type(window).__name__, "table")
    table = ((), ())
    if shape == "table":
        knots = np.asarray(window.position) * WIDTH / 2
        table = (tuple(knots), tuple(np.asarray(window.opening_share)))
    groove = (0.0, 0.0) if notch is None else (float(notch.angle), float(notch.area))
    return Window(WIDTH, 0.0, shape, float(getattr(window, "ramp", 1.0)), *groove, table)


@pytest.mark.parametrize("window", SHAPES)
@pytest.mark.parametrize("notch", [None, ReliefNotch(0.05, 0.03), ReliefNotch(0.01, 0.4)])
def test_openings_are_those_of_the_second_solver(window, notch):
    distance = np.linspace(-0.35, 0.35, 2001)
    if notch is None:
        found = window.opening(jnp.asarray(distance), WIDTH)
    else:
        found = notch.opening(window, jnp.asarray(distance), WIDTH)
    expected = [opening(second_solver(window, notch))(d) for d in distance]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert float(jnp.min(found)) >= 0
    assert float(jnp.max(found)) == 1


@pytest.mark.parametrize("window", SHAPES)
@pytest.mark.parametrize("notch", [ReliefNotch(0.05, 0.03), ReliefNotch(0.01, 0.4)])
def test_every_kink_of_a_notched_window_is_an_edge(window, notch):
    edges = np.asarray(notch.edges(window, WIDTH))
    for kink in opening_kinks(second_solver(window, notch)):
        assert np.min(np.abs(edges - kink)) < 1e-9, kink


@settings(max_examples=30)
@given(
    ramp=st.floats(0.05, 1),
    angle=st.floats(0.002, 0.1),
    area=st.floats(0.001, 0.9),
    at=st.floats(-1, 1),
)
def test_a_notched_opening_is_continuous(ramp, angle, area, at):
    notch, window = ReliefNotch(angle, area), RoundWindow(ramp)
    distance = at * (WIDTH / 2 + angle) * 1.1
    step = 1e-7
    pair = notch.opening(window, jnp.asarray([distance, distance + step]), WIDTH)
    steepest = 4 / np.pi / (ramp * WIDTH / 2) + 2 * area / angle
    assert abs(float(pair[1] - pair[0])) <= step * steepest * 1.01 + 1e-12


def test_a_notch_without_area_is_none():
    distance = jnp.linspace(-0.3, 0.3, 301)
    for window in SHAPES:
        bare = window.opening(distance, WIDTH)
        np.testing.assert_array_equal(ReliefNotch(0.05, 0.0).opening(window, distance, WIDTH), bare)


def test_a_table_of_a_trapezoid_is_the_linear_window():
    table = TabulatedWindow([-1.0, -0.65, 0.65, 1.0], [0.0, 1.0, 1.0, 0.0])
    distance = jnp.linspace(-0.3, 0.3, 301)
    linear = LinearWindow(0.35)
    np.testing.assert_allclose(
        table.opening(distance, WIDTH), linear.opening(distance, WIDTH), atol=1e-12
    )
    np.testing.assert_allclose(table.edges(WIDTH), linear.edges(WIDTH), atol=1e-12)
    assert float(table.opens_to(jnp.asarray(0.6), WIDTH)) == pytest.approx(
        float(linear.opens_to(jnp.asarray(0.6), WIDTH))
    )
