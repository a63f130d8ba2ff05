"""Every kind of sliding by the library: closed forms, and printed programs."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import needs
import numpy as np
import pytest
from engine.by_engine import ENGINE
from engine.sliding_models import (
    KINDS,
    allowed,
    charger,
    coupled,
    drained,
    measured,
    relays,
    swapped,
    system,
)
from export.programs import Said, ask, compile_quickly, expected, read_events

import hybond as hb

RTOL = 1e-10


def by_library(m: hb.Model, until: float, **options: object) -> hb.Result:
    return hb.simulate(m, until=until, rtol=RTOL, engine=ENGINE, **options)  # type: ignore[arg-type]


def test_what_else_a_rule_asks_for_ends_the_sliding() -> None:
    run = by_library(allowed(), 3.0)
    (sliding,) = run.sliding
    assert (sliding.t0, sliding.t1) == pytest.approx((2.0 / 3.0, 2.0), abs=1e-11)
    assert run["x1.q"].at(3.0) == pytest.approx(1.5, abs=1e-11)


def test_a_diode_has_a_branch_of_its_own_on_either_side() -> None:
    """It conducts 1/2 of the time and blocks 1/2, with -3 across it then."""
    run = by_library(charger(), 4.0)
    (sliding,) = run.sliding
    assert (sliding.t0, sliding.t1) == pytest.approx((np.log(4.0) / 1.5, 4.0), abs=1e-9)
    assert run.weight("r", "below", 3.0) == pytest.approx(0.5, abs=1e-13)
    assert run["d.f"].at(3.0) == pytest.approx(0.5, abs=1e-13)
    assert run["d.e"].at(3.0) == pytest.approx(-1.5, abs=1e-13)
    assert run.audit().holds()


def test_a_branch_that_changes_while_sliding_is_seen() -> None:
    run = by_library(drained(), 6.0)
    (sliding,) = run.sliding
    assert sliding.t1 == 6.0
    for t in np.linspace(sliding.t0 + 0.01, 5.99, 23):
        current = max(0.0, -0.5 * np.cos(2.0 * t))
        assert run["d.f"].at(float(t)) == pytest.approx(current, abs=1e-12)
        assert run.weight("r", "below", float(t)) == pytest.approx(0.5 * (1 + current), abs=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_switches_that_act_on_each_other_take_all_corners(solver: str) -> None:
    """s2 = 0.2, s1 (1 - 0.4 s2) = 0.5, and the mean of s1 s2 is the product of the means."""
    run = by_library(coupled(), 3.0, solver=solver)
    last = run.sliding[-1]
    assert last.kind == "product"
    assert sorted(last.modes) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert run.weight("r2", "above", 2.5) == pytest.approx(0.6, abs=1e-12)
    s1 = 0.5 / (1.0 - 0.4 * 0.2)
    assert run.weight("r1", "above", 2.5) == pytest.approx(0.5 * (1 + s1), abs=1e-12)
    assert run["s1.f"].at(2.5) == pytest.approx(0.0, abs=1e-12)
    assert run.audit().holds()


def test_jumps_without_number_end_where_both_constraints_are_met() -> None:
    """6 units of charge on 3.5 of capacity; what that takes stands in the last step."""
    run = by_library(swapped(), 2.0)
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(0.5, abs=1e-12)
    for name, size in (("c", 1.0), ("c1", 0.5), ("c2", 2.0)):
        assert run[f"{name}.q"].at(1.0) == pytest.approx(size * 12.0 / 7.0, rel=1e-14)
    struck, last = run.events[-1].steps
    assert (struck.kind, last.kind) == ("pinnacle", "continuous")
    assert 2 / 3 + struck.impulses["c.f"] + last.impulses["c.f"] == pytest.approx(12 / 7, rel=1e-13)
    stored = [0.5 * (q**2 + a**2 / 0.5 + b**2 / 2.0) for q, a, b in ((2 / 3, 1 / 3, 5.0),)]
    stored.append(0.5 * 6.0**2 / 3.5)
    lost = sum(s.energy.lost for s in (struck, last) if s.energy is not None)
    assert lost == pytest.approx(stored[0] - stored[1], rel=1e-12)
    assert run.audit().holds()


def test_a_flow_that_no_storage_gives_is_a_surface() -> None:
    run = by_library(measured(), 3.0)
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(2.0 * np.log(8.0 / 6.5), abs=1e-9)
    assert run["c.e"].at(2.0) == pytest.approx(1.5, abs=1e-12)
    assert run["pump.f"].at(2.0) == pytest.approx(0.25, abs=1e-10)


# -- as many as there are


@pytest.mark.parametrize("n", [40, pytest.param(80, marks=pytest.mark.slow)])
def test_more_surfaces_than_modes_are_kept(n: int) -> None:
    drift = list(np.linspace(-0.8, 0.8, n))
    run = by_library(relays(n, drift), 1.5)
    last = run.sliding[-1]
    assert (last.t0, last.t1) == (pytest.approx(1.0, abs=1e-9), 1.5)
    assert len(last.machines) == n
    assert len(last.modes) == n + 1
    for k in (1, n // 2, n):
        weight = run.weight(f"r{k}", "above", 1.4)
        assert weight == pytest.approx(0.5 * (1 + drift[k - 1]), abs=1e-12)


def test_a_guard_of_very_many_comparisons_is_asked_at_all_its_instants() -> None:
    """The last of 300 thresholds is passed at 1 s, all of them in one step."""
    m = system(["1"], [0.0])
    m.machine(
        "m",
        states={"a": [], "b": []},
        start="a",
        rules=["a -> b when " + " and ".join(f"x1.q > {k / 300}" for k in range(1, 301))],
    )
    run = by_library(m, 2.0)
    assert run.events[-1].t == pytest.approx(1.0, abs=1e-12)
    assert run.stats["steps"] < 20


# -- printed programs


@pytest.fixture(scope="module")
def in_java(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """All classes are compiled at once, and run in one machine."""
    folder = tmp_path_factory.mktemp("java")
    calls = []
    for k, (make, until) in enumerate(KINDS.values()):
        hb.export(make(), to="java", path=folder / f"Slides{k}.java", until=until, rtol=RTOL)
        calls.append(f'Slides{k}.run(System.out, "--events"); System.out.print("\\f");')
    main = "public static void main(String[] words) { " + "\n".join(calls) + " }"
    (folder / "All.java").write_text(f"final class All {{ {main} }}\n", encoding="utf-8")
    sources = map(str, sorted(folder.glob("*.java")))
    subprocess.run([*needs.JAVAC, "-Xlint:all", "-Werror", "-d", str(folder), *sources], check=True)
    return dict(zip(KINDS, ask(*needs.JAVA, "-cp", folder, "All").split("\f")))


def hold(make: Callable[[], hb.Model], until: float, said: Said) -> None:
    meant = expected(by_library(make(), until))
    assert not said.stopped
    assert said.transitions == meant.transitions
    assert said.times == pytest.approx(meant.times, abs=1e-9)
    for path, value in meant.states.items():
        assert said.states[path] == pytest.approx(value, abs=1e-9)


@pytest.mark.slow
@pytest.mark.java
@pytest.mark.parametrize("name", list(KINDS))
def test_a_java_class_slides_as_well(name: str, in_java: dict[str, str]) -> None:
    make, until = KINDS[name]
    hold(make, until, read_events(in_java[name]))


@pytest.mark.sampled(1)
@pytest.mark.c
@pytest.mark.parametrize("name", list(KINDS))
@pytest.mark.slow
def test_a_c_program_slides_as_well(name: str, tmp_path: Path) -> None:
    make, until = KINDS[name]
    text = hb.export(make(), to="c", until=until, rtol=RTOL)
    program = compile_quickly(text, tmp_path, name)
    hold(make, until, read_events(ask(program, "--events")))
