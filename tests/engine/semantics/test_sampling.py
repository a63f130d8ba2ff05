"""Sampled signals: set at instants, held between, by any method."""

import math

import numpy as np
import pytest

import hybond as hb

SOLVERS = {
    "rk45": {},
    "radau": {"solver": "radau"},
    "exact": {"solver": "exact"},
    "time-stepping": {"solver": "moreau-jean", "step": 1e-4},
}


def loop() -> hb.Model:
    """A flywheel with friction whose speed a sampled PI controller holds."""
    m = hb.Model(
        "loop",
        domain="rotational",
        parameters={"T": "2 ms", "kp": "0.4 N*m*s/rad", "ki": "30 N*m/rad"},
    )
    m.add(J=hb.I("0.01 kg*m^2"), B=hb.R("0.02 N*m*s/rad"), u=hb.Se("torque"), w=hb.One())
    m.bond("u -> w -> J", "w -> B")
    m.input(ref=hb.Input(table=[(0, 10), ("51 ms", 5)]))
    m.signal(
        error="ref - w.f",
        torque=hb.Sampled("kp*error + ki*sum", every="T"),
        sum=hb.Sampled("sum + T*error", every="T", start=0.05),
    )
    return m


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_sampled_loop_is_its_difference_equation(solver: str) -> None:
    run = hb.simulate(loop(), until="0.1 s", rtol=1e-10, **SOLVERS[solver])
    w, total = 0.0, 0.05
    close = 1e-5 if solver == "time-stepping" else 1e-8  # a method of second order
    a = math.exp(-0.02 / 0.01 * 2e-3)
    for n in range(50):
        error = (10 if n < 26 else 5) - w
        torque, total = 0.4 * error + 30 * total, total + 2e-3 * error
        assert run["torque"].at(n * 2e-3 + 1e-3) == pytest.approx(torque, rel=close)
        w = a * w + (1 - a) / 0.02 * torque
    assert run["w.f"].at(0.1) == pytest.approx(w, rel=close)


def test_a_sample_is_a_priori_and_all_of_an_instant_are_set_at_once() -> None:
    m = hb.Model("swap")
    m.add(V=hb.Se("u"), R=hb.R(1), i=hb.One())
    m.bond("V -> i -> R")
    m.input(u=hb.Input(table=[(0, 1), (1, 2)]))
    m.signal(
        a=hb.Sampled("b", every=1, start=10),
        b=hb.Sampled("a", every=1, start=20),
        seen=hb.Sampled("i.f", every=1),
        late=hb.Sampled("time", every=1, phase=0.5, start=-1),
    )
    run = hb.simulate(m, until=3.2)
    for t, a, b, seen, late in (
        (0.0, 20, 10, 1, -1),
        (1.0, 10, 20, 1, 0.5),
        (2.0, 20, 10, 2, 1.5),
        (3.0, 10, 20, 2, 2.5),
    ):
        assert [run[n].at(t) for n in ("a", "b", "seen", "late")] == [a, b, seen, late]
    assert run["a"].at(1.0, side="left") == 20
    assert run["late"].at(0.5, side="left") == -1 and run["late"].at(0.5) == 0.5


def test_instants_do_not_drift() -> None:
    m = hb.Model("clock")
    m.add(i=hb.One(), source=hb.Sf(1.0), r=hb.R(1.0))
    m.bond("source -> i -> r")
    m.signal(held=hb.Sampled("time", every=0.1, phase=0.03))
    run = hb.simulate(m, until=200.0)
    # each at its own place, not at a sum of periods
    assert [s.t[0] for s in run.segments[1:]] == [0.03 + n * 0.1 for n in range(2000)]


def test_a_guard_that_reads_a_sample_fires_at_the_instant_and_says_so() -> None:
    m = hb.Model("thermostat", domain="electrical")
    m.add(V=hb.Se("10 V"), s=hb.One(), n=hb.Zero(), R=hb.R("1 kohm"), C=hb.C("1 uF"))
    m.bond("V -> s -> n -> C", "s -> R")
    m.signal(level=hb.Sampled("C.e", every="0.3 ms"))
    m.machine(
        "relay",
        states={"on": ["s"], "off": []},
        start="on",
        rules=["on -> off when level > 5", "off -> on when level < 4"],
    )
    run = hb.simulate(m, until="2 ms")
    (event,) = list(run.events)[1:]
    assert event.t == 0.3e-3 * 3 and event.cause == "sample"  # the first sample after RC*ln(2)
    assert run["C.e"].at(2e-3) == pytest.approx(10 * (1 - math.exp(-0.9)), rel=1e-6)


def test_a_step_of_a_sample_onto_a_capacitor_is_an_impulse() -> None:
    m = hb.Model("hold", domain="electrical")
    m.add(V=hb.Se("u"), C=hb.C("1 uF"), i=hb.One())
    m.bond("V -> i -> C")
    m.signal(u=hb.Sampled("2 + 3*time/(1 [s])", every="1 s"))
    run = hb.simulate(m, until="1.5 s")
    assert run["C.q"].at(1.2) == pytest.approx(5e-6, rel=1e-12)
    assert run["i.f"].at(1.2) == 0.0


def test_a_value_that_is_none_ends_the_run_and_keeps_it() -> None:
    m = loop()
    m.signal(bad=hb.Sampled("1/(5e-3 - time)", every="1 ms"))
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, until="0.1 s")
    assert (caught.value.code, caught.value.where) == ("HB-N305", "signals.bad")
    assert caught.value.partial["w.f"].at(4e-3) > 0


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"every": 0}, "HB-M151"),
        ({"every": "1 ms", "phase": -1}, "HB-M151"),
        ({"every": "1 m"}, "HB-U103"),
        ({"every": "1 ms", "start": "1 V"}, "HB-U102"),
    ],
)
def test_what_cannot_be_sampled_is_refused(given: dict[str, object], code: str) -> None:
    m = loop()
    m.signal(seen=hb.Sampled("w.f", **given))
    with pytest.raises(hb.HybondError) as caught:
        m.flatten()
    assert caught.value.code == code


