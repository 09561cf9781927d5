"""What waits for a page: the newest of what moves, and numbers before what is about them."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

from camring.studio.outbox import Outbox


def taken(*put):
    async def run():
        outbox = Outbox()
        for kind, message in put:
            outbox.put(kind, message)
        return await outbox.take()

    with ThreadPoolExecutor(1) as beside:  # the browser's tests hold a loop in this one
        return beside.submit(lambda: asyncio.run(run())).result()


def test_arrows_never_overtake_their_numbers():
    """Old ones wait already, and new ones take their place."""
    put = [("arrows", "old arrows"), ("frame", "frame"), ("model", "words"), ("arrows", "arrows")]
    assert taken(*put) == ["words", "frame", "arrows"]


def test_of_what_moves_only_the_newest_is_sent_and_every_word():
    put = [("error", 1), ("frame", 2), ("error", 3), ("frame", 4), ("envelope", 5), ("envelope", 6)]
    assert taken(*put) == [1, 3, 4, 6]
