"""Build the site: `python website/build.py`, or `python3 dev.py site`; look in out/site/html.

The pages of `docs/` and those that are made (gallery, public names, verbs, lists of parts) are put
together in out/site/pages, where Sphinx reads them. A warning of Sphinx ends it with 1.
"""

from __future__ import annotations

import argparse
import gc
import os
import re
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))
os.environ.setdefault("MPLBACKEND", "Agg")

from contents import contents, leaf  # noqa: E402
from gallery import write_gallery  # noqa: E402
from missing import missing  # noqa: E402
from reference import library, pages  # noqa: E402

from hybond.files.whole import write_whole  # noqa: E402

ELSEWHERE = {
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
"""Pages at the top of the repository, and what they are called in the site."""


def assemble(target: Path, examples: list[Path], *, units: bool = True) -> None:
    """Put all pages into a folder."""
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(ROOT / "docs", target, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    shutil.copytree(ROOT / "examples", target / "examples", ignore=shutil.ignore_patterns("*.py"))
    shutil.copytree(HERE / "_static", target / "_static")
    for name, page in ELSEWHERE.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        write_whole(target / page, text.replace("](docs/", "]("))
    for path in target.rglob("*.md"):  # examples lie beside the pages here
        text = path.read_text(encoding="utf-8")
        found = re.sub(r"\]\((?:\.\./)+examples/([\w.]+)\)", r"](/examples/\1)", text)
        if found != text:
            path.write_text(found, encoding="utf-8")
    for name, text in pages().items():
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(target / f"{name}.md", text)
    domains = sorted(page.stem for page in (target / "library").glob("*.md"))
    write_whole(target / "library" / "index.md", library(domains))
    for page in (target / "errors").glob("HB-*.md"):
        write_whole(page, leaf(page.read_text(encoding="utf-8"), "index.md", "All codes"))
    index = (target / "index.md").read_text(encoding="utf-8")
    write_whole(target / "index.md", f"{index}\n{contents()}")
    write_gallery(examples, target / "gallery", units=units)


def build(pages: Path, html: Path, *, bare: bool = False) -> int:
    """Return the exit code of Sphinx, for which a warning is a mistake."""
    from sphinx.cmd.build import build_main

    # all that is read stays: to look for garbage in it again and again takes a quarter of the time
    gc.freeze()
    gc.set_threshold(100_000, 50, 1000)
    words = ["-q", "-W", "-j", "2", "--keep-going", "-b", "html", "-c", str(HERE)]
    if bare:
        words += ["-D", "html_theme=basic", "-D", "searched=0"]
    return build_main([*words, str(pages), str(html)])


def main() -> int:
    """Build what is asked for; return an exit code."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--out", type=Path, default=ROOT / "out" / "site")
    words.add_argument("--examples", metavar="A,B", help="only these in the gallery")
    words.add_argument("--no-units", action="store_true", help="make no FMUs")
    words.add_argument("--bare", action="store_true", help="no theme and no search: a check")
    given = words.parse_args()
    files = sorted((ROOT / "examples").glob("*.toml"))
    if given.examples:
        files = [ROOT / "examples" / f"{name}.toml" for name in given.examples.split(",")]
    assemble(given.out / "pages", files, units=not given.no_units)
    html = given.out / "html"
    code = build(given.out / "pages", html, bare=given.bare)
    lacking = missing(html)
    for said in lacking:
        print(f"the site has no page for {said}", file=sys.stderr)
    if not code and not lacking:
        print(f"the site: {html / 'index.html'}")
    return code or bool(lacking)


if __name__ == "__main__":
    sys.exit(main())
