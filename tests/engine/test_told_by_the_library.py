"""What runs warn of, and why they are refused: the words stand in ``told.json``."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import hybond as hb
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.engine import REFUSED, make_engine
from hybond.engine.laws import law_branches, law_candidates, law_jumping
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.faults import Fault, error_of
from hybond.engine.outcome.warned import NO_SIGN, NO_SOLUTION, NO_WAY_ON, OPEN, Warnings
from hybond.engine.run import motion, run_records
from hybond.engine.run.log import make_report
from hybond.engine.tables import answered, tables_of
from hybond.engine.tables.options import METHODS

Run = Callable[..., hb.Result]
LIMITS = {"max_writes": 10_000.0, "max_events": 1e6, "max_steps": 4e6}


WRITTEN = json.loads(Path(__file__).with_name("told.json").read_text(encoding="utf-8"))


def told(model: hb.Model, until: float, **options: object) -> hb.Result:
    return hb.simulate(model, until=until, on_error="return", **options)  # type: ignore[arg-type]


@pytest.fixture
def said(request: pytest.FixtureRequest) -> Callable[..., hb.Result]:
    """Run a model, and hold what is said of it against what is written."""

    def run(model: hb.Model, until: float, **options: object) -> hb.Result:
        found = told(model, until, **options)
        error = found.error
        words = None if error is None else [error.code, error.why, error.where, error.hint]
        name = request.node.name
        assert {"warnings": list(found.warnings), "error": words} == WRITTEN[name]
        return found

    return run


def signum(machine: str) -> str:
    return f'(if {machine}.state == "above" then 1 else -1)'


def system(rates: list[str], start: list[float]) -> hb.Model:
    """Return ``x_k' = rates[k]``: a C fed by a modulated source per state."""
    m = hb.Model("system")
    for k, (rate, x0) in enumerate(zip(rates, start, strict=True), 1):
        m.add(**{f"x{k}": hb.C(1.0, q=x0), f"s{k}": hb.Sf(rate), f"n{k}": hb.Zero()})
        m.bond(f"s{k} -> n{k} -> x{k}")
    return m


def relay(m: hb.Model, name: str, function: str, start: str = "below") -> None:
    rules = [f"above -> below when {function} < 0", f"below -> above when {function} > 0"]
    m.machine(name, states={"above": [], "below": []}, start=start, rules=rules)


# -- warnings


def two_futures() -> hb.Model:
    m = system([signum("r")], [0.0])
    relay(m, "r", "x1.q")
    return m


def twins() -> hb.Model:
    m = system([f"-{signum('a')} - 0.5*{signum('b')}"], [-1.0])
    relay(m, "a", "x1.q")
    # asks for more: it need not cross together with the other
    rules = ["above -> below when x1.q < 0 and x1.q < 7", "below -> above when x1.q > 0"]
    m.machine("b", states={"above": [], "below": []}, start="below", rules=rules)
    return m


def own_jump() -> hb.Model:
    """Return y = x + 0.1 sgn', which jumps the way of a hysteresis."""
    m = system([f"-{signum('r')}"], [-1.0])
    relay(m, "r", 'x1.q + 0.1*(if r.state == "above" then 1 else -1)')
    return m


def wedge() -> hb.Model:
    """Return a rigid contact whose friction moves the body off it (Painleve)."""
    m = hb.Model("wedge", domain="translational")
    m.add(a=hb.I("1 kg"), b=hb.I("1 kg", f="0.5 m/s"), va=hb.One(), vb=hb.One())
    m.add(F=hb.Se("1 N"), contact=hb.Zero(law="unilateral", gap="y"))
    m.add(tf=hb.TF(2.0), rub=hb.Zero(), slip=hb.One(law="coulomb", limit="1.0*contact.e"))
    m.bond("F -> va -> a", "contact -> va", "vb -> b", "va -> tf -> rub", "vb -> rub -> slip")
    m.signal(y=hb.Integral("va.f", "0 m"))
    return m