def test_files_and_equations_know_samples() -> None:
    model = loop()
    for format in ("toml", "json"):
        assert hb.loads(hb.dumps(model, format=format), format=format).signals == model.signals
    text = str(hb.state_equations(model))
    assert "torque = 0.4 [N*m*s]*(ref - u.f) + 30 [N*m/rad]*sum  every 2 ms" in text
    assert r"\quad\text{every 2 ms}" in hb.state_equations(model).latex()
    with pytest.raises(hb.FileError) as caught:
        hb.loads('hybond = 1\n[signals]\na = { sample = "time" }\n')
    assert caught.value.code == "HB-F111"
    with pytest.raises(hb.FileError) as caught:
        hb.loads('hybond = 1\n[signals]\na = { integral = "time", every = 1 }\n')
    assert caught.value.code == "HB-F113"


def test_a_condition_counts_as_one_or_zero() -> None:
    m = loop()
    m.signal(fast=hb.Sampled("w.f > 5 [rad/s]", every="T"))
    run = hb.simulate(m, until="0.1 s")
    assert run["fast"].at(1e-3) == 0.0 and run["fast"].at(0.05) == 1.0


def chain() -> hb.Model:
    """Two samplers, of which the second reads the first a period later, and edges of pulses."""
    m = hb.Model("chain")
    m.add(V=hb.Se("wave"), R=hb.R(1), i=hb.One(), C=hb.C(1))
    m.bond("V -> i -> R", "i -> C")
    m.input(wave=hb.Input(pwm={"period": "1 ms", "duty": 0.3}))
    m.signal(
        read=hb.Sampled("time/(1 ms)", every="1 ms"),
        late=hb.Sampled("read", every="1 ms", phase="1 ms"),
        edge=hb.Sampled("V.e", every="0.1 ms"),
    )
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_instants_that_are_one_but_for_rounding_are_one(solver: str) -> None:
    """10*0.001 and 0.001 + 9*0.001 differ in the last bit: what is read is a period old."""
    run = hb.simulate(chain(), until="0.1 s", **SOLVERS[solver])
    k = np.arange(1000)
    t = ((k + 0.5) * 1e-4).tolist()
    assert run["late"].at(t) == pytest.approx(np.maximum(k // 10 - 1, 0), abs=1e-9)
    # the value just before the instant: the pulse begins after one and ends with one
    before = (k % 10 >= 1) & (k % 10 <= 3)
    before[0] = True  # nothing is before the start
    assert np.asarray(run["edge"].at(t)).tolist() == before.astype(float).tolist()


def test_what_is_sampled_where_the_time_passes_a_bound_is_what_held_before() -> None:
    m = hb.Model("clock")
    m.add(feed=hb.Sf(1.0), n=hb.Zero(), store=hb.C(1.0))
    m.bond("feed -> n -> store")
    m.input(edge=hb.Input(table=[[0, 0], [1, 5], [2, 7]]))
    m.signal(
        below=hb.Sampled("if time < 1 [s] then 1 else 2", every=0.5),
        beyond=hb.Sampled("if time >= 1 [s] then 1 else 0", every=0.5),
        step=hb.Sampled("edge", every=0.5),
        now=hb.Sampled("time", every=0.5),
    )
    run = hb.simulate(m, until=2)
    seen = {
        name: [run[name].at(t) for t in (0.5, 1.0, 1.5)]
        for name in ("below", "beyond", "step", "now")
    }
    assert seen == {
        "below": [1, 1, 2],
        "beyond": [0, 0, 1],
        "step": [0, 0, 5],
        "now": [0.5, 1.0, 1.5],
    }


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["friction", "diode", "contact"])
def test_what_is_sampled_at_the_start_is_of_branches_that_stand(kind: str, turned: bool) -> None:
    """Laws are declared at rest, blocking and open: nothing of that is in what moves already."""
    m = hb.Model("start", domain="translational")
    if kind == "diode":
        m.add(store=hb.C(1.0, e=5.0), n=hb.Zero(), law=hb.One(law="diode"), rub=hb.R(2.0))
        m.bond("n -> store", "n -> law", "rub -> law" if turned else "law -> rub")
        expected = {"law.f": 2.5, "n.e": 5.0}
    else:
        m.add(body=hb.I(2.0, f=3.0), v=hb.One(), push=hb.Se(-4.0))
        m.bond("push -> v -> body")
        m.add(law=hb.One(law="coulomb", limit=1.5) if kind == "friction" else hb.Zero(law="diode"))
        if kind == "contact":
            # a body that pushes a damper in front of it
            m.add(rub=hb.R(0.5), w=hb.One())
            m.bond("v -> law -> w", "rub -> w" if turned else "w -> rub")
            expected = {"law.e": 1.5, "w.f": 3.0}
        else:
            m.bond("law -> v" if turned else "v -> law")
            expected = {"law.f": 3.0, "body.e": -5.5}
    m.signal({f"s{k}": hb.Sampled(name, every=1.0) for k, name in enumerate(expected)})
    run = hb.simulate(m, 0.1)
    for k, (name, value) in enumerate(expected.items()):
        assert run[f"s{k}"].at(0.05) == pytest.approx(value), name
