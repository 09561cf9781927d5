"""Who may speak to the server: this machine's own page with its token, and nobody else.

Any page in the same browser can send requests to a server on this machine, and any name can
be made to lead here. So a request must name this server as its host, must not come from a
page of another origin, and must carry the token of the printed address, which no other page
can read.
"""

import secrets
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlencode

from starlette.responses import PlainTextResponse, RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
"""The page may load what this server gives and nothing from anywhere else."""

HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)


class Guard:
    """Lets a request through or answers it with 403.

    Parameters
    ----------
    port
        On which the server listens.
    token
        That every request must carry, in its address or in the cookie that the first one sets.
    """

    def __init__(self, app: ASGIApp, port: int, token: str) -> None:
        self._app, self._token = app, token
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._origins = {f"http://{host}" for host in self._hosts}
        self._cookie = f"camring-{port}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {
            name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]
        }
        asked = parse_qs(scope["query_string"].decode("latin-1"))
        reason = self._refusal(scope["type"], headers, asked)
        if reason is not None:
            await _refuse(scope, receive, send, reason)
        elif scope["type"] == "http" and "token" in asked:
            # Into a cookie, so that it stands neither in the page's address nor in its history.
            rest = urlencode({name: each for name, each in asked.items() if name != "token"}, True)
            away = RedirectResponse(scope["path"] + (f"?{rest}" if rest else ""), 303)
            away.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            await away(scope, receive, self._headed(send))
        else:
            await self._app(scope, receive, self._headed(send))

    def _refusal(
        self, kind: str, headers: dict[str, str], asked: dict[str, list[str]]
    ) -> str | None:
        if headers.get("host") not in self._hosts:
            return "This server answers under its own name only."
        origin = headers.get("origin")
        if origin is not None and origin not in self._origins:
            return "This server answers its own page only."
        if origin is None and kind == "websocket":
            return "A connection must say from which page it comes."
        given = asked.get("token", [self._from_cookie(headers.get("cookie", ""))])[0]
        if not secrets.compare_digest(given.encode(), self._token.encode()):
            return "The address lacks its token: open the one that `camring studio` has printed."
        return None

    def _from_cookie(self, text: str) -> str:
        try:
            found = SimpleCookie(text).get(self._cookie)
        except CookieError:
            return ""
        return "" if found is None else found.value

    def _headed(self, send: Send) -> Send:
        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                given = list(message.get("headers", []))
                known = {name.lower() for name, _ in given}
                more = [each for each in HEADERS if each[0] not in known]
                message = {**message, "headers": [*given, *more]}
            await send(message)

        return sent


async def _refuse(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
    else:
        await PlainTextResponse(reason, 403)(scope, receive, send)
