"""Numbers written into slots, against the model made anew with them: the same to the last bit."""

from __future__ import annotations

import math
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.model.flatten import flatten
from hybond.runs.times import end_of

EXAMPLES = Path(__file__).parents[2] / "examples"
TIMES = 7


def cases() -> list[tuple[str, str]]:
    """Return each numeric parameter of each example."""
    found = []
    for path in sorted(EXAMPLES.glob("*.toml")):
        numbers = hb.load(path).flatten().parameters.items()
        found += [(path.stem, name) for name, value in numbers if isinstance(value, float)]
    return found


def same(many: hb.Ensemble, k: int, run: hb.Result) -> None:
    """Hold a member against an ordinary run."""
    assert many.status[k] == ("error" if run.error else run.status)
    assert many.warnings.get(k, ()) == run.warnings
    if run.error is not None:
        assert str(many.errors[k]) == str(run.error)
        return
    assert many.t_end[k] == run.t_end
    assert many.events[k].tolist() == list(run.trace.events.times)
    there = many.t <= run.t_end
    values = run.sample(many.t[there], list(many.final))
    for name, value in run.final.items():
        np.testing.assert_array_equal(many.final[name][k], value)
        np.testing.assert_array_equal(many.samples[name][k][there], values[name])


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("example", "path"), cases())
def test_what_is_written_is_what_is_made_anew(example: str, path: str) -> None:
    model = hb.load(EXAMPLES / f"{example}.toml")
    value = model.flatten().parameters[path]
    until = end_of(None, model.experiment)
    values = [value, 1.001 * value, 0.93 * value + (0.01 if value == 0.0 else 0.0)]
    many = hb.ensemble(model, until, sets={path: values}, samples=TIMES, events=True, workers=2)
    for k, x in enumerate(values):
        try:
            run = hb.simulate(flatten(model, {path: x}), until, on_error="return")
        except hb.HybondError as error:
            assert str(many.errors[k]) == str(error)
            continue
        same(many, k, run)
        if k != 1:  # the third way is that of the first, told by one value
            continue
        again = hb.simulate(model, until, parameters={path: x}, on_error="return")
        assert repr(again.final) == repr(run.final)
        assert (again.warnings, str(again.error)) == (run.warnings, str(run.error))


def circuit() -> hb.Model:
    """A start, laws, a guard, inputs, a table and a field that follow from parameters."""
    m = hb.Model("all", domain="electrical")
    m.parameter(R="2 ohm", C="1 mF", D="2*C", U="4 V", low="1 V", t1="1 ms", n="2", cut="0.5")
    m.add(c=hb.C("C", e="U"), r=hb.R("3*R"), s=hb.Zero(), d=hb.C("D", q="D*U/2"), t=hb.One())
    m.add(
        f=hb.R([["R", "R/4"], ["R/4", "sqrt(n)*R"]]),
        k=hb.One(),
        x=hb.R({"e": "R*f*abs(f/(1 [A]))^n"}),
    )
    m.add(v=hb.Se("step + high/2"), l=hb.I("1 mH"), g=hb.R("1 ohm"))
    m.bond("s -> c", "s -> r", "s -> t -> d", "t -> f.1", "k -> f.2", "v -> k -> l", "k -> x")
    m.add(y=hb.G({"f": {"table": [["-2*cut", 0, "cut", 9], [-0.2, 0, "0.1*cut", 1]]}}))
    m.bond("s -> y", "s -> g")
    m.input(step=hb.Input(table=[("0 s", "low"), ("t1", "2*low")]))
    m.signal(high='if m.state == "on" then U else low')
    m.machine(
        "m",
        states={"off": [], "on": []},
        start="off",
        rules=["off -> on when c.e < low + U/4 and time < 4*t1", "on -> off when time > 5*t1"],
    )
    m.experiment["until"] = 0.008
    return m


