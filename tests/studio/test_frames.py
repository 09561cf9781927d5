"""Binary messages."""

import numpy as np

from camring.studio.frames import packed, unpacked


def test_what_is_packed_comes_out_again():
    arrays = {"a": np.linspace(0, 1, 7), "none": np.zeros(0), "b": np.arange(6).reshape(2, 3)}
    head, found = unpacked(packed("frame", {"number": 3, "fault": "ü"}, arrays))
    assert (head["type"], head["number"], head["fault"]) == ("frame", 3, "ü")
    for name, array in arrays.items():
        np.testing.assert_allclose(found[name], array.ravel(), rtol=1e-7)


def test_arrays_begin_where_a_page_can_read_them_in_place():
    for words in ({}, {"a": 1}, {"a": "xy"}, {"a": "xyz"}):
        message = packed("frame", words, {"a": np.zeros(1)})
        assert (4 + int.from_bytes(message[:4], "little")) % 8 == 0
