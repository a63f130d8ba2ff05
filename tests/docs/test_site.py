"""The site lists every page; that it builds without a warning is a stage of `.ci/run`."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "website"))

from contents import GROUPS  # noqa: E402
from missing import missing  # noqa: E402

MADE = {"reference/verbs", "reference/index", "library/index", "gallery/index"}
FROM_THE_TOP = {"contributing", "changelog"}


def test_each_page_of_the_docs_is_in_the_contents_once() -> None:
    listed = [page for pages in GROUPS.values() for page in pages]
    docs = ROOT / "docs"
    written = {p.relative_to(docs).with_suffix("").as_posix() for p in docs.rglob("*.md")}
    written -= {p for p in written if p.startswith(("errors/HB-", "library/"))}
    assert sorted(listed) == sorted(written - {"index"} | MADE | FROM_THE_TOP)


def test_a_site_without_a_page_is_told(tmp_path: Path) -> None:
    lacking = missing(tmp_path)
    assert {"hb.simulate", "hybond run", "electrical.diode", "HB-C101", "hb.export"} <= set(lacking)
    (tmp_path / "reference").mkdir()
    page = tmp_path / "reference" / "simulate.html"
    page.write_text('<dt id="hybond.simulate">', encoding="utf-8")
    assert "hb.simulate" not in missing(tmp_path)


@pytest.mark.parametrize("name", ["simulate", "Model"])
def test_a_page_of_a_public_name_is_made_of_its_docstring(name: str) -> None:
    from reference import public

    assert f":: hybond.{name}" in public(name)
