"""What becomes true within one instant is one instant: rounding orders no transitions."""

from __future__ import annotations

import itertools
import math
import random
from pathlib import Path

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events

import hybond as hb

SOLVERS = ["rk45", "radau", "exact"]
WAYS = [
    ("{g} > {a!r}", "{g} < {a!r}", 1.0, 0.0),
    ("2*{g} > {a!r}", "2*{g} < {a!r}", 2.0, 0.0),
    ("1 - {g} < {a!r}", "1 - {g} > {a!r}", -1.0, 1.0),
    ("3*{g} - 0.1 > {a!r}", "3*{g} - 0.1 < {a!r}", 3.0, -0.1),
    ("{g}/7 > {a!r}", "{g}/7 < {a!r}", 1.0 / 7.0, 0.0),
]
"""Ways to say ``g > a`` and its opposite, and what becomes of the threshold."""


class Legs:
    """One or two legs of a bridge without dead time, and what their coil carries."""

    def __init__(self, seed: int, legs: str) -> None:
        rng = random.Random(seed)
        self.period = rng.uniform(0.5e-3, 3e-3)
        self.coil, self.resistance = rng.uniform(1e-3, 20e-3), rng.uniform(0.2, 3.0)
        self.voltage, self.begin = rng.uniform(20.0, 400.0), rng.uniform(-10.0, 10.0)
        self.until = 12.3 * self.period
        m = self.model = hb.Model("legs")
        m.add(L=hb.I(self.coil, p=self.coil * self.begin), R=hb.R(self.resistance), w=hb.One())
        m.bond("w -> L", "w -> R")
        self.on: list[tuple[float, float]] = []
        for n in legs:
            self.leg(n, rng)

    def leg(self, n: str, rng: random.Random) -> None:
        m, period = self.model, self.period
        threshold, rise = rng.uniform(0.2, 0.8), rng.uniform(1e-3, 2e-2) * period
        first, second = rng.uniform(0.0, 0.3) * period, rng.uniform(0.35, 0.7) * period
        rows = [(0, 0), (first, 0), (first + rise, 1), (second, 1), (second + rise, 0), (period, 0)]
        m.input(**{f"g{n}": hb.Input(table=rows, linear=True, period=period)})
        self.on.append((first + threshold * rise, second + (1.0 - threshold) * rise))
        parts = {f"s{n}": hb.Se(self.voltage), f"x{n}": hb.Zero()}
        m.add(**parts, **{f"u{n}": hb.One(), f"l{n}": hb.One()})
        m.bond(f"s{n} -> u{n} -> x{n}", f"x{n} -> l{n}", f"x{n} -> w" if n == "a" else f"w -> x{n}")
        for name, way, start in zip("ul", rng.sample(WAYS, 2), ("off", "on"), strict=True):
            above, below = (
                text.format(g=f"g{n}", a=way[2] * threshold + way[3]) for text in way[:2]
            )
            on, off = (above, below) if name == "u" else (below, above)
            m.machine(
                f"m{name}{n}",
                states={"on": [f"{name}{n}"], "off": []},
                start=start,
                rules=[f"off -> on when {on}", f"on -> off when {off}"],
            )

    def current(self) -> float:
        """Exponentials from edge to edge."""
        edges = {0.0, self.until}
        for k in range(13):
            edges |= {t + k * self.period for pair in self.on for t in pair}
        times = sorted(t for t in edges if t <= self.until)
        i = self.begin
        for a, b in itertools.pairwise(times):
            t = 0.5 * (a + b) % self.period
            signs = (1.0, -1.0)
            u = sum(
                s * self.voltage * (p < t < q) for s, (p, q) in zip(signs, self.on, strict=False)
            )
            last = u / self.resistance
            i = last + (i - last) * math.exp(-(b - a) * self.resistance / self.coil)
        return i


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("legs", ["a", "ab"])
def test_complementary_gates_switch_together(legs: str, solver: str) -> None:
    for seed in range(25):
        case = Legs(seed, legs)
        run = hb.simulate(case.model, until=case.until, solver=solver)
        size = case.voltage / case.resistance + abs(case.begin)
        assert run["L.f"].at(case.until) == pytest.approx(case.current(), abs=1e-8 * size), seed


