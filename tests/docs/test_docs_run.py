"""What the pages show runs: Python blocks as programs, model files as models."""

from __future__ import annotations

import multiprocessing
import re
import shlex
import shutil
from pathlib import Path

import needs
import pytest
from docs_programs import run_program

import hybond as hb

ROOT = Path(__file__).parents[2]
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "coming_from").glob("*.md")),
]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)


def blocks(kind: str) -> list[tuple[str, int, str]]:
    return [
        (page.name, k, body)
        for page in PAGES
        for k, (found, body) in enumerate(FENCE.findall(page.read_text(encoding="utf-8")))
        if found == kind
    ]


MODELS = [b for b in blocks("toml") if re.match(r"(#[^\n]*\n)?hybond = 1\n", b[2])]
PROGRAMS = blocks("python")


def files_of(page: str, folder: Path) -> None:
    """Put the model files that a page names where its blocks look for them.

    A block whose first line is ``# name.toml`` is that file; the first model of a page that
    loads ``ball.toml`` is the ball.
    """
    (folder / "examples").mkdir()
    for example in (ROOT / "examples").glob("*.toml"):
        (folder / "examples" / example.name).write_bytes(example.read_bytes())
        (folder / example.name).write_bytes(example.read_bytes())
    shutil.copytree(ROOT / "examples" / "bifurcation", folder / "examples" / "bifurcation")
    (folder / "ball.toml").write_bytes((ROOT / "examples" / "bouncing_ball.toml").read_bytes())
    for found, _, body in MODELS:
        name = re.match(r"# (\w+\.toml)\n", body)
        if found == page and name:
            (folder / name[1]).write_text(body, encoding="utf-8")


@pytest.mark.parametrize(
    ("page", "k", "body"),
    [
        pytest.param(*block, marks=pytest.mark.c) if 'to="fmu"' in block[2] else block
        for block in PROGRAMS
    ],
    ids=[f"{p}-{k}" for p, k, _ in PROGRAMS],
)
def test_a_python_block_of_the_pages_runs(page: str, k: int, body: str, tmp_path: Path) -> None:
    files_of(page, tmp_path)
    if 'to="fmu"' in body:
        # what each compiler makes is tested in tests/export
        body = f"import os\n\nos.environ['CC'] = {shlex.join(needs.QUICK or [])!r}\n{body}"
    code, _, errors = run_program(body, tmp_path)
    assert code == 0, errors


@pytest.mark.parametrize(("page", "k", "body"), MODELS, ids=[f"{p}-{k}" for p, k, _ in MODELS])
def test_a_model_file_of_the_pages_loads_and_has_a_meaning(
    page: str, k: int, body: str, tmp_path: Path
) -> None:
    files_of(page, tmp_path)
    (tmp_path / "this.toml").write_text(body, encoding="utf-8")
    assert hb.load(tmp_path / "this.toml").flatten().nodes


@pytest.mark.parametrize("page", PAGES, ids=[p.name for p in PAGES])
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!https?:)([^)#]+)", text):
        assert (page.parent / target).exists(), target


def test_the_readme_shows_what_its_script_prints(tmp_path: Path) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    parts = re.search(r"^```python\n(.*?)^```\n.*?^```text\n(.*?)^```$", text, re.M | re.S)
    assert parts is not None
    assert run_program(parts[1], tmp_path) == (0, parts[2], "")


def test_programs_begin_where_hybond_is_imported(tmp_path: Path) -> None:
    """Else each of them imports it: the pages take twice as long, and nothing else tells."""
    code, _, errors = run_program("import sys\nassert 'docs_preloaded' in sys.modules\n", tmp_path)
    forks = "forkserver" in multiprocessing.get_all_start_methods()
    assert code == (0 if forks else 1), errors
