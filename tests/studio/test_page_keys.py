"""The page without a mouse."""

import pytest
from studio_page import undone, until, value_of

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("key", ["shift", "supply_width", "return_width"])
def test_a_window_of_the_dial_moves_by_arrow_keys(page, key):
    path = f"motor.valve_plate.{key}"
    before = value_of(page, path)
    dial = page.get_by_test_id(f"dial-{key}")
    assert dial.evaluate("each => getComputedStyle(each).opacity") == "0"
    dial.focus()
    assert dial.evaluate("each => getComputedStyle(each).opacity") == "1"  # a ring shows where
    place = dial.bounding_box()
    for name in ("PageUp", "ArrowRight", "Shift+ArrowUp"):
        dial.press(name)
    wanted = round(before + 0.5 + 0.05 + 0.01, 2)
    until(page, f"camringStudio.known.model.undo === {path!r}")
    assert value_of(page, path) == wanted
    until(page, f"document.activeElement.getAttribute('aria-valuetext') === '{wanted:g} degrees'")
    assert dial.bounding_box() != place  # the handle goes with its window
    undone(page, path)
    assert value_of(page, path) == before


def test_an_operating_point_of_the_map_moves_by_arrow_keys_along_both_axes(page):
    speed, pressure = "operating_points[0].speed", "operating_points[0].supply_pressure"
    before = value_of(page, speed), value_of(page, pressure)
    until(page, "camringStudio.known.envelope.coarse !== null")
    point = page.get_by_test_id("map-point-0")
    point.focus()
    place = point.bounding_box()
    point.press("ArrowRight")  # no further: the map ends here
    point.press("ArrowLeft")
    point.press("ArrowDown")
    until(page, "camringStudio.known.model.undo === 'operating point 1'")
    after = value_of(page, speed), value_of(page, pressure)
    assert before == (300, 250)
    assert after == (290, 245)
    moved = point.bounding_box()
    assert moved["x"] < place["x"]
    assert moved["y"] > place["y"]
    text = point.get_attribute("aria-valuetext")
    assert " rpm, " in text
    assert text.endswith(" bar")
    undone(page, "operating point 1")
    page.get_by_test_id("map-point-1").press("Enter")
    until(page, "camringStudio.known.model.point === 1")
    point.press("Enter")
    until(page, "camringStudio.known.model.point === 0")
