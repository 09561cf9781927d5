"""What differs between motors, in digits that people read."""

from camring.presentation.comparison import _rounded


def test_a_found_number_is_shown_with_six_digits():
    assert _rounded(["28.4 deg", "27.70709615945816 deg"]) == ["28.4 deg", "27.7071 deg"]
    assert _rounded(["", "-1.0474159605801105 deg"]) == ["", "-1.04742 deg"]
    assert _rounded(["a list of 16", "1.60000000e-13"]) == ["a list of 16", "1.60000000e-13"]


def test_numbers_that_differ_by_less_keep_their_digits():
    near = ["27.70709615945816 deg", "27.70709615945817 deg"]
    assert _rounded(near) == near
