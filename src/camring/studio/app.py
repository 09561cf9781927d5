"""The addresses of the server: the page, its parts, the conversation, downloads, reports."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp

from camring.files.errors import CamringError
from camring.studio.guard import Guard
from camring.studio.live import Live

PAGE = Path(__file__).parent / "page"
REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data:"
)
"""A report is a page of its own: it may draw, and reach nothing."""


def application(live: Live, port: int, token: str) -> ASGIApp:
    """The guarded server of one folder."""

    async def index(_: Request) -> Response:
        return FileResponse(PAGE / "index.html", media_type="text/html")

    async def download(request: Request) -> Response:
        from camring.studio.downloads import made

        if live.actions is None:
            return PlainTextResponse("Still loading.", 503)
        file = live.actions.session.opened.file
        try:
            name, content = await asyncio.to_thread(made, request.path_params["name"], file)
        except CamringError as error:
            return PlainTextResponse(str(error), 400)
        attached = f"attachment; filename*=UTF-8''{quote(name)}"
        return Response(content, headers={"content-disposition": attached})

    async def report(request: Request) -> Response:
        from camring.studies.study_folder import REPORT_NAME
        from camring.studio.inside_folder import inside

        try:
            path = inside(live.folder, f"{request.path_params['study']}/{REPORT_NAME}")
        except CamringError as error:
            return PlainTextResponse(str(error), 400)
        if not path.is_file():
            return PlainTextResponse("This study has no report yet.", 404)
        return FileResponse(
            path, media_type="text/html", headers={"content-security-policy": REPORT_POLICY}
        )

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        await live.start()
        yield
        await live.stop()

    routes = [
        Route("/", index),
        Route("/download/{name}", download),
        Route("/report/{study}", report),
        WebSocketRoute("/live", live.page),
        Mount("/page", StaticFiles(directory=PAGE)),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), port, token)
