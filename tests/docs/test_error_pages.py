"""Every refusal has a page, every page a refusal, and its example is refused with that code."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest
from listed import listed

import hybond as hb
from hybond.cli.main import main

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "errors"
CODE = re.compile(r"HB-[A-Z]\d{3}")
FENCE = re.compile(r"^```(toml|python|console)\n(.*?)^```$", re.M | re.S)


def codes_in_source() -> set[str]:
    files = (ROOT / "src").rglob("*.py")
    return {code for f in files for code in CODE.findall(f.read_text(encoding="utf-8"))}


def pages() -> dict[str, Path]:
    return {p.stem: p for p in sorted(PAGES.glob("HB-*.md"))}


def examples() -> list[tuple[str, str, str]]:
    return [
        (code, kind, body)
        for code, page in pages().items()
        for kind, body in FENCE.findall(page.read_text(encoding="utf-8"))
    ]


def test_every_code_has_a_page() -> None:
    assert sorted(codes_in_source() - set(pages())) == []


def test_every_page_has_a_code() -> None:
    assert sorted(set(pages()) - codes_in_source()) == []


def test_the_index_lists_every_page() -> None:
    listed = re.findall(r"\((HB-[A-Z]\d{3})\.md\)", (PAGES / "index.md").read_text("utf-8"))
    assert sorted(listed) == sorted(pages())


@listed("code", sorted(pages()))
def test_a_page_says_its_code_and_what_to_do(code: str) -> None:
    text = pages()[code].read_text(encoding="utf-8")
    assert text.startswith(f"# {code}: ")
    assert "\n## What to do\n\n- " in text


def refusal_of(kind: str, body: str, folder: Path) -> str:
    """Return the code with which the example of a page is refused."""
    if kind == "console":
        for line in body.splitlines():
            command, *words = shlex.split(line.removeprefix("$ "))
            if command == "mkdir":
                (folder / words[0]).mkdir()
                continue
            assert command == "hybond"
            said = io.StringIO()
            with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
                main(words)
        found = CODE.match(said.getvalue())
        return found[0] if found else said.getvalue()
    try:
        if kind == "toml":
            model = hb.loads(body)
            model.flatten()
            if hints := [h.code for h in model.check()]:
                assert len(hints) == 1
                if hints[0].startswith("HB-H") and "until" not in model.experiment:
                    return hints[0]
            if "until" in model.experiment:
                hb.simulate(model)
        else:
            exec(compile(body, "example", "exec"), {})
    except hb.HybondError as error:
        return error.code
    return "nothing"


@pytest.mark.parametrize(("code", "kind", "body"), examples(), ids=lambda a: str(a)[:9])
def test_the_example_of_a_page_is_refused_with_its_code(
    code: str, kind: str, body: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    # of a signal that is too rough a million pieces say what some say
    monkeypatch.setattr("hybond.measures.pieces.LIMIT", 20_000)
    assert refusal_of(kind, body, tmp_path) == code
