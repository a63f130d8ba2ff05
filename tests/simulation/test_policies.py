"""Methods, sliding, limits and journals as records: what they say, and what cannot be said."""

from __future__ import annotations

import csv
import inspect
import math
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import hybond as hb
from hybond.cli.arguments import parse
from hybond.engine.tables.options import METHODS
from hybond.files.schema import Experiment
from hybond.options import CALLED, OPTIONS
from hybond.runs.asked import ASKED, RunOptions
from hybond.runs.policies import Method
from hybond.testing import random_recipe

ADAPTIVE: list[Any] = [hb.Auto, hb.RK45, hb.Radau, hb.Exact, hb.QSS, hb.LIQSS]
METHODS_OF_RUNS: list[Method] = [
    *(kind(rtol=1e-9, max_step="0.2 s") for kind in ADAPTIVE[:4]),
    hb.QSS(order=3, rtol=1e-7),
    hb.LIQSS(order=3, rtol=1e-7),
    hb.RK4(step="1 ms"),
    hb.Euler(step="20 us"),
    hb.MoreauJean(step="1 ms"),
]


def decay() -> hb.Model:
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    return m


@pytest.mark.parametrize("method", METHODS_OF_RUNS, ids=lambda m: m.solver)
def test_each_method_finds_the_decay_of_a_capacitor(method: Method) -> None:
    run = hb.simulate(decay(), "1 s", method=method)
    assert run.solver == method.solver
    assert float(run["c.e"].at(1.0)) == pytest.approx(10.0 / math.e, rel=2e-5)


@pytest.mark.parametrize("method", METHODS_OF_RUNS, ids=lambda m: m.solver)
def test_what_is_short_for_a_method_is_the_same_to_the_last_bit(method: Method) -> None:
    long = hb.simulate(decay(), "0.3 s", method=method)
    short = hb.simulate(decay(), "0.3 s", **method.options)
    assert long.trace.segments[-1].y[-1].tolist() == short.trace.segments[-1].y[-1].tolist()


def test_a_method_leaves_to_the_experiment_what_it_does_not_say() -> None:
    m = decay()
    m.experiment = {"until": "1 s", "solver": "moreau-jean", "step": "1 ms", "max_step": "10 ms"}
    run = hb.simulate(m, method=hb.RK45())
    assert run.solver == "rk45"
    assert run.stats["steps"] >= 100
    assert hb.simulate(m, method="rk4").stats["steps"] == pytest.approx(1000, abs=2)


def test_every_solver_has_a_record_and_every_record_fits() -> None:
    said = {method.solver for method in METHODS_OF_RUNS}
    said |= {kind(order=n).solver for kind in (hb.QSS, hb.LIQSS) for n in (1, 2, 3)}
    assert said == set(METHODS) == set(OPTIONS["solver"].choices)
    for method in METHODS_OF_RUNS:
        for field in fields(method):  # type: ignore[arg-type]
            only = OPTIONS[field.name].only if field.name in OPTIONS else ()
            assert not only or method.solver in only, (method, field.name)


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: hb.RK45(step="1 ms"), "HB-S130"),
        (lambda: hb.Radau(theta=0.7), "HB-S130"),
        (lambda: hb.RK4(), "HB-S130"),
        (lambda: hb.RK4("1 ms", rtol=1e-6), "HB-S130"),
        (lambda: hb.RK4("0 s"), "HB-S102"),
        (lambda: hb.Euler("1 V"), "HB-S106"),
        (lambda: hb.MoreauJean("1 ms", theta=0.4), "HB-S112"),
        (lambda: hb.Auto(rtol=1e-15), "HB-S107"),
        (lambda: hb.Auto(atol=-1.0), "HB-S107"),
        (lambda: hb.Exact(max_step="0 s"), "HB-S103"),
        (lambda: hb.QSS(order=4), "HB-S101"),
        (lambda: hb.Hysteresis(0.0), "HB-S111"),
        (lambda: hb.Hysteresis(), "HB-S130"),
        (lambda: hb.Limits(events=0), "HB-S120"),
        (lambda: hb.Limits(steps=1.5), "HB-S120"),
        (lambda: hb.Limits(seconds=3), "HB-S130"),
        (lambda: hb.Journal("model.toml"), "HB-S113"),
        (lambda: hb.Journal("e.csv", last=0), "HB-S113"),
    ],
)
def test_a_record_that_means_nothing_is_not_made(call: Any, code: str) -> None:
    with pytest.raises(hb.UsageError) as caught:
        call()
    assert caught.value.code == code
    assert caught.value.hint