def two(first: str, second: str, until: float = 2.0, rate: float = 1.0) -> hb.Result:
    """Two switches of one current: both at once, or what flows there is lost."""
    m = hb.Model("two")
    m.add(i=hb.I(1.0, p=1.0), x=hb.Zero(), a=hb.One(), b=hb.One(), c=hb.C(1.0), u=hb.Sf(rate))
    m.add(n=hb.Zero())
    m.bond("i -> x", "x -> a", "x -> b", "u -> n -> c")
    m.machine("ma", states={"on": ["a"], "off": []}, start="on", rules=[f"on -> off when {first}"])
    m.machine(
        "mb", states={"off": [], "on": ["b"]}, start="off", rules=[f"off -> on when {second}"]
    )
    return hb.simulate(m, until=until)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("c.e > 1", "2*c.e > 2"),
        ("c.e > 0.7", "1 - c.e < 0.3"),
        ("c.e/3 >= 0.1", "c.e >= 0.3"),
        ("c.e*c.e > 0.49", "c.e > 0.7"),
        ("c.e + time > 1.4", "c.e > 0.7"),
        ("c.e > 0.3", "time >= 0.1 + 0.2"),
        ("time >= 0.3", "3*c.e > 0.9"),
        ("c.q > 1.1", "time >= 1.1"),
    ],
)
def test_one_threshold_in_two_expressions_is_one_instant(first: str, second: str) -> None:
    for one, other in ((first, second), (second, first)):
        run = two(one, other)
        assert [e.t for e in run.events if e.t > 0.0] == [pytest.approx(run.events[-1].t)]
        assert run["i.p"].at(2.0) == 1.0  # nothing was cut off in between


def test_what_is_farther_apart_is_two_instants() -> None:
    run = two("c.e > 1.000001", "c.e > 1")
    assert len([e for e in run.events if e.t > 0.0]) == 2
    run = two("c.e > 1", "c.e > 1.000001")
    assert run["i.p"].at(2.0) == 0.0  # open in between


# -- a guard that starts at exactly zero ---------------------------------------------------------


