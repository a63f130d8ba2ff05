"""Examples as C programs and as Java classes: the same events, the same final state."""

from __future__ import annotations

import subprocess
from pathlib import Path

import needs
import pytest
from example_runs import INTEGRATED, NAMES, PRINTED, STOPPED, example, run_of
from export.programs import (
    ask,
    check,
    check_c,
    compile_c,
    compile_quickly,
    expected,
    needs_c,
    needs_java,
    read_events,
)

import hybond as hb
from hybond.export.fmu.package import functional_unit

FEW = ["bouncing_rod", "buck", "cam_follower", "half_wave_rectifier"]
"""Examples that are compiled each time: between them they need most of the engine."""
STYLE = [
    f"-Wno-{name}"
    for name in (
        *("declaration-after-statement", "padded", "float-equal"),
        *("unsafe-buffer-usage", "switch-default", "unknown-warning-option"),
    )
]
"""Warnings of clang that are of style, and the option by which an older one knows no newer name."""
IN_C = [
    n if n in FEW else pytest.param(n, marks=pytest.mark.slow)
    for n in NAMES
    if n in FEW or n in PRINTED["c"]
]
IN_JAVA = PRINTED["java"]


@pytest.fixture(scope="module")
def printed_by_java(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """All classes are compiled at once, and run in one machine."""
    folder = tmp_path_factory.mktemp("java")
    calls = []
    for k, name in enumerate(IN_JAVA):
        path = folder / f"Example{k}.java"
        hb.export(example(name), to="java", path=path, **INTEGRATED)
        calls.append(f'Example{k}.run(System.out, "--events"); System.out.print("\\f");')
    main = "public static void main(String[] words) { " + "\n".join(calls) + " }"
    (folder / "All.java").write_text(f"final class All {{ {main} }}\n", encoding="utf-8")
    sources = map(str, sorted(folder.glob("*.java")))
    lint = ["-Xlint:all", "-Werror", "-d", str(folder)]
    subprocess.run([*needs.JAVAC, *lint, *sources], check=True)
    return dict(zip(IN_JAVA, ask(*needs.JAVA, "-cp", folder, "All").split("\f")))


@needs_c
@pytest.mark.parametrize("name", IN_C)
def test_an_example_as_a_c_program(name: str, tmp_path: Path) -> None:
    """And a strict compiler has nothing to say of it, where it is asked; two of `FEW` are not."""
    text = hb.export(example(name), to="c", **INTEGRATED)
    program = compile_quickly(text, tmp_path, name)
    if needs.STRICT and name not in FEW[2:]:
        check_c(program.with_suffix(".c"))
    printed = ask(program, "--events", code=3 if name in STOPPED else 0)
    check(name, read_events(printed), expected(run_of(name)))


@pytest.mark.clang
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", NAMES[::5])
def test_clang_has_nothing_to_say(name: str, tmp_path: Path) -> None:
    """Not of a program, and not of a unit; but that declarations stand where they are needed."""
    clang = needs.COMPILERS["clang"]
    assert clang is not None
    for kind, style in (("program", STYLE), ("unit", [*STYLE, "-Wno-missing-prototypes"])):
        source = tmp_path / f"{kind}.c"
        model = example(name)
        text = (
            hb.export(model, to="c") if kind == "program" else functional_unit(model, fmi="3.0")[1]
        )
        source.write_text(text, encoding="utf-8")
        flags = ["-std=c99", "-fsyntax-only", "-Weverything", "-Werror", *style]
        subprocess.run([*clang, *flags, source], check=True)


@pytest.mark.slow
@needs_java
@pytest.mark.parametrize("name", IN_JAVA)
def test_an_example_as_a_java_class(name: str, printed_by_java: dict[str, str]) -> None:
    check(name, read_events(printed_by_java[name]), expected(run_of(name)))


@pytest.mark.slow
@pytest.mark.strict
def test_a_program_stays_within_its_memory(tmp_path: Path) -> None:
    """Run under the sanitizers, which end a program that reads beside an array or leaks."""
    flags = ["-O0", *needs.sanitizers()]
    program = compile_c(hb.export(example("buck"), to="c"), tmp_path, "buck", flags)
    table = ask(program, "--points", "20").splitlines()
    assert table[0] == "time,out.e,L.f,u,ramp"
    assert len(table) > 21
    assert all(line.count(",") == 4 for line in table)
