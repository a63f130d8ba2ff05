"""Small portable programs say the same in CPython, in C and in Java, to the last digit."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import subprocess
from pathlib import Path

import needs
import pytest

from hybond.engine.compiled.sources import portable_paths
from hybond.export.program import LOG_OR_REPORT
from hybond.translate import Program, load_texts
from hybond.translate.c_printer import CPrinter
from hybond.translate.c_words import HEADERS, c_words
from hybond.translate.java_printer import JavaPrinter
from hybond.translate.java_words import IMPORTS, java_words

SAMPLES = sorted((Path(__file__).parent / "samples").glob("*.py"))
OTHERS = ("engine/words", "run/log", "looking/")
"""What the subset is made of, and what only the library has."""
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]

MAIN = """
static int run(Arena *arena)
{
    if (setjmp(arena->spent) != 0) {
        return 3;
    }
    report(@GIVEN@);
    return 0;
}

int main(void)
{
    Arena arena;
    memset(&arena, 0, sizeof(arena));
    const int code = run(&arena);
    release(&arena);
    return code;
}
"""


def program_of(path: Path) -> Program:
    texts = {
        p.stem: p.read_text("utf-8").replace(*LOG_OR_REPORT)
        for p in portable_paths()
        if not any(other in p.as_posix() for other in OTHERS)
    }
    # a name that no module of the engine has
    return load_texts({f"sample_{path.stem}": path.read_text("utf-8"), **texts})


def said_by_python(path: Path) -> str:
    spec = importlib.util.spec_from_file_location(f"sample_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        module.report()
    return out.getvalue()


def as_c(program: Program) -> str:
    printer = CPrinter(program, ["report"])
    lines = [f"#include <{h}>" for h in HEADERS]
    lines += [*c_words(printer.reached.words, finding=printer.finds_arena), *printer.typedefs()]
    for module in program.modules:
        if printer.needed(module):
            lines += printer.chapter(module)
    given = "arena" if "report" in printer.effects.makers else ""
    lines += [MAIN.replace("@GIVEN@", given)]
    return "\n".join(lines) + "\n"


def as_java(program: Program, name: str) -> str:
    printer = JavaPrinter(program, ["report"])
    lines = [f"import {i};" for i in IMPORTS]
    lines += [f"final class {name} {{", "static PrintStream out = System.out;"]
    lines += java_words(printer.reached.words)
    for module in program.modules:
        if printer.needed(module):
            lines += printer.chapter(module)
    return "\n".join([*lines, "}"]) + "\n"


@pytest.mark.slow
@pytest.mark.strict
@pytest.mark.parametrize("path", SAMPLES, ids=lambda p: p.stem)
def test_c_says_the_same(path: Path, tmp_path: Path) -> None:
    source = tmp_path / "sample.c"
    source.write_text(as_c(program_of(path)), encoding="utf-8")
    for k, flags in enumerate([["-O2"], needs.sanitizers()]):
        command = [
            *needs.STRICT,
            *STRICT,
            *flags,
            "-o",
            str(tmp_path / f"p{k}"),
            str(source),
            "-lm",
        ]
        subprocess.run(command, check=True)
        done = subprocess.run([tmp_path / f"p{k}"], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == said_by_python(path)


@pytest.fixture(scope="module")
def said_by_java(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Compile all samples at once, and run them in one machine."""
    folder = tmp_path_factory.mktemp("java")
    names = [p.stem.title() for p in SAMPLES]
    for path, name in zip(SAMPLES, names):
        (folder / f"{name}.java").write_text(as_java(program_of(path), name), "utf-8")
    calls = "".join(f'System.out.print("\\f"); {name}.report();\n' for name in names)
    main = f"final class All {{ public static void main(String[] words) {{ {calls} }} }}\n"
    (folder / "All.java").write_text(main.replace("private", ""), "utf-8")
    for name in names:  # the methods of a sample are private to it
        text = (folder / f"{name}.java").read_text("utf-8")
        text = text.replace("private static void report", "static void report")
        (folder / f"{name}.java").write_text(text, "utf-8")
    lint = ["-Xlint:all", "-Werror", "-d", str(folder)]
    subprocess.run([*needs.JAVAC, *lint, *map(str, sorted(folder.glob("*.java")))], check=True)
    done = subprocess.run(
        [*needs.JAVA, "-cp", str(folder), "All"], capture_output=True, text=True, check=True
    )
    return dict(zip([p.stem for p in SAMPLES], done.stdout.split("\f")[1:]))


@pytest.mark.slow
@pytest.mark.java
@pytest.mark.parametrize("path", SAMPLES, ids=lambda p: p.stem)
def test_java_says_the_same(path: Path, said_by_java: dict[str, str]) -> None:
    assert said_by_java[path.stem] == said_by_python(path)


@pytest.mark.slow
def test_comments_are_carried_over() -> None:
    text = as_c(program_of(next(p for p in SAMPLES if p.stem == "flow")))
    assert "n++; // does not lengthen the loop" in text or "// does not lengthen the loop" in text
    assert "        // a comment for this branch" in text
    assert "        // a comment at the end" in text
    assert "/* Write a name and a number.\n *\n * Parameters:\n * name : str\n" in text
    assert ">>>" not in text


@pytest.mark.slow
def test_what_is_only_read_is_const() -> None:
    text = as_c(program_of(next(p for p in SAMPLES if p.stem == "flow")))
    assert "search(const int *v, int n, int wanted)" in text
    assert "grow(int *v)" in text
    assert "static int calls(int *v)" in text
