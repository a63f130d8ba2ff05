"""Time-stepping in the engine: as a library, as Python, as programs; order, energy, refusals."""

from __future__ import annotations

import subprocess
from pathlib import Path

import needs
import numpy as np
import pytest
from export.programs import compile_c, compile_quickly
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb
from hybond.engine.complementarity.law_roles import ONE_SIDED, TWO_SIDED, make_law_problem
from hybond.engine.timestepping.guessed import answer_guessed
from hybond.engine.timestepping.step_records import make_guess
from hybond.export.c import to_c
from hybond.export.java import to_java

H = 5e-3


def ball() -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se("-9.81 N"), ball=hb.I("1 kg"), v=hb.One(), floor=hb.Sf(0.0))
    m.add(contact=hb.Zero(law="unilateral", gap="height", restitution=0.9))
    m.bond("weight -> v -> ball", "floor -> contact -> v")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    return m


def chain(count: int, order: list[int] | None = None) -> hb.Model:
    """Blocks on a dry floor, springs between them, pulled at one end."""
    m = hb.Model("chain", domain="translational")
    for k in order or range(count):
        m.add(**{f"m{k}": hb.I("1 kg"), f"v{k}": hb.One(law="coulomb", limit="1 N")})
        m.add(**{f"k{k}": hb.C("0.01 m/N"), f"s{k}": hb.Zero()})
    m.add(drive=hb.Sf("20*sin(3*time)"))
    m.bond("drive -> s0")
    for k in order or range(count):
        m.bond(f"v{k} -> m{k}", f"s{k} -> k{k}", f"s{k} -> v{k}")
        if k:
            m.bond(f"v{k - 1} -> s{k}")
    return m


def stepped(model: hb.Model, until: float, step: float = H, **options: object) -> hb.Result:
    return hb.simulate(model, until, solver="moreau-jean", step=step, **options)


def bouncing(steps: int) -> tuple[float, float]:
    """Height and velocity by the scheme itself, written for one ball (Acary and Brogliato)."""
    q, v = 1.0, 0.0
    for _ in range(steps):
        free = v - 9.81 * H
        after = max(free, -0.9 * v) if q + 0.5 * H * v <= 0.0 else free
        q, v = q + 0.5 * H * (v + after), after
    return q, v


def test_a_ball_steps_as_the_scheme_does_by_hand() -> None:
    run = stepped(ball(), 3.0)
    for steps in (90, 91, 300, 600):
        q, v = bouncing(steps)
        assert float(run["height"].at(steps * H)) == pytest.approx(q, abs=1e-10)
        assert float(run["v.f"].at(steps * H)) == pytest.approx(v, abs=1e-10)


@pytest.mark.parametrize(("model", "until"), [(ball, 1.0), (lambda: chain(4), 0.5)])
def test_as_python_the_same_steps_are_made(model, until: float) -> None:
    one, two = (stepped(model(), until, engine=engine) for engine in ("library", "python"))
    assert one.engine != two.engine
    assert [(e.t, e.cause) for e in one.events] == [(e.t, e.cause) for e in two.events]
    for name, value in one.final.items():
        assert two.final[name] == pytest.approx(value, rel=1e-12, abs=1e-12)


def read(text: str) -> dict[str, float]:
    """The final state that a program prints."""
    found = {}
    for line in text.splitlines():
        if line.startswith("state "):
            name, value = line[len("state ") :].rsplit(" ", 1)
            found[name] = float(value)
    return found


@pytest.mark.sampled(1)
@pytest.mark.c
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.slow
def test_a_program_in_c_makes_the_same_steps(tmp_path: Path, theta: float) -> None:
    # the programs differ in one number: one of them is compiled without a warning
    compiled = compile_c if needs.STRICT and theta == 1.0 else compile_quickly
    text = to_c(chain(5), until=1.0, solver="moreau-jean", step=H, theta=theta)
    program = compiled(text, tmp_path, "chain")
    said = subprocess.run([program, "--events"], check=True, capture_output=True, text=True)
    run = stepped(chain(5), 1.0, theta=theta)
    state = read(said.stdout)
    assert len(state) == 10
    for name, value in state.items():
        assert run.final[name] == pytest.approx(value, rel=1e-9, abs=1e-11)
    steps = [e for e in run.events if e.cause == "step"]
    assert len({line.split()[0] for line in said.stdout.splitlines() if " step " in line}) == len(
        steps
    )
    # the table has the straight lines between the ends of steps
    table = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    rows = [line.split(",") for line in table.splitlines()]
    at = rows[0].index("m0.p")
    times = [float(row[0]) for row in rows[1:]]
    ours = run.sample(times, ["m0.p"])["m0.p"]
    assert [float(row[at]) for row in rows[1:]] == pytest.approx(ours, rel=1e-9, abs=1e-11)


