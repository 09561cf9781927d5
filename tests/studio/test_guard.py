"""Who may speak to the server."""

import asyncio
import socket

import pytest

from camring.studio import serve
from camring.studio.guard import Guard

PORT, TOKEN = 8123, "the-token"
HOME, HOST = "http://127.0.0.1:8123", "127.0.0.1:8123"


async def answering(scope, receive, send):
    if scope["type"] == "websocket":
        await send({"type": "websocket.accept"})
        return
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"inside"})


def asked(kind="http", query="", **headers):
    """What the guard sends for a request."""
    sent = []

    async def send(message):
        sent.append(message)

    async def receive():
        return {"type": "http.request"}

    scope = {
        "type": kind,
        "method": "GET",
        "path": "/",
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    asyncio.run(Guard(answering, PORT, TOKEN)(scope, receive, send))
    return sent


def status(sent):
    return sent[0].get("status", sent[0]["type"])


def headers_of(sent):
    return {name.decode(): value.decode() for name, value in sent[0]["headers"]}


COOKIE = f"camring-{PORT}={TOKEN}"


def test_the_token_lets_in_and_moves_from_the_address_into_a_cookie():
    sent = asked(query=f"token={TOKEN}", host=HOST)
    found = headers_of(sent)
    assert status(sent) == 303
    assert TOKEN not in found["location"]
    assert TOKEN in found["set-cookie"]
    assert "httponly" in found["set-cookie"].lower()
    assert "samesite=strict" in found["set-cookie"].lower()
    assert status(asked(host=HOST, cookie=COOKIE)) == 200


@pytest.mark.parametrize(
    "given",
    [
        dict(host=HOST),
        dict(host=HOST, query="token=another"),
        dict(host=HOST, cookie="camring-8123=another"),
        dict(host=HOST, cookie=f"camring-1={TOKEN}"),
        dict(host="evil.example:8123", cookie=COOKIE),
        dict(host="127.0.0.1:9", cookie=COOKIE),
        dict(cookie=COOKIE),
        dict(host=HOST, cookie=COOKIE, origin="http://evil.example"),
        dict(host=HOST, cookie=COOKIE, origin="null"),
        dict(host=HOST, cookie=COOKIE, origin="https://127.0.0.1:8123"),
    ],
    ids=str,
)
def test_whoever_lacks_token_host_or_origin_stays_outside(given):
    assert status(asked(**given)) == 403
    assert asked(kind="websocket", **{"origin": HOME, **given})[0]["type"] == "websocket.close"


def test_a_connection_must_say_from_where_it_comes():
    assert status(asked("websocket", host=HOST, cookie=COOKIE)) == "websocket.close"
    assert status(asked("websocket", host=HOST, cookie=COOKIE, origin=HOME)) == "websocket.accept"


def test_the_page_may_load_from_this_server_alone():
    found = headers_of(asked(host=HOST, cookie=COOKIE))
    assert found["content-security-policy"].startswith("default-src 'self';")
    assert found["x-content-type-options"] == "nosniff"
    assert found["referrer-policy"] == "no-referrer"


def test_a_browser_that_is_quicker_than_the_server_waits_and_is_not_refused():
    with serve._socket(None) as listening:
        socket.create_connection(listening.getsockname(), timeout=5).close()