def sliding_impact(slip: float) -> hb.Model:
    """Return a body that hits the floor at 100 m/s while it slides."""
    m = hb.Model()
    m.add(my=hb.I(1, f=-100), mx=hb.I(1, f=slip), vx=hb.One(), vy=hb.One(), c=hb.Zero())
    m.add(reb=hb.Sf(0), fr=hb.R({"e": "0.2*c.e*sign(f)"}, impulsive=True))
    m.bond("vy -> my", "c -> vy", "reb -> c", "vx -> mx", "vx -> fr")
    m.machine(
        "F", states={"air": [], "hit": ["c"]}, start="air", rules=["air -> hit when time >= 1"]
    )
    return m


def floating(indeterminate: str) -> hb.Model:
    """Return two switches in series: the node between them floats while both are open."""
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se("10 V"), s1=hb.One(), n=hb.Zero(), s2=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> s1 -> n -> s2 -> R")
    rules = ["off -> on when n.e > 3 and R.f < 1"]
    m.machine("k", states={"off": [], "on": ["s1", "s2"]}, start="off", rules=rules)
    m.indeterminate = indeterminate  # type: ignore[assignment]
    return m


def far_apart(leakage: float) -> hb.Model:
    m = hb.Model("leak", domain="electrical")
    m.add(C1=hb.C("1 nF", e="1 V"), C2=hb.C("1 nF", e="1 V"), n1=hb.Zero(), n2=hb.Zero())
    m.add(b=hb.One(), x=hb.One(), r=hb.R(1e-3), R=hb.R(leakage))
    m.bond("n1 -> C1", "n2 -> C2", "n1 -> b -> n2", "n1 -> x -> n2", "x -> r", "n1 -> R")
    return m


def lift() -> hb.Model:
    """Return a ball on a table whose speed, which may change, stands in the impact law by hand."""
    m = hb.Model("lift", domain="translational")
    m.signal(u=hb.Integral("0*u", start=0.2))
    m.add(w=hb.Se(-9.81), b=hb.I(1.0), v=hb.One(), c=hb.Zero(), r=hb.Sf("1.5*u - 0.5*pre(v.f)"))
    m.bond("w -> v -> b", "c -> v", "r -> c")
    m.signal(gap=hb.Integral("v.f - u", start=0.5))
    rules = ["away -> impact when gap <= 0 and v.f < u", "impact -> away when pre(b.f) >= pre(u)"]
    m.machine("F", states={"away": [], "impact": ["c"]}, start="away", rules=rules)
    return m


@pytest.mark.parametrize(
    ("model", "until", "word"),
    [
        (two_futures(), 1.0, "not unique: 3 ways lead on"),
        (twins(), 2.0, "both switch on x1.q = 0: only a slides"),
        (wedge(), 0.01, "2 answers"),
        (sliding_impact(50.0), 2.0, "enter the jump equations: fr"),
        (floating("least leakage"), 1.0, "reads n.e, which the equations leave open in mode (off)"),
        (far_apart(1e7), 1e-2, "few digits"),
        (lift(), 5.0, "F cannot rest: its rebounds do not vanish"),
    ],
    ids=lambda a: a if isinstance(a, str) else "",
)
def test_a_warning(said: Run, model: hb.Model, until: float, word: str) -> None:
    run = said(model, until)
    assert any(word in w for w in run.warnings)


def astable() -> hb.Model:
    """Return an amplifier that compares its capacitor with half of what it gives itself."""
    m = hb.Model("astable", domain="electrical")
    m.add(o=hb.Se('if q.state == "high" then 5 V else -5 V'), j=hb.One(), r=hb.R("1 kohm"))
    m.add(c=hb.C("1 uF", e="0.1 V"))
    m.bond("o -> j", "j -> r", "j -> c")
    rules = ["high -> low when c.e > 0.5*o.e", "low -> high when c.e < 0.5*o.e"]
    m.machine("q", states={"high": [], "low": []}, start="high", rules=rules)
    return m


@pytest.mark.parametrize(
    ("model", "until", "events"),
    [(own_jump(), 1.95, 5), (astable(), 10e-3, 9)],
    ids=["y", "astable"],
)
def test_no_word_of_a_comparator_that_is_fed_back(
    model: hb.Model, until: float, events: int
) -> None:
    run = told(model, until)
    assert run.warnings == ()
    # y by 0.1 each way, at 1.1 s and every 0.2 s; the voltage by ln 3 of RC
    assert len(run.events) == 1 + events


