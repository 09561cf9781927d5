"""Chains of lines and arcs against curves of which all is known."""

from math import ceil, pi, sqrt

import numpy as np
import pytest

from camring.geometry.closed_chain import ChainError, along_links, fit_chain

LONG, SHORT = 1.3, 0.8


def ellipse(parameter):
    point = LONG * np.cos(parameter) + 1j * SHORT * np.sin(parameter)
    first = -LONG * np.sin(parameter) + 1j * SHORT * np.cos(parameter)
    curvature = LONG * SHORT / np.abs(first) ** 3
    return point, -1j * first / np.abs(first), curvature


def stray_from_ellipse(point, near):
    # Newton on the foot of the normal: the tangent there is square to what is left.
    parameter = np.array(near, float)
    for _ in range(8):
        sine, cosine = np.sin(parameter), np.cos(parameter)
        away = LONG * cosine + 1j * SHORT * sine - point
        first, second = -LONG * sine + 1j * SHORT * cosine, -LONG * cosine - 1j * SHORT * sine
        slope = np.abs(first) ** 2 + np.real(np.conj(second) * away)
        parameter = parameter - np.real(np.conj(first) * away) / slope
    place, normal, _ = ellipse(parameter)
    return np.real(np.conj(normal) * (point - place))


def circle(parameter):
    turn = np.exp(1j * np.asarray(parameter))
    return 2 * turn, turn, np.full(np.shape(parameter), 0.5)


def stray_from_circle(point, near):
    return np.abs(point) - 2


def test_a_circle_is_arcs_whatever_the_tolerance_and_as_many_lines_as_its_sagitta_asks():
    arcs = fit_chain(circle, stray_from_circle, 4, 1e-9, "arcs")
    assert arcs.links <= 24
    assert arcs.error < 1e-14
    np.testing.assert_allclose(4 * np.arctan(arcs.bulges).sum(), 2 * pi, rtol=1e-12)
    lines = fit_chain(circle, stray_from_circle, 4, 1e-6, "lines")
    # A chord of angle a strays 2 (1 - cos(a / 2)).
    least = 2 * pi / (2 * sqrt(1e-6))
    assert least <= lines.links <= 4 * ceil(1.03 * least / 4)


@pytest.mark.parametrize(("kind", "order"), [("lines", 2), ("arcs", 3)])
def test_links_grow_with_the_root_that_the_order_of_a_link_gives(kind, order):
    counts = [
        fit_chain(ellipse, stray_from_ellipse, 2, tolerance, kind).links
        for tolerance in (1e-4, 1e-4 / 8**order)
    ]
    assert counts[1] / counts[0] == pytest.approx(8, rel=0.12)


@pytest.mark.parametrize("kind", ["lines", "arcs"])
def test_the_error_said_is_that_of_a_hundred_places_and_every_period_is_alike(kind):
    chain = fit_chain(ellipse, stray_from_ellipse, 2, 1e-5, kind)
    ends = np.roll(chain.points, -1)
    places = along_links(chain.points, ends, chain.bulges, np.linspace(0, 1, 101))
    strays = np.abs(
        stray_from_ellipse(places, np.angle(places.real / LONG + 1j * places.imag / SHORT))
    )
    assert 0.99 * strays.max() <= chain.error <= 1e-5
    half = chain.links // 2
    np.testing.assert_allclose(chain.points[half:], -chain.points[:half], atol=1e-14)
    np.testing.assert_array_equal(chain.bulges[half:], chain.bulges[:half])


def test_arcs_begin_and_end_where_they_should_and_bulge_as_drawing_programs_have_it():
    # A quarter bulge of tan(pi/8) is a quarter of a circle, here of radius 1 about 0.
    [places] = along_links(
        np.array([1.0 + 0j]), np.array([1j]), np.array([np.tan(pi / 8)]), np.array([0, 0.5, 1])
    )
    np.testing.assert_allclose(places, [1, np.exp(0.25j * pi), 1j], atol=1e-15)
    [straight] = along_links(
        np.array([0j]), np.array([2.0 + 0j]), np.array([0.0]), np.array([0.25])
    )
    np.testing.assert_allclose(straight, [0.5])


def test_a_tolerance_that_no_chain_keeps_is_refused_with_what_one_does():
    with pytest.raises(ChainError) as said:
        fit_chain(circle, stray_from_circle, 1, 1e-13, "lines")
    assert said.value.strays > 1e-13
    assert said.value.links >= 200_000
