"""The server's life: a free port on this machine, a token, the browser, Ctrl-C."""

import asyncio
import secrets
import socket
import webbrowser
from collections.abc import Callable
from pathlib import Path

from camring.files.errors import InputError
from camring.files.motor.document import printable

LOOPBACK = "127.0.0.1"
TOKEN_BYTES = 24


def serve(place: Path, port: int | None, browser: bool, say: Callable[[str], None]) -> None:
    """Serves a motor file, or the motor files of a folder, until it is interrupted.

    Raises
    ------
    InputError
        When the place is neither, or the port is taken.
    """
    import uvicorn

    from camring.studio.app import application
    from camring.studio.live import Live

    folder, path = _opened(place)
    listening = _socket(port)
    number = listening.getsockname()[1]
    token = secrets.token_urlsafe(TOKEN_BYTES)
    address = f"http://{LOOPBACK}:{number}/?token={token}"
    config = uvicorn.Config(
        application(Live(folder, path), number, token),
        log_level="critical",
        access_log=False,
        ws="wsproto",
        ws_per_message_deflate=False,  # within one machine packing takes longer than sending
        http="h11",
        lifespan="on",
        timeout_graceful_shutdown=2,
        server_header=False,
    )
    say(f"{address}\nOpen this address in a browser on this machine. Ctrl-C ends the studio.")
    if browser:
        webbrowser.open(address)
    with listening:
        asyncio.run(uvicorn.Server(config).serve(sockets=[listening]))


def _opened(place: Path) -> tuple[Path, Path | None]:
    """The folder that is open, and the motor file in it if one is named."""
    shown = printable(place)
    if place.is_dir():
        return place.resolve(), None
    if not place.exists():
        raise InputError(
            shown,
            "does not exist",
            "name a motor file or a folder, or write one with `camring new`",
        )
    return place.resolve().parent, place.resolve()


def _socket(port: int | None) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((LOOPBACK, port or 0))
    except OSError as error:
        listening.close()
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            "--port", f"is {port}, which cannot be had ({reason})", "leave it out for a free one"
        ) from None
    listening.listen()  # a browser that is quicker than the server waits, and is not refused
    return listening