@pytest.mark.parametrize("leakage", [1e3, 1e5])
def test_no_word_of_what_is_well(leakage: float) -> None:
    assert told(far_apart(leakage), 1e-3).warnings == ()


def test_a_warning_without_a_time_is_said_once() -> None:
    m = sliding_impact(50.0)
    m.machines["F"] = type(m.machines["F"])(
        m.machines["F"].states,
        "air",
        [*m.machines["F"].rules, "hit -> air when time >= 1.2", "air -> hit when my.f < -1"],
    )
    run = told(m, 2.0)
    assert sum("jump equations" in w for w in run.warnings) == 1


def test_reasons_that_no_small_model_gives_have_words() -> None:
    graph = lift().flatten()
    said = Warnings(graph, Explaining(tables_of(graph, tells=True, until=1.0)))
    for why, word in (
        (NO_SOLUTION, "no solution at rest (because)"),
        (NO_SIGN, "the impulses of c.e have no sign"),
        (OPEN, "leave c.e open"),
        (OPEN + 1, "at rest c.e = -2, which is not positive"),
    ):
        said.unrest = (why, 0, -2.0, 1)
        assert word in said.why_no_rest("because")
    graph = two_futures().flatten()
    said = Warnings(graph, Explaining(tables_of(graph, tells=True, until=1.0)))
    text = said._text(NO_WAY_ON, 0.5, [0.0])
    assert text == "no way on was found from x1.q = 0 at t = 0.5 s: events go on"


# -- refusals


