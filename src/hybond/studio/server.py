"""The studio in the browser: a server for this machine alone.

It listens on the loopback address, and answers only who knows the token in the address it prints.
The names that a browser says it talks to and comes from are checked, so that no page of another
origin can speak to it.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
import socket
from pathlib import Path
from typing import Any

from hybond.errors import UsageError
from hybond.studio.session import Session

PAGE = Path(__file__).parent / "page"
LARGEST = 20 * 2**20
"""Bytes of one message: more than the largest model file."""
CLIENTS = 32
"""Pages open at once."""
GLANCE = 1.0
"""Seconds between two glances at the file, which another program may have written."""
QUEUE = 1000
"""Messages that wait for a page that does not read; then it is let go."""
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self' "
    "'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
}


def application(session: Session, token: str, names: set[str]) -> Any:
    """Return the ASGI application of a session.

    Parameters
    ----------
    token : str
        What a page must know.
    names : set of str
        ``host:port`` as which the server may be addressed.
    """
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import FileResponse, PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocket, WebSocketDisconnect

    pages = 0

    def foreign(headers: Any, *, origin: bool) -> bool:
        if headers.get("host") not in names:
            return True
        said = headers.get("origin")
        return origin and said not in {f"http://{n}" for n in names}

    async def page(request: Request) -> Response:
        if foreign(request.headers, origin=False):
            return PlainTextResponse("HB-W106: not addressed as this server", 421)
        given = request.query_params.get("token", "")
        if not secrets.compare_digest(given.encode(), token.encode()):
            return PlainTextResponse(
                "HB-W106: this address lacks the token that 'hybond studio' printed", 403
            )
        return FileResponse(PAGE / "index.html", headers=_HEADERS)

    async def asset(request: Request) -> Response:
        name = request.path_params["name"]
        file = PAGE / name
        if name not in {p.name for p in PAGE.iterdir()} or foreign(request.headers, origin=False):
            return PlainTextResponse("not here", 404)
        return FileResponse(file, headers=_HEADERS)

    async def talk(socket: WebSocket) -> None:
        nonlocal pages
        given = socket.query_params.get("token", "")
        right = secrets.compare_digest(given.encode(), token.encode())
        if foreign(socket.headers, origin=True) or not right or pages >= CLIENTS:
            await socket.close(4403, "HB-W106")
            return
        await socket.accept()
        pages += 1
        loop = asyncio.get_running_loop()
        waiting: asyncio.Queue[dict[str, Any] | str] = asyncio.Queue(QUEUE)

        def put(message: dict[str, Any]) -> None:
            with contextlib.suppress(asyncio.QueueFull):
                waiting.put_nowait(message)

        def told(message: dict[str, Any]) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended, the run has not
                loop.call_soon_threadsafe(put, message)

        stop = session.listen(told)

        async def send() -> None:
            while True:
                message = await waiting.get()
                try:
                    text = message if isinstance(message, str) else dumped(message)
                    await socket.send_text(text)
                finally:
                    waiting.task_done()

        def answered(message: dict[str, Any]) -> str:
            return dumped(session.handle(message))

        async def watch() -> None:
            while True:
                await asyncio.sleep(GLANCE)
                if session.document.glance():  # to look at it tells all pages what is new
                    await asyncio.to_thread(session.handle, {"ask": "look"})

        watching = asyncio.create_task(watch())
        sending = asyncio.create_task(send())
        try:
            while True:
                message = read(await socket.receive_text())
                await waiting.put(await asyncio.to_thread(answered, message))
                # the page has its answer before the text of the file takes the processor
                read_out = asyncio.ensure_future(waiting.join())
                await asyncio.wait({read_out, sending}, timeout=1, return_when="FIRST_COMPLETED")
                read_out.cancel()
                await asyncio.to_thread(session.settle)
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            pages -= 1
            stop()
            sending.cancel()
            watching.cancel()

    return Starlette(
        routes=[
            Route("/", page),
            Route("/assets/{name}", asset),
            WebSocketRoute("/talk", talk),
        ]
    )


def dumped(message: dict[str, Any]) -> str:
    """Return a message as JSON without what JSON does not have."""
    try:
        return json.dumps(message, allow_nan=False, default=str)
    except ValueError:
        return json.dumps(_finite(message), default=str)


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if abs(value) < float("inf") else None
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return value


def read(text: str) -> dict[str, Any]:
    """Return a message; what is none is one that nobody understands.

    Examples
    --------
    >>> read('{"ask": "look"}'), read("[1]"), read("{")
    ({'ask': 'look'}, {}, {})
    """
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return message if isinstance(message, dict) else {}


def listening(port: int) -> socket.socket:
    """Return a socket on the loopback address, on any port if `port` is 0.

    Raises
    ------
    UsageError
        HB-W107 if the port is taken.
    """
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind(("127.0.0.1", port))
        found.listen()  # a page that comes before the server runs waits for it
    except (OSError, OverflowError) as error:
        found.close()
        why = getattr(error, "strerror", None) or error
        raise UsageError(
            f"cannot listen on port {port}: {why}",
            code="HB-W107",
            where="--port",
            hint="leave it out: any free port is taken",
        ) from None
    return found


def server(session: Session, found: socket.socket, token: str) -> Any:
    """Return what serves a session on a socket: a server of uvicorn."""
    import uvicorn

    port = found.getsockname()[1]
    names = {f"127.0.0.1:{port}", f"localhost:{port}"}
    config = uvicorn.Config(
        application(session, token, names),
        log_level="error",
        ws_max_size=LARGEST,
        ws_max_queue=64,
        lifespan="off",
        timeout_graceful_shutdown=1,
    )
    return uvicorn.Server(config)


def serve(session: Session, found: socket.socket, token: str) -> None:
    """Serve a session until the program is interrupted."""
    try:
        server(session, found, token).run(sockets=[found])
    finally:
        session.close()