@pytest.mark.parametrize(
    ("options", "code", "where"),
    [
        ({"method": hb.Radau(), "rtol": 1e-6}, "HB-S122", "rtol"),
        ({"method": hb.Radau(), "solver": "rk45"}, "HB-S122", "solver"),
        ({"method": "radau", "solver": "rk45"}, "HB-S122", "solver"),
        ({"method": hb.Radau(), "step": "1 ms"}, "HB-S122", "step"),
        ({"method": hb.Radau}, "HB-S122", "method"),
        ({"method": 3}, "HB-S122", "method"),
        ({"method": "radu"}, "HB-S101", "solver"),
        ({"method": hb.Limits()}, "HB-S122", "method"),
        ({"sliding": hb.Hysteresis(1.0), "hysteresis": 2.0}, "HB-S122", "hysteresis"),
        ({"sliding": 1.0}, "HB-S122", "sliding"),
        ({"limits": hb.Limits(events=3), "max_events": 4}, "HB-S122", "max_events"),
        ({"limits": 10**6}, "HB-S122", "limits"),
        ({"keep": hb.Journal("e.csv"), "journal": "f.csv"}, "HB-S122", "journal"),
        ({"keep": hb.Journal("e.csv"), "method": hb.MoreauJean("1 ms")}, "HB-S113", "journal"),
        ({"keep": 5, "method": hb.MoreauJean("1 ms")}, "HB-S113", "keep"),
    ],
)
def test_what_does_not_go_together_is_refused(
    options: dict[str, Any], code: str, where: str
) -> None:
    with pytest.raises(hb.UsageError) as caught:
        hb.simulate(decay(), "1 s", **options)
    assert (caught.value.code, caught.value.where) == (code, where)
    assert "<class" not in str(caught.value)


def clock() -> hb.Model:
    """Return a model with an event at each second, and nothing else."""
    m = hb.Model("clock")
    m.add(c=hb.C(1.0), r=hb.R(1.0), n=hb.Zero(), s=hb.One())
    m.bond("n -> c", "n -> s -> r")
    rules = ["off -> on when mod(time, 2) >= 1", "on -> off when mod(time, 2) < 1"]
    m.machine("tick", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


def test_limits_stop_a_run_after_so_many_events() -> None:
    run = hb.simulate(clock(), 100.0, limits=hb.Limits(events=5), on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N404"
    assert run.t_end == pytest.approx(4.0, abs=1.001)


def test_a_journal_has_the_events_that_the_result_does_not_keep(tmp_path: Path) -> None:
    file = tmp_path / "events.csv"
    run = hb.simulate(clock(), 20.5, keep=hb.Journal(file, last=3))
    with file.open(newline="") as opened:
        times = [float(row["t"]) for row in csv.DictReader(opened)]
    assert times == pytest.approx(list(range(21)), abs=1e-9)
    assert len(list(run.events)) < 21


def test_a_band_is_half_as_wide_as_the_swing_in_it() -> None:
    m = hb.Model("chatter")
    m.signal(x=hb.Integral("rate", start=0.0), rate="0.25 - sign_of", sign_of="n.e")
    m.add(n=hb.Zero(), s=hb.One(), one=hb.Se(1.0), r=hb.R(1.0))
    m.bond("one -> s -> n -> r")
    rules = ["low -> high when x > 0", "high -> low when x < 0"]
    m.machine("m", states={"low": [], "high": ["s"]}, start="low", rules=rules)
    run = hb.simulate(m, 3.0, sliding=hb.Hysteresis(0.1))
    x = run.sample([k / 1000 for k in range(1000, 3000)], ["x"])["x"]
    assert (min(x), max(x)) == pytest.approx((-0.1, 0.1), abs=2e-3)


def test_each_option_stands_in_the_same_words_everywhere() -> None:
    """One declaration: what calls, files and the command line take is what it says."""
    assert set(RunOptions.__annotations__) == set(ASKED)
    for function in (hb.simulate, hb.run_script):
        assert set(ASKED) <= inspect.signature(function).parameters.keys()
    said = inspect.getdoc(hb.simulate) or ""
    for name in ASKED:
        described = re.search(rf"^{name} : .*\n((?:    .*\n)+)", said, re.M)
        assert described, name
        default = OPTIONS[name].default if name in OPTIONS else None
        if isinstance(default, int):
            assert f"default {default:,}" in described[1]
        elif isinstance(default, float):
            assert f"{default:g}".replace("e-0", "e-") in described[1] or "1/2" in described[1]
        elif isinstance(default, str):
            assert default in described[0]
    written = {f.name for f in msgspec.structs.fields(Experiment)}
    assert set(OPTIONS) <= written
    words = parse(["run", "ball.toml"])
    assert set(CALLED) <= vars(words).keys()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", [21098, 32889])
def test_steps_without_end_of_explicit_methods_name_the_method_that_has_few(seed: int) -> None:
    """What is faster than a step swings across a guard where it rests: that is no event."""
    recipe = random_recipe(seed, controlled=True)
    with pytest.raises(hb.HybondError, match="HB-N409") as caught:
        hb.simulate(recipe.model(), recipe.until, solver="rk45", max_events=1000, max_steps=20000)
    assert "solver = 'auto'" in caught.value.hint
    runs = [hb.simulate(recipe.model(), recipe.until, solver=s) for s in ("auto", "radau")]
    assert all(run.status == "ok" and len(run.events) < 1000 for run in runs)
    times = [k * recipe.until / 7.3 for k in range(1, 8)]
    for name in recipe.stored:
        values = [np.asarray(run[name].at(times)) for run in runs]
        size = max(float(np.abs(run[name].y).max()) for run in runs)
        assert values[0] == pytest.approx(values[1], abs=1e-5 * size)


def test_events_without_end_name_the_method_that_has_few_if_steps_are_explicit() -> None:
    for solver in ("auto", "radau", "rk45"):
        run = hb.simulate(clock(), 100.0, solver=solver, max_events=5, on_error="return")
        assert run.error is not None and run.error.code == "HB-N404"
        assert ("solver = 'auto'" in run.error.hint) == (solver == "rk45")