def joined(*sources: str) -> hb.Model:
    m = hb.Model(domain="electrical")
    m.add(V=hb.Se(sources[0]), n=hb.Zero(), s=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> n", "n -> R")
    if len(sources) > 1:
        m.add(W=hb.Se(sources[1]))
        m.bond("W -> s -> n")
    else:
        m.add(W=hb.Se(0))
        m.bond("n -> s -> W")
    m.machine("k", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time > 1"])
    return m


def drained(law: str, start: float = 1.0) -> hb.Model:
    m = hb.Model()
    m.add(C=hb.C(1.0, e=start), r=hb.R({"f": law}), n=hb.Zero())
    m.bond("n -> C", "n -> r")
    return m


def function_of_an_impulse(guard: str) -> hb.Model:
    m = hb.Model(domain="electrical")
    m.add(A=hb.C("1 F", e="2 V"), B=hb.C("1 F"), a=hb.Zero(), b=hb.Zero(), s=hb.One())
    m.bond("a -> A", "b -> B", "a -> s -> b")
    rules = ["off -> on when time > 1", f"on -> off when {guard}"]
    m.machine("k", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


def lone_thyristor() -> hb.Model:
    m = hb.Model("lone", domain="electrical")
    m.add(t=hb.One(law="thyristor", gate="time > 1 [s]"), drive=hb.Sf("2 A"), coil=hb.I("5 mH"))
    m.bond("drive -> t -> coil")
    return m


def no_answer() -> hb.Model:
    m = wedge()
    m.elements["F"] = hb.Se("-1 N")
    return m


def sampled() -> hb.Model:
    m = drained("0")
    m.signal(held=hb.Sampled("1/(0.5 - time)", every=0.25))
    return m


def pushes() -> hb.Model:
    m = hb.Model("pushes", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit="1[N] - time*1[N/s]"), mx=hb.I(1, f=9))
    m.bond("sx -> mx")
    return m


def breaks_early() -> hb.Model:
    m = hb.Model("early", domain="translational")
    m.add(sx=hb.One(law="coulomb", limit="1[N]", breakaway="2[N] - time*1[N/s]"), mx=hb.I(1, f=9))
    m.bond("sx -> mx")
    return m


def massless() -> hb.Model:
    m = hb.Model("massless", domain="translational")
    m.add(x=hb.One(law="coulomb", limit=1), y=hb.One(law="coulomb", pair="x"))
    m.add(kx=hb.C(1, q=2), ky=hb.C(1), my=hb.I(1))
    m.bond("x -> kx", "y -> ky", "y -> my")
    return m


def opposed() -> hb.Model:
    """Return two that follow each other without end."""
    m = drained("0")
    rules = ["a -> b when C.e > 0 and time > 0.5", "b -> a when C.e > 0"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules)
    return m


REFUSALS: list[tuple[str, Callable[[], hb.Model], float, dict[str, object]]] = [
    ("HB-C101", lambda: joined("10 V", "5 V"), 2.0, {}),
    ("HB-C101", lambda: joined("10 V"), 2.0, {}),
    ("HB-J101", lambda: function_of_an_impulse("exp(s.f/(1 [A])) > 3"), 2.0, {}),
    ("HB-J101", lambda: function_of_an_impulse("1/s.f > 3"), 2.0, {}),
    ("HB-J102", lambda: floating("refuse"), 1.0, {}),
    ("HB-J103", lambda: sliding_impact(0.001), 2.0, {}),
    ("HB-J110", lone_thyristor, 0.01, {}),
    ("HB-J110", no_answer, 0.01, {}),
    ("HB-N305", sampled, 2.0, {}),
    ("HB-N401", opposed, 2.0, {}),
    ("HB-N407", pushes, 1.5, {}),
    ("HB-N407", breaks_early, 1.5, {}),
    ("HB-C105", massless, 1.0, {}),
]


@pytest.mark.parametrize(("code", "make", "until", "options"), REFUSALS, ids=lambda a: str(a)[:7])
def test_a_refusal(
    said: Run, code: str, make: Callable[[], hb.Model], until: float, options: dict[str, object]
) -> None:
    error = said(make(), until, **options).error
    assert error is not None
    assert error.code == code


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize(
    ("code", "law", "word"),
    [
        ("HB-N302", "0.5*(0.1 + sqrt(e - 0.5))", "the law of R r "),
        ("HB-N201", "-e*e", "C.q dominates the error"),
    ],
)
def test_a_step_that_fails_is_told_with_its_cause(
    code: str, law: str, word: str, solver: str
) -> None:
    error = told(drained(law), 5.0, solver=solver).error
    assert error is not None
    assert error.code == code
    assert word in error.why


def test_steps_without_number_are_told_with_their_mean() -> None:
    error = told(drained("100*e"), 50.0, max_steps=20).error
    assert error is not None
    assert error.code == "HB-N409"
    assert "s in the mean" in error.why


def test_guards_that_ask_in_vain_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact that is closed for its guard and open for what decides would creep for ever."""
    m = hb.Model("rest", domain="translational", parameters={"d": 0.2})
    m.add(weight=hb.Se("-9.81 N"), ball=hb.I("1 kg", f=-1e-11), v=hb.One())
    m.add(c=hb.Zero(law="unilateral", gap="x - d*1 [m]/2", restitution=0.9))
    m.bond("weight -> v -> ball", "c -> v")
    m.signal(x=hb.Integral("v.f", f"{0.1 + 2e-14!r} m"))
    m.add(other=hb.I("1 kg", f=220.0**0.5), w=hb.One(), n=hb.Se("0 N"))
    m.bond("n -> w -> other")
    found = law_branches.find_able

    def not_able(e, r):
        status = found(e, r)
        r.able[0] = 0
        return status

    for module in (law_branches, law_jumping):
        monkeypatch.setattr(module, "find_able", not_able)
    monkeypatch.setattr(law_candidates, "note_turned", lambda _m, _r: None)
    graph = m.flatten()
    tables = tables_of(graph, until=1e-3, tells=True)
    engine = make_engine(answered(tables))
    run = run_records.make_run(engine, make_report(engine))
    assert motion.run_to_end(engine, run) == REFUSED
    fault = engine.fault
    refusal = Refusal(
        fault.code, fault.why, fault.place, fault.t, tuple(fault.about.at[: fault.many])
    )
    fault_seen = Fault(refusal, tuple(engine.state), LIMITS, METHODS["auto"])
    error = error_of(fault_seen, graph, Explaining(tables), None, ())
    assert error.code == "HB-N406"
    assert "a guard holds 100 times in a row" in error.why
    assert "c.f > 0" in (error.where or "")
    assert "solver = 'auto'" not in (error.hint or "")
    other = error_of(
        replace(fault_seen, method=METHODS["rk45"]), graph, Explaining(tables), None, ()
    )
    assert "solver = 'auto' if the model is stiff" in (other.hint or "")
