"""Charts are valid, true to their data, and say the same without colour."""

import re
import xml.etree.ElementTree as ElementTree
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camring.drawing import palette
from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Loop, Note, Region, Rule, Stems, Steps
from camring.drawing.marks import mark
from camring.drawing.path import TOLERANCE, polyline, simplified
from camring.drawing.scale import Axis, covering, format_tick, nice_ticks
from camring.drawing.svg import element, number
from camring.files.quantities import QUANTITIES, change, significant

finite = st.floats(-1e6, 1e6, allow_nan=False)
STYLE = palette.design_style(0, 2)


def chart(*layers, x=(0.0, 10.0), y=(-2.0, 2.0), **more) -> Chart:
    axes = Axis("Angle", "deg", *x), Axis("Pressure", "bar", *y)
    return Chart("test", "A title", "A description", *axes, layers, **more)


def drawn_points(svg: str) -> np.ndarray:
    """Vertices of the first curve in a drawing, paper coordinates."""
    path = re.search(r'<path d="([^"]*)" class="curve"', svg)
    pairs = re.findall(r"(-?[\d.]+) (-?[\d.]+)", path[1])
    return np.array(pairs, dtype=float)


def test_a_coordinate_is_never_nan():
    for value in (np.nan, np.inf, -np.inf):
        with pytest.raises(ValueError, match="cannot hold"):
            number(value)
    assert number(-0.001) == "0"
    assert number(2.50) == "2.5"


@given(finite, finite)
def test_ticks_lie_within_the_axis_at_even_steps(one, other):
    low, high = sorted((one, other))
    ticks = nice_ticks(low, high)
    if high - low < 1e-6:
        return
    assert 1 <= len(ticks) <= 12
    assert low - 1e-6 * (high - low) <= ticks[0]
    assert ticks[-1] <= high + 1e-6 * (high - low)
    if len(ticks) > 2:
        steps = np.diff(ticks)
        np.testing.assert_allclose(steps, steps[0], rtol=1e-6)


def test_tick_labels_show_what_tells_neighbours_apart():
    ticks = nice_ticks(0.12, 0.19)
    labels = [format_tick(t, ticks[1] - ticks[0]) for t in ticks]
    assert len(set(labels)) == len(labels)
    assert format_tick(-5.0, 5.0) == "−5"


def test_angles_get_ticks_that_divide_a_circle():
    assert nice_ticks(0.0, 360.0, 12, angles=True) == [30.0 * k for k in range(13)]


@given(st.lists(finite, min_size=1, max_size=30))
def test_an_axis_covers_its_values(values):
    axis = covering("x", "", [np.array(values)])
    places = axis.fraction(np.array(values))
    assert (places >= -1e-9).all()
    assert (places <= 1 + 1e-9).all()
    assert axis.low < axis.high


def test_an_axis_stays_on_an_included_zero_and_survives_nan():
    axis = covering("x", "", [np.array([np.nan, 3.0])], include=(0.0,))
    assert axis.low == 0.0
    assert covering("x", "", [np.array([np.nan])]).low < covering("x", "", []).high


def test_a_logarithmic_axis_leaves_out_what_has_no_logarithm():
    axis = covering("x", "", [np.array([-1.0, 0.0, 0.01, 10.0])], kind="log")
    assert 0 < axis.low < 0.01
    assert np.isnan(axis.fraction(0.0))
    assert all(label for _, label in axis.ticks())


@given(st.integers(0, 2**32 - 1), st.integers(3, 400))
def test_a_simplified_curve_never_leaves_its_data(seed, count):
    random = np.random.default_rng(seed)
    x = np.cumsum(random.random(count) + 0.01)
    y = np.cumsum(random.normal(size=count)) + 30 * (random.random(count) > 0.95)
    keep = simplified(x, y)
    assert np.abs(np.interp(x, x[keep], y[keep]) - y).max() <= TOLERANCE + 1e-9


def test_a_straight_line_needs_two_points():
    assert polyline(np.arange(100.0), 2 * np.arange(100.0)) == "M0 0L99 198"


def test_a_loop_returns_to_its_start():
    turn = np.linspace(0, 2 * np.pi, 400)
    path = polyline(100 * np.cos(turn), 100 * np.sin(turn), plane=True)
    points = np.array(re.findall(r"(-?[\d.]+) (-?[\d.]+)", path), dtype=float)
    np.testing.assert_allclose(points[0], points[-1], atol=0.01)
    np.testing.assert_allclose(np.hypot(*points.T), 100, atol=0.01)
    assert 20 < len(points) < 200


def test_a_curve_is_drawn_where_its_data_are():
    x = np.linspace(0, 10, 1000)
    config = chart(Curve(x, np.sin(x), "sine", STYLE))
    svg = draw(config)
    points = drawn_points(svg)
    left, right, low, high, _ = re.search(r'data-x="([^"]*)"', svg)[1].split()
    angle = float(low) + (points[:, 0] - float(left)) / (float(right) - float(left)) * (
        float(high) - float(low)
    )
    bottom, top, low, high, _ = re.search(r'data-y="([^"]*)"', svg)[1].split()
    value = float(low) + (points[:, 1] - float(bottom)) / (float(top) - float(bottom)) * (
        float(high) - float(low)
    )
    np.testing.assert_allclose(value, np.sin(angle), atol=1e-3)


def test_holes_in_the_data_are_gaps_in_the_curve():
    y = np.sin(np.linspace(0, 6, 100))
    y[40:60] = np.nan
    svg = draw(chart(Curve(np.linspace(0, 10, 100), y, "sine", STYLE)))
    assert "nan" not in svg.lower()
    assert re.search(r'd="(M[^"]*)" class="curve"', svg)[1].count("M") == 2


