"""Checksums of what a database keeps, over the very bytes that it holds."""

import hashlib
import struct
from typing import TypeAlias

Cell: TypeAlias = bytes | str | int | float | None

SIZE = 16  # bytes; one damage in 3e38 would go unseen
_FLOAT = struct.Struct("<d")
_LENGTH = struct.Struct("<cI")


def checksum(*cells: Cell) -> bytes:
    """Of values with their types and lengths, so that no two different rows share one text.

    Text counts by its UTF-8, as SQLite keeps it: a row read as bytes needs no decoding first.
    """
    parts = []
    for cell in cells:
        kind, content = _plain(cell)
        parts += [_LENGTH.pack(kind, len(content)), content]
    return hashlib.blake2b(b"".join(parts), digest_size=SIZE).digest()


def _plain(cell: Cell) -> tuple[bytes, bytes]:
    if isinstance(cell, bytes):
        return b"b", cell
    if isinstance(cell, str):
        return b"b", cell.encode("utf-8", "surrogatepass")
    if isinstance(cell, int):
        return b"i", b"%d" % cell
    if isinstance(cell, float):
        return b"f", _FLOAT.pack(cell)
    return b"n", b""
