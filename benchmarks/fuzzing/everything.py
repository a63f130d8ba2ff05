"""All readers."""

from __future__ import annotations

from fuzzing import command, page, readers, running

READERS = {
    **readers.READERS,
    "page": page.page,
    "page-journal": page.journal,
    "command": command.command,
    "run": running.run,
    "shown": running.shown,
}
