"""Binary messages: a few words in JSON, then arrays of numbers as the page reads them in place.

Little endian: the length of the JSON text in bytes (4), the text padded with spaces so that
the arrays begin at a multiple of 8, then the arrays one after the other, Float32 each.
"""

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

Arrays = Mapping[str, np.ndarray]


def packed(kind: str, words: Mapping[str, Any], arrays: Arrays) -> bytes:
    """One message; `words` must be JSON without numbers that are not finite."""
    flat = {name: np.ascontiguousarray(each, dtype="<f4").ravel() for name, each in arrays.items()}
    head = {"type": kind, **words, "arrays": [[name, each.size] for name, each in flat.items()]}
    text = json.dumps(head, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-(len(text) + 4) % 8)
    return b"".join(
        [struct.pack("<I", len(text)), text, *(each.tobytes() for each in flat.values())]
    )


def kind_of(message: bytes) -> str:
    """What a message is, without its arrays."""
    return json.loads(message[4 : 4 + int.from_bytes(message[:4], "little")])["type"]


def unpacked(message: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The words and arrays of a message."""
    (length,) = struct.unpack_from("<I", message)
    head = json.loads(message[4 : 4 + length])
    arrays, start = {}, 4 + length
    for name, size in head["arrays"]:
        arrays[name] = np.frombuffer(message, "<f4", size, start)
        start += 4 * size
    return head, arrays
