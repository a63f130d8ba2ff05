"""A source that is a multiple of what it reads is that in a jump, too; others say what they leave.

Oracles: the same graph with the two-port that the sources stand for, charge shared in closed form
(q1 + n q2 is conserved through n turns), flux of a coil times a transconductance, time-stepping,
which knows no impulses.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

import hybond as hb


def shared(pair: str, n: float, *, c1: float = 1.0, c2: float = 1.0) -> hb.Model:
    """Two capacitors that a switch joins through n turns."""
    m = hb.Model("shared", domain="electrical", parameters={"n": n})
    m.add(C1=hb.C(c1, e="10 V"), C2=hb.C(c2, e="1 V"), a=hb.Zero(), b=hb.Zero(), S=hb.One())
    m.bond("a -> C1", "a -> S")
    if pair == "two-port":
        m.add(t=hb.TF("1/n"))
        m.bond("S -> t -> b -> C2")
    else:
        m.add(q=hb.Zero(), i=hb.One(), takes=hb.Sf("n*i.f"), gives=hb.Se("n*q.e"))
        m.bond("S -> q -> takes", "gives -> i -> b -> C2")
    return closing(m)


def closing(m: hb.Model) -> hb.Model:
    rules = ["open -> shut when time >= 1 s"]
    m.machine("switch", states={"open": [], "shut": ["S"]}, start="open", rules=rules)
    return m


@pytest.mark.parametrize("n", [2.0, -0.5, 30.0])
def test_charge_is_shared_through_two_sources_as_through_a_transformer(n: float) -> None:
    c1, c2 = 2.0, 0.25
    twin, own = (hb.simulate(shared(p, n, c1=c1, c2=c2), "2 s") for p in ("two-port", "sources"))
    # what leaves C1 is n times what comes to C2, and voltages end at 1:n
    v = (10.0 * c1 + n * 1.0 * c2) / (c1 + n * n * c2)
    for run in (twin, own):
        assert float(run["C1.e"].at(1.5)) == pytest.approx(v, rel=1e-12)
        assert float(run["C2.e"].at(1.5)) == pytest.approx(n * v, rel=1e-12)
        assert not run.warnings
        assert run.audit().holds()
    before = 0.5 * (c1 * 100.0 + c2)
    energy = own.events[-1].steps[-1].energy
    assert energy is not None
    assert energy.source == pytest.approx(0.0, abs=1e-12 * before)
    assert energy.lost == pytest.approx(before - 0.5 * v * v * (c1 + n * n * c2), rel=1e-12)
    rows = {row.name: row for row in own.losses().rows}
    assert rows["gives"].supplied == pytest.approx(-rows["takes"].supplied, rel=1e-12)
    assert sum(row.lost for row in rows.values()) == pytest.approx(energy.lost, rel=1e-12)


def test_time_stepping_comes_to_the_same() -> None:
    run = hb.simulate(shared("sources", 2.0), "1.1 s", method=hb.MoreauJean(step="5 ms"))
    assert float(run["C2.e"].at(1.1)) == pytest.approx(4.8, rel=1e-9)


def test_the_derivative_of_such_a_jump() -> None:
    n = 2.0
    found = hb.sensitivities(shared("sources", n), "1.5 s", wrt=["n"], of=["C1.e"])
    v = (10.0 + n) / (1 + n * n)
    assert float(found["C1.e", "n"][-1]) == pytest.approx((1 - 2 * n * v) / (1 + n * n), rel=1e-9)


def test_two_sources_that_are_a_gyrator_interrupt_it() -> None:
    """A capacitor behind a gyrator is a coil of r^2 C: what opens feels its flux."""
    runs = []
    for pair in ("two-port", "sources"):
        m = hb.Model("gyrator", domain="electrical", parameters={"r": "0.5 ohm"})
        m.add(V=hb.Se("6 V"), Rs=hb.R("3 ohm"), i=hb.One(), S=hb.One(), p=hb.Zero(), k=hb.Zero())
        m.add(C=hb.C("2 F"))
        m.bond("V -> i -> Rs", "i -> S -> p")
        if pair == "two-port":
            m.add(g=hb.GY("r"))
            m.bond("p -> g -> k -> C")
        else:
            m.add(takes=hb.Sf("k.e/r"), gives=hb.Sf("p.e/r"))
            m.bond("p -> takes", "gives -> k -> C")
        rules = ["on -> off when time >= 1 s"]
        m.machine("switch", states={"on": ["S"], "off": []}, start="on", rules=rules)
        runs.append(hb.simulate(m, "2 s"))
    current = float(runs[0]["S.f"].at(1.0, side="left"))
    for run in runs:
        assert run.events[-1].steps[-1].impulses["S.e"] == pytest.approx(0.5 * current, rel=1e-9)
        assert float(run["C.q"].at(1.5)) == 0.0


@pytest.mark.parametrize(("impulsive", "charge"), [(None, 0.5), (True, 0.5), (False, 0.0)])
def test_a_transconductance_reads_the_flux_of_a_coil(impulsive: bool | None, charge: float) -> None:
    m = hb.Model("coil", domain="electrical", parameters={"g": "0.25 S"})
    m.add(V=hb.Se("0 V"), L=hb.I("2 H", f="1 A"), S=hb.One(), C=hb.C("3 F"), k=hb.Zero())
    m.add(s=hb.Sf("g*S.e", impulsive=impulsive))
    m.bond("V -> S -> L", "s -> k -> C")
    rules = ["on -> off when time >= 1 s"]
    m.machine("switch", states={"on": ["S"], "off": []}, start="on", rules=rules)
    run = hb.simulate(m, "2 s")
    assert float(run["C.q"].at(1.5)) == pytest.approx(charge, rel=1e-9)  # 0.25 S of 2 V s
    assert not any("HB-J104" in w for w in run.warnings)


@pytest.mark.parametrize(("at", "turns"), [("0.5", 2.0), ("1", 3.0), ("1.2", 3.0)])
def test_turns_may_be_switched_at_given_times(at: str, turns: float) -> None:
    """What is behind the instant counts: before the switch, with it, and while all are joined."""
    m = hb.Model("late", domain="electrical")
    m.add(C1=hb.C(1.0, e="10 V"), C2=hb.C(1.0, e="0 V"), a=hb.Zero(), b=hb.Zero(), S=hb.One())
    n = f"(if time >= {at} then {turns} else 1)"
    m.add(q=hb.Zero(), i=hb.One(), takes=hb.Sf(f"{n}*i.f"), gives=hb.Se(f"{n}*q.e"))
    m.bond("a -> C1", "a -> S -> q -> takes", "gives -> i -> b -> C2")
    run = hb.simulate(closing(m), "1.5 s")
    # at 1.2 s both have 5 V: q1 + n q2 is 5 C + n 5 C from there on
    given = 5.0 + turns * 5.0 if at == "1.2" else 10.0
    v = given / (1.0 + turns**2)
    assert float(run["C1.e"].at(1.4)) == pytest.approx(v, rel=1e-12)
    assert float(run["C2.e"].at(1.4)) == pytest.approx(turns * v, rel=1e-12)
    energy = run.events[-1].steps[-1].energy
    assert energy is not None
    assert energy.source == pytest.approx(0.0, abs=1e-12 * 50.0)
    assert not run.warnings


def read(value: str, load: hb.Part | None = None, impulsive: bool | None = None) -> hb.Model:
    """1 F at 3 V and 2 F are joined: 2 C pass the switch, which the source `s` reads."""
    m = hb.Model("read", domain="electrical")
    m.add(A=hb.C("1 F", e="3 V"), B=hb.C("2 F"), a=hb.Zero(), S=hb.One(), k=hb.Zero())
    m.add(s=hb.Sf(value, impulsive=impulsive), load=load or hb.C("1 F"))
    m.bond("a -> A", "a -> S -> B", "s -> k -> load")
    return closing(m)


LEFT_OUT = {
    "abs(S.f)": "gives none of its own, though",
    'if switch.state == "shut" then 5*S.f else 0': "gives none of its own, though",
    "max(S.f, -1)": "gives none of its own, though",
    "S.f*S.f/1 [A]": "of an impulse its value has no meaning",
    "S.f*A.e/1 [V]": "of an impulse its value has no meaning",
}


@pytest.mark.parametrize("value", list(LEFT_OUT))
def test_what_is_left_out_is_said(value: str) -> None:
    run = hb.simulate(read(value), "1.5 s")
    (said,) = run.warnings
    assert "HB-J104: in a jump s (Sf" in said
    assert LEFT_OUT[value] in said
    assert not hb.simulate(read(value, impulsive=False), "1.5 s").warnings


@pytest.mark.parametrize(
    ("value", "charge"),
    [("5*S.f", 10.0), ("5*S.f*(1 + time/1 [s]) + 1 [A]", 20.0), ("min(S.f, 1 [A])", 0.0)],
)
def test_what_has_the_impulse_of_its_value_says_nothing(value: str, charge: float) -> None:
    run = hb.simulate(read(value), "1 s")
    assert not run.warnings
    # what came before the jump is the constant's
    before = 1.0 if value.endswith("1 [A]") else 0.0
    assert float(run["load.q"].at(1.0)) == pytest.approx(charge + before, rel=1e-9)


def test_what_is_declared_acts_by_its_slopes_and_says_so_if_that_is_not_its_value() -> None:
    shut = 'if switch.state == "shut" then 5*S.f else 0'
    run = hb.simulate(read(shut, impulsive=True), "1.5 s")
    assert float(run["load.q"].at(1.5)) == pytest.approx(10.0, rel=1e-9)
    assert not any("HB-J104" in w for w in run.warnings)
    run = hb.simulate(read("max(S.f, -1)*1", impulsive=True), "1.5 s")
    assert not any("HB-J104" in w for w in run.warnings)
    run = hb.simulate(read("min(S.f, 1 [A])", impulsive=True), "1.5 s")
    assert any("HB-J104" in w and "is declared impulsive" in w for w in run.warnings)


def test_a_law_that_bends_takes_no_impulse() -> None:
    load = hb.R({"e": "f^3*1 [ohm/A^2]"})
    with pytest.raises(hb.HybondError, match="HB-N303") as caught:
        hb.simulate(read("5*S.f", load), "1.5 s")
    assert "`impulsive = false` at s" in str(caught.value)
    run = hb.simulate(read("5*S.f", load, impulsive=False), "1.5 s")
    assert float(run["A.q"].at(1.5)) == pytest.approx(1.0, rel=1e-9)


def test_a_netlist_with_sources_that_compute(tmp_path: Path) -> None:
    """A B and an F that are a transformer: 10 V and 1 uF through 1:2 to 1 uF are 2 V and 4 V."""
    rows = [
        "charge", "C1 p 0 1u IC=10", "S1 p q g 0 SW", "F1 q 0 V1 2", "B1 s x V=2*v(q)", "V1 s a 0",
        "R9 x 0 0", "C2 a 0 1u", "R1 a 0 1g", "Vg g 0 PULSE(0 1 1m 1n 1n 1 2)",
        ".model SW SW(VT=0.5 RON=0 ROFF=1e12)", ".tran 1u 1.1m uic",
        ".meas tran va find v(a) at=1.01m", ".meas tran vp find v(p) at=1.01m", ".end",
    ]  # fmt: skip
    (tmp_path / "charge.cir").write_text("\n".join(rows) + "\n")
    run = hb.simulate(hb.read_circuit(tmp_path / "charge.cir").model, "1.05 ms")
    (event,) = [e for e in run.events if 0.0 < e.t < 1.05e-3]
    energy = event.steps[-1].energy
    assert energy is not None
    assert float(run["a.e"].at(1.01e-3)) == pytest.approx(4.0, rel=1e-6)
    assert energy.lost == pytest.approx(40e-6, rel=1e-6)


def chain(seed: int, *, real: bool) -> hb.Model:
    """A tree of capacitors that switches and transformers join at once, or what stands for them."""
    draw = random.Random(seed)
    m = hb.Model("tree", domain="electrical")
    n = draw.randint(2, 5)
    for k in range(n):
        m.add(**{f"C{k}": hb.C(10 ** draw.uniform(-2, 2), e=draw.uniform(-10, 10))})
        m.add(**{f"v{k}": hb.Zero()})
        m.bond(f"v{k} -> C{k}")
    for k in range(1, n):
        j, r = draw.randrange(k), 10 ** draw.uniform(-1, 1) * draw.choice([1, -1])
        m.add(**{f"S{k}": hb.One()})
        if real:
            m.add(**{f"t{k}": hb.TF(r)})
            m.bond(f"v{j} -> S{k} -> t{k} -> v{k}")
        elif k % 2:  # e1 = r e2 and f2 = r f1
            m.add(**{f"a{k}": hb.Se(f"{r!r}*v{k}.e"), f"b{k}": hb.Sf(f"{r!r}*S{k}.f")})
            m.bond(f"v{j} -> S{k} -> a{k}", f"b{k} -> v{k}")
        else:  # e2 = e1/r and f1 = f2/r
            m.add(**{f"q{k}": hb.Zero(), f"i{k}": hb.One()})
            m.add(**{f"a{k}": hb.Se(f"q{k}.e/{r!r}"), f"b{k}": hb.Sf(f"i{k}.f/{r!r}")})
            m.bond(f"v{j} -> S{k} -> q{k} -> b{k}", f"a{k} -> i{k} -> v{k}")
    shut = [f"S{k}" for k in range(1, n)]
    rules = ["open -> shut when time >= 0.1 s"]
    m.machine("switches", states={"open": [], "shut": shut}, start="open", rules=rules)
    return m


@pytest.mark.parametrize("seed", range(6))
def test_trees_of_sources_share_what_trees_of_transformers_share(seed: int) -> None:
    twin, own = (hb.simulate(chain(seed, real=real), "0.1 s") for real in (True, False))
    stored = [name for name in twin.final if name.endswith(".q")]
    size = max(abs(float(twin[name].at(0.1))) for name in stored)
    for name in stored:
        assert float(own[name].at(0.1)) == pytest.approx(float(twin[name].at(0.1)), abs=1e-9 * size)
    lost = [run.events[-1].steps[-1].energy for run in (twin, own)]
    assert lost[0] is not None and lost[1] is not None
    assert lost[1].lost == pytest.approx(lost[0].lost, rel=1e-9)
    assert not own.warnings
