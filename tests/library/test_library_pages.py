"""The pages of the library and their drawings are those of its files."""

import importlib.util
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType

import pytest
from part_sheets import sheet_of

import hybond as hb

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
DOMAINS = sorted({name.partition(".")[0] for name in hb.library.names()})


def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_library", DOCS / "make_library.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def made() -> dict[str, Callable[[], str]]:
    return {path.as_posix(): make for path, make in maker().pages(sheet_of).items()}


def stale(pages: Iterable[str], made: dict[str, Callable[[], str]]) -> list[str]:
    return [p for p in pages if (DOCS / p).read_text(encoding="utf-8") != made[p]()]


def test_the_pages_are_fresh(made: dict[str, Callable[[], str]]) -> None:
    pages = [p for p in made if p.endswith(".md")]
    assert not stale(pages, made), "run: python docs/make_library.py"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("domain", DOMAINS)
def test_the_drawings_of_a_domain_are_fresh(
    domain: str, made: dict[str, Callable[[], str]]
) -> None:
    mine = [p for p in made if f"/library/{domain}_" in p]
    assert not stale(mine, made), "run: python docs/make_library.py"


def test_no_page_is_left_of_a_part_that_is_gone(made: dict[str, Callable[[], str]]) -> None:
    there = [*DOCS.glob("library/*"), *DOCS.glob("img/library/*")]
    assert {p.relative_to(DOCS).as_posix() for p in there} == set(made)


@pytest.mark.parametrize("domain", DOMAINS)
def test_links_lead_somewhere(domain: str) -> None:
    page = DOCS / "library" / f"{domain}.md"
    for target in re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), target


def test_the_entry_page_names_every_domain() -> None:
    text = (DOCS / "library.md").read_text(encoding="utf-8")
    assert [d for d in DOMAINS if f"(library/{d}.md)" not in text] == []