VALUES = {
    "R": [2.0, 3.5, 0.0, 1e-3],
    "C": [1e-3, 2e-3, "3 mF", -1e-3],
    "D": [1e-3, "1 mF", "2*C", 0.0],
    "U": [4.0, 0.0, -1.0, 8.0],
    "low": [1.0, 2.0, 0.0, 3.0],
    "t1": [1e-3, 2e-3, 0.0, 5e-3],
    "n": [2.0, 1.0, 2.5, 0.0],
    "cut": [0.5, 0.25, 10.0, -1.0],
}
"""Of each parameter: plain values, such as make other parts of the model, and wrong ones."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", VALUES)
def test_a_value_that_changes_the_parts_makes_them_anew(path: str) -> None:
    model, values = circuit(), VALUES[path]
    many = hb.ensemble(model, sets={path: values}, samples=TIMES, events=True)
    for k, value in enumerate(values):
        try:
            run = hb.simulate(flatten(circuit(), {path: value}), on_error="return")
        except hb.HybondError as error:
            assert str(many.errors[k]) == str(error)
            continue
        same(many, k, run)


def test_many_parameters_at_once() -> None:
    generator = np.random.default_rng(3)
    sets = {
        name: (float(values[0]) * generator.uniform(0.5, 2.0, 40)).tolist()  # type: ignore[arg-type]
        for name, values in VALUES.items()
        if name != "n"
    }
    many = hb.ensemble(circuit(), sets=sets, samples=TIMES, events=True, workers=2)
    assert many.how == "40 members in 2 threads"
    for k in (0, 17, 39):
        given = {name: column[k] for name, column in sets.items()}
        same(many, k, hb.simulate(flatten(circuit(), given)))


def test_outputs_read_parameters() -> None:
    values = [1.0, 2.0, 3.0]
    outputs = ["R", "R^2*c.e", "c.e + U*sin(n)"]
    many = hb.ensemble(circuit(), sets={"R": values}, outputs=outputs, samples=[0.0, 0.004])
    for k, value in enumerate(values):
        run = hb.simulate(circuit(), parameters={"R": value})
        for name, found in run.sample([0.0, 0.004], outputs).items():
            assert many.samples[name][k].tolist() == found.tolist()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["radau", "exact", "rk4", "qss2"])
def test_every_kind_of_solver(solver: str) -> None:
    model = hb.load(EXAMPLES / "buck.toml")
    # a hundred periods of the switch; steps of a quantum are many: sixty
    quanta = solver == "qss2"
    options = {"solver": solver, "until": "0.1 ms" if quanta else "0.2 ms", "rtol": 1e-5}
    if solver == "rk4":
        options["step"] = "0.1 us"
    path = "L" if "L" in model.parameters else next(iter(model.parameters))
    value = model.flatten().parameters[path]
    values = [value, 1.02 * value]
    many = hb.ensemble(model, sets={path: values}, samples=TIMES, events=True, **options)
    for k, x in enumerate(values):
        same(many, k, hb.simulate(flatten(model, {path: x}), on_error="return", **options))


def rates() -> hb.Model:
    m = hb.Model("drains", parameters={"a": 1.0, "b": 0.0, "k": 1.0})
    m.add(c=hb.C(1.0, q=2.0), d=hb.C(1.0), r=hb.G("k"), n=hb.Zero(), o=hb.Zero())
    m.add(s=hb.Sf("(a - b)*c.q"))
    m.bond("n -> c", "n -> r", "s -> o -> d")
    return m


def test_exact_motion_with_a_factor_that_vanishes() -> None:
    """Where a = b the source is none: its form has no entry, and has one for other values."""
    sets = [{"a": 1.0, "b": 1.0}, {"a": 1.0, "b": 0.5}, {"a": 2.0, "b": 2.0}]
    for first in range(3):
        order = sets[first:] + sets[:first]
        many = hb.ensemble(rates(), 1.0, sets=order, solver="exact", outputs=["d.q"])
        for k, given in enumerate(order):
            expected = 2.0 * (given["a"] - given["b"]) * (1.0 - math.exp(-1.0))
            assert many.final["d.q"][k] == pytest.approx(expected, abs=1e-9)


def test_a_warning_that_names_a_value_is_that_of_each_member() -> None:
    model = hb.load(EXAMPLES / "impacting_stick.toml")
    many = hb.ensemble(model, sets={"eps": [0.5, 1.01, 1.02]}, samples=3, events=True)
    assert 0 not in many.warnings
    assert "restitution = 1.01 of" in str(many.warnings[1])
    assert "restitution = 1.02 of" in str(many.warnings[2])


@pytest.mark.parametrize("workers", [1, 2])
def test_ctrl_c_ends_a_long_member_soon(workers: int) -> None:
    m = hb.Model("long", parameters={"k": 1.0})
    m.add(c=hb.C(1.0, q=1.0), i=hb.I("1/k^2"), n=hb.One())
    m.bond("n -> c", "n -> i")
    done: list[hb.Ensemble] = []

    def press(*_: int) -> None:
        raise KeyboardInterrupt

    start = time.perf_counter()
    sets = {"k": [1e-6, *[1e5] * 5]}
    done.append(hb.ensemble(m, 1000.0, sets=sets, workers=workers, progress=press))
    assert time.perf_counter() - start < 20.0
    assert done[0].interrupted and done[0].status[0] == "ok"
    assert set(done[0].status[1:]) == {"interrupted"}
    assert threading.active_count() < 20


@pytest.mark.parametrize("begun", [1, 2])
def test_ctrl_c_while_threads_are_begun_leaves_none_behind(
    begun: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that went on in the library while Python ended crashed it."""
    real, many = threading.Thread.start, [0]

    def start(thread: threading.Thread) -> None:
        real(thread)
        many[0] += 1
        if many[0] == begun:
            raise KeyboardInterrupt

    there = threading.active_count()
    monkeypatch.setattr(threading.Thread, "start", start)
    found = hb.ensemble(circuit(), sets={"R": np.linspace(1.0, 2.0, 2000)}, workers=2)
    assert found.interrupted
    time.sleep(0.02)
    assert threading.active_count() == there
