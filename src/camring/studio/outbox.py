"""What waits to be sent to one page: of numbers that move only the newest."""

import asyncio
from typing import Any

_MOVING = ("frame", "before", "envelope", "before envelope", "arrows", "study")
"""In the order in which they are sent: numbers first, then what is about them."""


class Outbox:
    """Filled and emptied in the server's loop."""

    def __init__(self) -> None:
        self._newest: dict[str, Any] = {}
        self._rest: list[Any] = []
        self._filled = asyncio.Event()

    def put(self, kind: str, message: Any) -> None:
        """In place of one of the same kind that waits, where the kind moves."""
        if kind in _MOVING:
            self._newest[kind] = message
        else:
            self._rest.append(message)
        self._filled.set()

    async def take(self) -> list[Any]:
        """All that waits, words first: a frame may need what the words say."""
        await self._filled.wait()
        self._filled.clear()
        found = [*self._rest, *(self._newest[kind] for kind in _MOVING if kind in self._newest)]
        self._rest, self._newest = [], {}
        return found
