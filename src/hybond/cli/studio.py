"""``hybond studio``: draw, run and look at models in the browser."""

from __future__ import annotations

import secrets
import webbrowser
from argparse import Namespace
from pathlib import Path

from hybond.cli.streams import say
from hybond.errors import UsageError


def studio(given: Namespace) -> int:
    """Open the studio on a file, and serve it until Ctrl-C.

    Raises
    ------
    UsageError
        HB-W107 for a port that is taken, HB-W108 if what serves pages is not installed.
    """
    try:
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
        import websockets  # noqa: F401
    except ImportError as error:
        raise UsageError(
            f"the studio needs {error.name}",
            code="HB-W108",
            where="hybond studio",
            hint="pip install 'hybond[studio]'",
        ) from None
    from hybond.studio.server import listening, serve
    from hybond.studio.session import Session

    file = None if given.file is None else Path(given.file)
    socket = listening(given.port)
    session = Session(file)
    token = secrets.token_urlsafe(18)
    address = f"http://127.0.0.1:{socket.getsockname()[1]}/?token={token}"
    say(f"hybond studio: {address}")
    say("Ctrl-C ends it; each edit is in the file at once.")
    if not given.no_browser:
        webbrowser.open(address)
    serve(session, socket, token)
    return 0