@pytest.mark.java
@pytest.mark.slow
def test_a_java_class_makes_the_same_steps(tmp_path: Path) -> None:
    source = tmp_path / "Ball.java"
    source.write_text(to_java(ball(), name="Ball", until=1.0, solver="moreau-jean", step=H))
    said = subprocess.run(
        [*needs.JAVA, source, "--events"], check=True, capture_output=True, text=True
    ).stdout
    run = stepped(ball(), 1.0)
    for name, value in read(said).items():
        assert run.final[name] == pytest.approx(value, rel=1e-12)


@settings(max_examples=5, deadline=None)
@given(st.permutations(range(5)))
def test_the_order_of_declaration_changes_nothing(order: list[int]) -> None:
    one, two = stepped(chain(5), 1.0), stepped(chain(5, order), 1.0)
    for name, value in one.final.items():
        assert two.final[name] == pytest.approx(value, rel=1e-9, abs=1e-10)
    assert [e.t for e in one.events] == [e.t for e in two.events]


def test_energy_is_never_created_at_theta_one() -> None:
    run = stepped(chain(6), 2.0, theta=1.0)
    audit = run.audit()
    assert len(run.events) > 4
    assert audit.power <= 1e-12 and audit.energy <= 1e-12 and audit.created <= 1e-12


def settled(problem: np.ndarray, q: np.ndarray, limit: np.ndarray, rubs: np.ndarray, start):
    """What the guess finds for laws that are contacts, or friction where `rubs`."""
    n = len(q)
    p = make_law_problem(n)
    p.n = n
    p.m[:] = problem.ravel().tolist()
    p.q[:] = q.tolist()
    p.moved[:] = q.tolist()
    p.limit[:] = limit.tolist()
    for k in range(n):
        p.role[k] = TWO_SIDED if rubs[k] else ONE_SIDED
        p.common[k] = 0 if rubs[k] else 1
    found = answer_guessed(make_guess(n), p, start, 1, True)
    return np.array(p.l) if found else None


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 10**6))
def test_what_is_guessed_keeps_the_laws(seed: int) -> None:
    """Against the conditions themselves: at each contact and each rubbing block."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    a = rng.normal(size=(n, n))
    m = a @ a.T + 0.1 * np.eye(n)
    q, limit = rng.normal(size=n), rng.uniform(0.1, 2.0, n)
    rubs = rng.random(n) < 0.5
    start = [int(k) for k in rng.integers(-1, 2, n) * rubs + rng.integers(0, 2, n) * ~rubs]
    l = settled(m, q, limit, rubs, start)
    if l is None:
        return
    w = m @ l + q
    for k in range(n):
        if rubs[k]:
            assert abs(l[k]) <= limit[k] * (1 + 1e-9)
            assert abs(w[k]) < 1e-9 or l[k] == pytest.approx(-np.sign(w[k]) * limit[k])
        else:
            assert l[k] >= -1e-9 and w[k] >= -1e-9 and abs(l[k] * w[k]) < 1e-8


def test_most_guesses_are_answers() -> None:
    rng = np.random.default_rng(7)
    found = 0
    for _ in range(200):
        a = rng.normal(size=(6, 6))
        m = a @ a.T + 0.1 * np.eye(6)
        rubs = np.array([True, False] * 3)
        l = settled(m, rng.normal(size=6), np.full(6, 0.5), rubs, [0] * 6)
        found += l is not None
    assert found > 150


def test_many_settings_beside_laws_are_no_obstacle() -> None:
    """More settings of switches than are looked at beforehand; the diode decides all the same."""
    m = hb.Model("many", domain="electrical")
    m.add(V=hb.Se("10*sin(time/(1 [s]))"), d=hb.One(law="diode"), n=hb.Zero(), c=hb.C("1 F"))
    m.bond("V -> d -> n -> c")
    for k in range(13):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R("1 Mohm")})
        m.bond(f"n -> s{k} -> r{k}")
        m.machine(
            f"S{k}",
            states={"open": [], "closed": [f"s{k}"]},
            start="open",
            rules=["open -> closed when time >= 100 s"],
        )
    run = stepped(m, 3.0, 0.01)
    assert run.final["c.e"] == pytest.approx(10.0, rel=1e-4)