@pytest.mark.parametrize(
    ("extra", "bonds"),
    [
        ({"c1": hb.C(1.096), "c2": hb.C(0.177, q=-2.191)}, ["c1 -> j2", "j2 -> c2"]),
        ({"c1": hb.C(1.0, q=1e6), "c2": hb.C(3.0)}, ["j2 -> c1", "j2 -> c2"]),
        (
            {"c1": hb.C(1e-6, q=1e-3), "c2": hb.C(2e-6), "c3": hb.C(1.0)},
            ["j2 -> c1", "j2 -> c2", "j2 -> c3"],
        ),
    ],
)
def test_a_coil_beside_tied_capacitors_begins_at_zero(
    extra: dict[str, hb.Part], bonds: list[str]
) -> None:
    """What no constraint moves keeps what it stores, however little."""
    m = hb.Model("from zero")
    m.add(j0=hb.One(), j1=hb.One(), j2=hb.Zero(), gy=hb.GY(-0.518), i3=hb.I(1.0), r1=hb.R(1.0))
    m.add(**extra)
    m.bond("j0 -> gy.1", "j1 -> gy.2", "j1 -> j2", "j1 -> i3", "j0 -> r1", *bonds)
    m.machine("m", states={"off": [], "on": ["j0"]}, start="on", rules=["on -> off when j0.f < 0"])
    run = hb.simulate(m, until=3.0)
    assert run.status == "ok"
    assert abs(run["i3.p"].at(1e-12)) > 0.0


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize(
    ("there", "back"),
    [
        ("not (pre(i.f) >= 0.7)", "pre(i.f) < 0.7"),
        ("not (pre(i.f) >= 0.7)", "not (pre(i.f) > 0.8)"),
        ("pre(i.f) < 0.7", "not (pre(i.f) >= 0.7)"),
        ("not (i.f >= 0.7)", "pre(i.f) <= 0.7"),
    ],
)
def test_a_cycle_is_called_one_by_every_solver(there: str, back: str, solver: str) -> None:
    m = hb.Model("cycle")
    m.add(i=hb.I(0.37, p=1.0), r=hb.R(0.61), v=hb.One(), k=hb.One(), u=hb.Se(0.3), load=hb.R(1.0))
    m.bond("v -> i", "v -> r", "u -> k -> load")
    rules = [f"a -> b when {there}", f"b -> a when {back}"]
    m.machine("m", states={"a": [], "b": ["k"]}, start="a", rules=rules)
    run = hb.simulate(m, until=5.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N401"


# -- islands that no bond joins to a jump ---------------------------------------------------------

CRASHES = {
    "masses": (
        ["v0 -> a0", "v1 -> a1", "v0 -> c0", "c0 -> v1"],
        {"a0": hb.I(1.0, p=1.1), "a1": hb.I(1.0, p=-0.7), "v0": hb.One(), "v1": hb.One()},
        hb.Zero(),
    ),
    "odd masses": (
        ["v0 -> a0", "v1 -> a1", "v0 -> c0", "c0 -> v1"],
        {"a0": hb.I(0.3, p=1.4), "a1": hb.I(1.7, p=1.6), "v0": hb.One(), "v1": hb.One()},
        hb.Zero(),
    ),
    "capacitors": (
        ["n0 -> a0", "n1 -> a1", "n0 -> c0 -> n1"],
        {"a0": hb.C(0.3, q=2.0), "a1": hb.C(0.7), "n0": hb.Zero(), "n1": hb.Zero()},
        hb.One(),
    ),
}


@pytest.mark.parametrize("crash", list(CRASHES))
def test_a_guard_of_an_island_at_rest_never_fires(crash: str) -> None:
    """Its springs are tied together, and zero stays zero bit for bit."""
    bonds, parts, junction = CRASHES[crash]
    m = hb.Model("islands")
    m.add(c0=junction, **parts)
    m.add(n=hb.Zero(), s1=hb.C(1.0), s2=hb.C(0.3), body=hb.I(1.0), rub=hb.R(1.0), w=hb.One())
    m.bond(*bonds, "n -> s1", "n -> s2", "w -> n", "w -> body", "w -> rub")
    m.machine(
        "crash",
        states={"apart": [], "joined": ["c0"]},
        start="apart",
        rules=["apart -> joined when time >= 0.5"],
    )
    m.machine(
        "fuse",
        states={"whole": [], "blown": []},
        start="whole",
        rules=["whole -> blown when n.e < 0"],
    )
    m.machine(
        "other",
        states={"whole": [], "blown": []},
        start="whole",
        rules=["whole -> blown when s1.q > 0 or body.p > 0"],
    )
    for solver in SOLVERS:
        run = hb.simulate(m, until=3.0, solver=solver)
        assert [e.t for e in run.events] == [0.0, 0.5]
        assert all(run[f"{name}"].at(3.0) == 0.0 for name in ("s1.q", "s2.q", "body.p"))


# -- the end of a run -----------------------------------------------------------------------------


def ending(guard: str, until: float) -> hb.Model:
    m = hb.Model("ending")
    m.add(c=hb.C(1.0), u=hb.Sf(1.0), n=hb.Zero())
    m.bond("u -> n -> c")
    m.input(g=hb.Input(pwm={"period": until, "duty": 0.5}))
    m.machine("m", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {guard}"])
    m.experiment["until"] = until
    return m


AT_END = [
    "time >= 0.3",
    "c.e >= 0.3",
    "c.e > 0.3",
    "3*c.e > 0.9",
    "1 - c.e < 0.7",
    "c.e > 0.3 + 2e-13",
]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("guard", AT_END)
@pytest.mark.parametrize("solver", SOLVERS)
def test_an_event_at_the_end_belongs_to_the_run(guard: str, solver: str) -> None:
    model = ending(guard, 0.3)
    for engine in ("library", "python"):
        run = hb.simulate(model, solver=solver, engine=engine)
        assert [e.t for e in run.events] == [0.0, pytest.approx(0.3, abs=1e-12)]
        assert run.events[-1].steps[-1].fired[0].target == "b"


@pytest.mark.parametrize("guard", ["time > 0.300001", "c.e > 0.300001", "time >= 0.31"])
def test_an_event_behind_the_end_does_not(guard: str) -> None:
    assert len(hb.simulate(ending(guard, 0.3)).events) == 1


@pytest.mark.sampled(2)
@needs_c
@pytest.mark.parametrize("guard", AT_END)
def test_a_program_ends_with_the_same_event(guard: str, tmp_path: Path) -> None:
    text = hb.export(ending(guard, 0.3), to="c")
    said = read_events(ask(compile_quickly(text, tmp_path, "ending"), "--events"))
    assert [w[1:4] for w in said.transitions[-1:]] == [("m", "a", "b")]
    assert said.times[-1] == pytest.approx(0.3, abs=1e-12)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_an_instant_lasts_from_the_first_that_is_one_with_it(order, turned) -> None:
    """The third was held to be one with the second, which is one with the first: HB-N411."""
    m = hb.Model("three")
    late = (0.0, 0.6e-11, 1.3e-11)  # of an instant of 1e-11 s
    for k in order:
        m.add({f"c{k}": hb.C(1.0, q=-1.0 - late[k]), f"z{k}": hb.Zero()})
        m.add({f"s{k}": hb.Sf(-1.0 if turned else 1.0)})
        m.bond(f"z{k} -> s{k}" if turned else f"s{k} -> z{k}", f"z{k} -> c{k}")
        rules = [f"a -> b when c{k}.q > 0"]
        m.machine(f"M{k}", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, 10.0)
    assert run.status == "ok"
    fired = [sorted(f.machine for f in e.steps[0].fired) for e in run.events[1:]]
    assert fired == [["M0", "M1"], ["M2"]]