def test_every_layer_makes_valid_xml_even_of_awkward_data():
    x = np.array([0.0, 2.0, 5.0, 9.0])
    y = np.array([1.0, np.nan, -1.0, np.inf])
    layers = [
        Curve(x, y, "a <b> & 'c'", STYLE),
        Loop(x, np.abs(x - 4), "loop", STYLE),
        Steps(x, np.nan_to_num(y, posinf=2.0), "steps", STYLE),
        Stems(x, y, STYLE),
        Rule(0.5, "limit <1 & 2>", limit=True),
        Rule(3.0, "upright", upright=True),
        Rule(99.0, "outside"),
        Region(-5.0, 3.0, "phase"),
        Note(2.0, 1.0, 'said "so"'),
        Note(200.0, 1.0, "outside"),
    ]
    svg = draw(chart(*layers, legend=[("given", STYLE)]))
    root = ElementTree.fromstring(svg)
    assert root.tag.endswith("svg")
    assert "nan" not in svg.lower()
    assert "outside" not in svg


def test_a_chart_tells_the_blind_what_it_shows():
    root = ElementTree.fromstring(draw(chart()))
    space = {"s": "http://www.w3.org/2000/svg"}
    named = root.get("aria-labelledby").split()
    assert [root.find(f"s:{tag}", space).get("id") for tag in ("title", "desc")] == named
    assert root.find("s:desc", space).text == "A description"


def test_units_stand_on_the_axes():
    svg = draw(chart())
    assert "Angle, deg" in svg
    assert "Pressure, bar" in svg


def test_elements_escape_what_they_are_given():
    assert element("p", title='a"b') == '<p title="a&quot;b"></p>'
    assert element("line", x1=1.0, x2=None) == '<line x1="1"/>'


@pytest.mark.parametrize("count", [2, 4, 6])
def test_designs_differ_without_colour(count):
    styles = [palette.design_style(k, count) for k in range(count)]
    assert len({style.dash for style in styles}) == count
    shapes = [mark(0.0, 0.0, style) for style in styles[:2]]
    assert re.match(r"<\w+", shapes[0])[0] != re.match(r"<\w+", shapes[1])[0]


def luminance(colour: str) -> float:
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def test_lines_and_words_stand_out_from_the_paper():
    colours = [palette.INK, palette.QUIET, palette.LIMIT, palette.SUPPLY, palette.RETURN]
    colours += [palette.design_style(k, 6).colour for k in range(6)]
    for colour in colours:
        assert 1.05 / (luminance(colour) + 0.05) >= 4.5, colour


def test_designs_differ_for_the_colour_blind():
    # Viénot, Brettel and Mollon (1999): what a protanope and a deuteranope see.
    to_cones = np.array(
        [[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]]
    )
    protan = np.array([[0, 2.02344, -2.52581], [0, 1, 0], [0, 0, 1]])
    deutan = np.array([[1, 0, 0], [0.494207, 0, 1.24827], [0, 0, 1]])
    colours = [palette.design_style(k, 2).colour for k in range(2)]
    seen = [np.array([int(c[k : k + 2], 16) for k in (1, 3, 5)], float) for c in colours]
    for eye in (protan, deutan):
        through = np.linalg.inv(to_cones) @ eye @ to_cones
        for one, other in combinations(seen, 2):
            assert np.linalg.norm(through @ (one - other)) > 80


def test_pressure_colours_darken_steadily():
    shades = [luminance(palette.pressure_colour(share)) for share in np.linspace(0, 1, 40)]
    assert (np.diff(shades) < 0).all()
    assert palette.pressure_colour(-1) == palette.pressure_colour(0)
    assert palette.pressure_colour(2) == palette.pressure_colour(1)


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0829385, 3, "0.0829"),
        (1494.69, 4, "1\u2009495"),
        (-403.011, 4, "−403.0"),
        (0.0, 4, "0"),
        (np.nan, 4, "–"),
        (39005.8, 4, "39\u2009006"),
        (1e-7, 3, "1.00e−07"),
    ],
)
def test_numbers_are_written_for_people(value, digits, text):
    assert significant(value, digits) == text


@pytest.mark.parametrize(
    ("name", "before", "after", "text", "better"),
    [
        ("torque_ripple", 0.083, 0.0083, "÷ 10", 1),
        ("torque_ripple", 0.01, 0.03, "× 3", -1),
        ("efficiency", 0.9637, 0.9625, "−0.12 points", -1),
        ("efficiency", 0.96370, 0.96371, "none", 0),
        ("mean_torque", 1500.0, 1530.0, "+2.0 %", 1),
        ("displacement", 4e-4, 4.2e-4, "+5.0 %", 0),
        ("min_contact_force", -100.0, 400.0, "+0.5 kN", 1),
        # Of two numbers below zero the lower one is no increase, however large the ratio.
        ("min_contact_force", -1000.0, -1500.0, "−0.5 kN", -1),
        ("min_contact_force", -4000.0, -1000.0, "+3 kN", 1),
        ("min_pressure", np.nan, 1.0, "–", 0),
        ("pressure_overshoot", 2e5, 0.0, "−2 bar", 1),
        ("pressure_overshoot", 0.0, 0.0, "none", 0),
    ],
)
def test_changes_are_reported_with_their_direction(name, before, after, text, better):
    assert change(QUANTITIES[name], before, after) == (text, better)


@given(st.sampled_from(sorted(QUANTITIES)), st.floats(), st.floats())
def test_any_two_numbers_have_a_change(name, before, after):
    text, better = change(QUANTITIES[name], before, after)
    assert text
    assert better in (-1, 0, 1)
    assert significant(before)
