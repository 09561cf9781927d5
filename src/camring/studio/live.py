"""The conversation with the pages: one WebSocket each, all on the same open motor."""

import asyncio
import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from camring.files.errors import CamringError
from camring.studio.frames import kind_of
from camring.studio.outbox import Outbox

if TYPE_CHECKING:
    from camring.studio.actions import Actions
    from camring.studio.engine import Engine

LARGEST_MESSAGE = 300_000  # characters that a page may send at once
READY_WORDS = "Loading the simulation."


class Live:
    """Pages on one side, the engine on the other.

    What loads JAX is imported in a thread, so that the page is there before it.
    """

    def __init__(self, folder: Path, path: Path | None) -> None:
        self.folder, self.path = folder, path
        self._pages: dict[int, Outbox] = {}
        self._count = 0
        self._ready = asyncio.Event()
        self._failed = ""
        self.engine: Engine | None = None
        self.actions: Actions | None = None

    async def start(self) -> None:
        """Begins to load; returns at once."""
        self._loop = asyncio.get_running_loop()
        self._starting = asyncio.create_task(self._load())

    async def _load(self) -> None:
        try:
            self.engine, self.actions = await asyncio.to_thread(self._made)
        except Exception as error:
            self._failed = str(error)
            self._to_all("error", {"type": "error", "sentence": self._failed})
            return
        self._ready.set()

    def _made(self) -> Any:
        from camring.studio.actions import Actions
        from camring.studio.engine import Engine

        engine = Engine(self._post)
        engine.start()
        making = engine.run(lambda: Actions(self.folder, self.path, engine, self._say))
        return engine, making.result()

    async def stop(self) -> None:
        if self.actions is not None:
            await asyncio.to_thread(self.actions.end)
        if self.engine is not None:
            self.engine.stop()

    # -- to the pages, from any thread -------------------------------------------------------

    def _post(self, message: bytes) -> None:
        kind = kind_of(message)
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._to_all, kind, message)

    def _say(self, message: dict[str, Any]) -> None:
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._to_all, message["type"], message)

    def _to_all(self, kind: str, message: Any) -> None:
        for each in self._pages.values():
            each.put(kind, message)

    # -- from a page -------------------------------------------------------------------------

    async def page(self, websocket: WebSocket) -> None:
        """One page, from its opening to its closing."""
        await websocket.accept()
        self._count += 1
        number, outbox = self._count, Outbox()
        self._pages[number] = outbox
        sender = asyncio.create_task(_send(websocket, outbox))
        try:
            await self._greet(outbox)
            while True:
                text = await websocket.receive_text()
                if len(text) <= LARGEST_MESSAGE:
                    await self._act(json.loads(text), outbox)
        except (WebSocketDisconnect, RuntimeError, ValueError, asyncio.CancelledError):
            pass  # the page is gone, or the server ends
        finally:
            del self._pages[number]
            sender.cancel()

    async def _greet(self, outbox: Outbox) -> None:
        if self._failed:
            outbox.put("error", {"type": "error", "sentence": self._failed})
        elif not self._ready.is_set():
            outbox.put("loading", {"type": "loading", "sentence": READY_WORDS})
        await self._ready.wait()
        assert self.actions is not None
        await self._run(self.actions.greet, outbox)

    async def _act(self, message: Any, outbox: Outbox) -> None:
        if not isinstance(message, dict) or self.actions is None or self.engine is None:
            return
        actions = self.actions
        if message.get("op") == "move":
            self.engine.follow(lambda: actions.session.asked(message))
            return
        await self._run(lambda: actions.act(message), outbox, message)

    async def _run(
        self,
        function: Callable[[], list[tuple[str, Any]]],
        outbox: Outbox,
        message: dict[str, Any] | None = None,
    ) -> None:
        """On the engine's thread; what comes back goes to this page or, as news, to all."""
        assert self.engine is not None
        try:
            answers = await asyncio.wrap_future(self.engine.run(function))
        except CamringError as error:
            answers = [("here", {"type": "error", "sentence": str(error), "of": message})]
        except Exception as error:
            sentence = f"{type(error).__name__}: {error}. This is a fault of camring, not yours."
            answers = [("here", {"type": "error", "sentence": sentence, "of": message})]
        for whom, answer in answers:
            kind = answer["type"] if isinstance(answer, dict) else kind_of(answer)
            if whom == "here":
                outbox.put(kind, answer)
            else:
                self._to_all(kind, answer)


async def _send(websocket: WebSocket, outbox: Outbox) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            for message in await outbox.take():
                if isinstance(message, bytes):
                    await websocket.send_bytes(message)
                else:
                    await websocket.send_text(json.dumps(message))
