"""What the end of a study says beside its tables' plain numbers."""

import math

from camring.presentation.study import LIFE, SHOWN, _margin, _shown


def test_a_margin_on_its_limit_has_no_minus():
    assert _margin(0.0) == "+0 %"
    assert _margin(-0.25) == "+25 %"
    assert _margin(0.01) == "[red]−1 %[/]"
    assert _margin(math.nan) == "–"


def test_life_is_shown_where_there_is_one():
    """Not of rollers without a rated load, and not of an evaluation from before there was life."""
    assert _shown({LIFE: 3e7}) == list(SHOWN)
    without = [name for name in SHOWN if name != LIFE]
    assert _shown({LIFE: math.inf}) == _shown({}) == without
