"""The page that is in the package is the one that its sources make, and small enough."""

from __future__ import annotations

import gzip
import hashlib
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "studio-ui"
PAGE = ROOT / "src" / "hybond" / "studio" / "page"


def test_the_built_page_was_made_of_these_sources() -> None:
    digest = hashlib.sha256()
    names = ["index.html", "package-lock.json", "vite.config.ts", "vite.widget.config.ts"]
    names += [f"src/{p.name}" for p in sorted((SOURCES / "src").iterdir(), key=lambda p: p.name)]
    for name in names:
        text = (SOURCES / name).read_text(encoding="utf-8")
        digest.update(f"{name}\n{text}".encode())
    told = (PAGE / "sources.txt").read_text().strip()
    assert digest.hexdigest() == told, "npm ci && npm run build in studio-ui/"


def test_the_page_is_under_400_kilobytes_compressed() -> None:
    files = [p for p in PAGE.iterdir() if p.stem == "studio" or p.suffix == ".html"]
    assert len(files) == 3
    assert sum(len(gzip.compress(p.read_bytes())) for p in files) < 400_000


def test_the_page_asks_nobody_else() -> None:
    for file in PAGE.iterdir():
        text = file.read_text(encoding="utf-8")
        for word in ("https://", "http://"):
            outside = text.split(word)[1:]
            assert all(o.startswith(("www.w3.org/", "react")) for o in outside), (file, outside[:1])
