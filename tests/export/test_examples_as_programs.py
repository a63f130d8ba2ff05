"""Every example as a C program and as a Java class: the same events, the same final state."""

from __future__ import annotations

import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import needs
import pytest
from export.programs import (
    Said,
    ask,
    compile_c,
    compile_quickly,
    expected,
    needs_c,
    needs_java,
    read_events,
)

import hybond as hb
from hybond.errors import NumericsError

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
LABELS = {
    "cockcroft_walton": "which diode is called conducting while it carries nothing",
    "mmc_arm": "which diode is called conducting while it carries nothing",
}
"""Examples whose states agree, and whose events are called by other names."""
STOPPED = {"bouncing_ball_no_mode", "diode_inductor_no_mode", "falling_rod_threshold"}
"""Examples that end in HB-N401, as they are meant to."""
KEPT = {"slip_x.heading", "slip_x.slow"}
NAMES = [p.stem for p in EXAMPLES]


@pytest.fixture(scope="module")
def runs() -> dict[str, Said]:
    found = {}
    for path in EXAMPLES:
        model = hb.load(path)
        # what hybond propagates exactly, an export integrates
        method = {"solver": "rk45"} if model.experiment.get("solver") == "exact" else {}
        try:
            run = hb.simulate(model, **method)
        except NumericsError as error:
            run = error.partial
        found[path.stem] = expected(run)
    return found


@pytest.fixture(scope="module")
def printed_by_c(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("c")
    texts = {p.stem: hb.export(hb.load(p), to="c") for p in EXAMPLES}

    def run(name: str) -> str:
        program = compile_quickly(texts[name], folder, name)
        return ask(program, "--events", code=3 if name in STOPPED else 0)

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(texts, pool.map(run, texts)))


@pytest.fixture(scope="module")
def printed_by_java(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """All classes are compiled at once, and run in one machine."""
    folder = tmp_path_factory.mktemp("java")
    calls = []
    for k, path in enumerate(EXAMPLES):
        hb.export(hb.load(path), to="java", path=folder / f"Example{k}.java")
        calls.append(f'Example{k}.run(System.out, "--events"); System.out.print("\\f");')
    main = "public static void main(String[] words) { " + "\n".join(calls) + " }"
    (folder / "All.java").write_text(f"final class All {{ {main} }}\n", encoding="utf-8")
    sources = map(str, sorted(folder.glob("*.java")))
    lint = ["-Xlint:all", "-Werror", "-d", str(folder)]
    subprocess.run(["javac", *lint, *sources], check=True)
    return dict(zip(NAMES, ask("java", "-cp", folder, "All").split("\f")))


def check(name: str, said: Said, run: Said) -> None:
    span = run.end
    assert said.end == pytest.approx(span, rel=1e-9)
    assert bool(said.stopped) == (name in STOPPED)
    if name not in LABELS:
        assert said.transitions == run.transitions
        assert said.times == pytest.approx(run.times, abs=1e-9 * span)
        check_impulses(said, run)
    # hybond keeps more of a friction in the plane: how the slip turns
    assert set(said.states) == {path for path in run.states if path not in KEPT}
    for path, value in said.states.items():
        # what is smaller than its kind by 1e-4 is made of differences
        size = max(abs(value), 1e-4 * run.sizes[path])
        assert value == pytest.approx(run.states[path], abs=1e-9 * size), path


def check_impulses(said: Said, run: Said) -> None:
    """Those on storage, whose bonds are known by name; of one step in any order."""
    bonds = {bond for _, _, bond, _ in run.impulses}
    found = sorted(i[1:] for i in said.impulses if i[2] in bonds)
    meant = sorted(i[1:] for i in run.impulses)
    assert [i[:2] for i in found] == [i[:2] for i in meant]
    assert [i[2] for i in found] == pytest.approx([i[2] for i in meant], rel=1e-8)


@needs_c
@pytest.mark.parametrize("name", NAMES)
def test_an_example_as_a_c_program(
    name: str, printed_by_c: dict[str, str], runs: dict[str, Said]
) -> None:
    check(name, read_events(printed_by_c[name]), runs[name])


@pytest.mark.parametrize(
    "compiler", [pytest.param(c, marks=getattr(pytest.mark, c)) for c in ("gcc", "clang")]
)
@pytest.mark.parametrize("name", ["buck", "elevator_actuators", "falling_rod", "rimless_wheel"])
def test_a_strict_compiler_has_nothing_to_say(name: str, compiler: str, tmp_path: Path) -> None:
    text = hb.export(hb.load(next(p for p in EXAMPLES if p.stem == name)), to="c")
    compile_c(text, tmp_path, name, compiler=needs.COMPILERS[compiler])


@needs_java
@pytest.mark.parametrize("name", NAMES)
def test_an_example_as_a_java_class(
    name: str, printed_by_java: dict[str, str], runs: dict[str, Said]
) -> None:
    check(name, read_events(printed_by_java[name]), runs[name])


@pytest.mark.strict
def test_a_program_stays_within_its_memory(tmp_path: Path) -> None:
    """Run under the sanitizers, which end a program that reads beside an array or leaks."""
    path = next(p for p in EXAMPLES if p.stem == "buck")
    flags = ["-O0", *needs.sanitizers()]
    program = compile_c(hb.export(hb.load(path), to="c"), tmp_path, "buck", flags)
    table = ask(program, "--points", "20").splitlines()
    assert table[0] == "time,out.e,L.f,u,ramp"
    assert len(table) > 21
    assert all(line.count(",") == 4 for line in table)
