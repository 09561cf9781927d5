"""Single keys of a motor file set and taken out, as a person would."""

import tomllib

import pytest

from camring.files.raw_values import raw_value, with_raw_values

TEXT = """# A motor.
[motor]
bore = "30 mm"      # of the cylinders
lobes = 6

[motor.valve_plate]
# turned by hand
shift = "0.5 deg"

[[operating_points]]
speed = "300 rpm"
supply_pressure = "250 bar"  # absolute

[[operating_points]]
speed = "60 rpm"

[design_space]
"motor.bore" = ["29 mm", "31 mm"]
"""

CHANGES = [
    (("motor", "bore"), "31.5 mm"),
    (("motor", "pistons"), 8),
    (("motor", "valve_plate", "shift"), None),
    (("operating_points", 1, "speed"), "80 rpm"),
    (("operating_points", 0, "supply_pressure"), 3e7),
    (("design_space", "motor.bore"), None),
    (("design_space", "motor.valve_plate.shift"), ["-1 deg", "1 deg"]),
    (("envelope", "speed"), ["30 rpm", "300 rpm"]),
]


@pytest.mark.parametrize(("place", "value"), CHANGES, ids=lambda each: str(each)[:40])
def test_one_key_changes_and_nothing_else(place, value):
    before, after = tomllib.loads(TEXT), tomllib.loads(with_raw_values(TEXT, {place: value}))
    assert raw_value(after, place) == value
    for other, _ in CHANGES:
        if other != place:
            assert raw_value(after, other) == raw_value(before, other)


def test_comments_and_order_stay():
    changed = with_raw_values(TEXT, dict(CHANGES))
    for comment in ("# A motor.", "# of the cylinders", "# turned by hand", "# absolute"):
        assert comment in changed
    kept = [line for line in TEXT.splitlines() if line in changed.splitlines()]
    places = [changed.splitlines().index(line) for line in dict.fromkeys(kept) if line]
    assert places == sorted(places)


def test_what_is_set_and_taken_out_again_leaves_no_trace():
    place = ("motor", "valve_plate", "ramp")
    assert with_raw_values(with_raw_values(TEXT, {place: 0.3}), {place: None}) == TEXT


def test_an_inline_table_is_written_anew_rather_than_wrongly():
    text = with_raw_values('motor = { bore = "30 mm" }\n', {("motor", "bore"): "31 mm"})
    assert tomllib.loads(text) == {"motor": {"bore": "31 mm"}}
