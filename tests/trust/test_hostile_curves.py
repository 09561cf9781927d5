"""A stranger's drawing or curve file is a ring, or refused in a sentence; it never falls over."""

import math
import random

import ezdxf
import numpy as np
import pytest

from camring.files.errors import InputError
from camring.files.shapes.curve_file import read_curve_file
from camring.files.shapes.drawing import read_drawing
from camring.files.shapes.given_curve import covered

RING = {"layer": "PITCH_CURVE"}
SPOILT = (
    *("", "nan", "inf", "-1", "0", "1e308", "999999999999", "5" * 200, "x", "É", "70", " 10"),
    *("ENDSEC", "SPLINE", "VERTEX"),
)
TRIES = 120


def drawn(place, add, change=lambda text: text):
    drawing = ezdxf.new("R2010")
    add(drawing.modelspace())
    drawing.saveas(place)
    place.write_text(change(place.read_text()))
    return place


def ring_of(read, place):
    """Number of points, or what was said."""
    try:
        curve, _ = covered(read(place, None), math.pi / 3, 1e-5)
    except InputError as error:
        return str(error)
    assert np.all(np.isfinite(curve.radii))
    return len(curve.radii)


@pytest.mark.parametrize(
    ("add", "said"),
    [
        (lambda space: None, "has curves on 0 layers"),
        (lambda space: space.add_lwpolyline([], dxfattribs=RING), "has curves on 0 layers"),
        (lambda space: space.add_lwpolyline([(1, 1)], dxfattribs=RING), "a curve without points"),
        (lambda space: space.add_spline(dxfattribs=RING), "a curve without points"),
        (lambda space: space.add_circle((0, 0), 0, dxfattribs=RING), "at or beyond the shaft"),
        (lambda space: space.add_circle((0, 0), math.nan, dxfattribs=RING), "one that is none"),
        (lambda space: space.add_circle((0, 0), 1e308, dxfattribs=RING), None),
        # It begins at the shaft, from where any step of it is seen as half a turn.
        (lambda space: space.add_arc((90, 0), 90, 180, 540, dxfattribs=RING), None),
    ],
)
def test_a_drawing_of_nothing_is_refused_in_a_sentence(tmp_path, add, said):
    found = ring_of(read_drawing, drawn(tmp_path / "ring.dxf", add))
    assert isinstance(found, str) or said is None
    assert said is None or said in str(found)


def test_a_drawing_in_no_unit_is_refused(tmp_path):
    for wrong in ("99", "-1"):
        place = drawn(
            tmp_path / "ring.dxf",
            lambda space: space.add_circle((0, 0), 90, dxfattribs=RING),
            lambda text, wrong=wrong: text.replace("$INSUNITS\n 70\n6", f"$INSUNITS\n 70\n{wrong}"),
        )
        assert f"is in a unit of number {wrong}" in str(ring_of(read_drawing, place))


def test_a_spoilt_drawing_is_a_ring_or_a_sentence(tmp_path):
    chance = random.Random(5)

    def add(space):
        corners = [(80, 0, 0.1), (0, 80, 0.1), (-80, 0, 0.1), (0, -80, 0.1)]
        space.add_spline([(90, 0), (0, 91), (-90, 0), (0, -91), (90, 0)], dxfattribs=RING)
        space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": "OTHER"})
        space.add_arc((0, 0), 70, 10, 300, dxfattribs=RING)

    whole = drawn(tmp_path / "whole.dxf", add).read_text().split("\n")
    first = whole.index("ENTITIES")
    refused = 0
    for _ in range(TRIES):
        lines = list(whole)
        for _ in range(chance.choice([1, 1, 2])):
            lines[chance.randrange(first, min(first + 260, len(lines)))] = chance.choice(SPOILT)
        if chance.random() < 0.15:
            lines = lines[: chance.randrange(first, len(lines))]
        place = tmp_path / "spoilt.dxf"
        place.write_text("\n".join(lines), encoding="utf-8")
        refused += isinstance(ring_of(read_drawing, place), str)
    assert refused > TRIES / 4


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "holds no points"),
        ("nan 0 0\n", "does not begin with a number"),
        ("90 0 0\n0 90 0\n1e400 0 0\n", "line 3 has a number beyond all others"),
        ("90 0 0\n90 1 1e400\n", "line 2 has a number beyond all others"),
        ("1,5 2,5 0\n", "has 5 numbers"),
        ("1 furlong 2\n", "has 'furlong'"),
    ],
)
def test_a_curve_file_of_nothing_is_refused_in_a_sentence(tmp_path, text, said):
    place = tmp_path / "ring.sldcrv"
    place.write_text(text)
    assert said.replace("'", '"') in str(ring_of(read_curve_file, place)).replace("'", '"')
