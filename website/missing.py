"""What a reader may look up and the built site has no page for."""

from __future__ import annotations

import re
from pathlib import Path

import hybond as hb
from hybond.cli.arguments import VERBS

CODE = re.compile(r"HB-[A-Z]\d{3}")


def missing(html: Path) -> list[str]:
    """Return public names, verbs, parts and codes that no page of the site is about.

    Parameters
    ----------
    html : Path
        The folder that Sphinx wrote.
    """
    source = Path(hb.__file__).parent
    codes = {c for f in source.rglob("*.py") for c in CODE.findall(f.read_text(encoding="utf-8"))}
    names = [n for n in hb.__all__ if not n.startswith("_")]
    wanted = {f"hb.{n}": (f"reference/{n}.html", f'id="{_home(n)}"') for n in names}
    wanted |= {f"hybond {v}": ("reference/verbs.html", f'id="hybond-{v}"') for v in VERBS}
    for part in hb.library.names():
        domain, _, name = part.partition(".")
        wanted[part] = (f"library/{domain}.html", f'id="{domain}{name}"')
    wanted |= {code: (f"errors/{code}.html", "<h1>") for code in codes}
    texts: dict[str, str] = {}
    lacking = []
    for what, (page, mark) in sorted(wanted.items()):
        if page not in texts:
            path = html / page
            texts[page] = path.read_text(encoding="utf-8") if path.exists() else ""
        if mark not in texts[page]:
            lacking.append(what)
    return lacking


def _home(name: str) -> str:
    """Return the mark of a public name: rooms are modules, which Sphinx marks in its own way."""
    return f"module-hybond.{name}" if name in hb._ROOMS else f"hybond.{name}"
