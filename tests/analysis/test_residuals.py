"""Global residuals of the published diagnosis circuit and of small graphs done by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.residuals.relations import Module
from hybond.analysis.residuals.residuals import residuals

EXAMPLES = Path(__file__).parents[2] / "examples"
SENSORS = ["Df", "De1", "De2", "De3"]
LIMITS = {"G1": 5e-4, "G2": 8e-4, "G3": 5e-4, "G4": 3e-4}
ON_OFF = {1: "on", 0: "off"}


@pytest.fixture(scope="module")
def circuit():
    return hb.load(EXAMPLES / "diagnosis_circuit.toml")


@pytest.fixture(scope="module")
def found(circuit):
    return residuals(circuit, sensors=SENSORS)


@pytest.fixture(scope="module")
def run(circuit):
    return hb.simulate(circuit)


# -- Yu, Wang & Luo 2014


def published(symbols):
    """Return the four residuals as printed; C1 dDe1/dt is C1 times the symbol De1'."""
    V1, V2, R1, R2, R3, R4, R5, C1, C2, Df, e1, e2, e3, d1, d2, a1, a2 = symbols
    return [
        V1 - R1 * Df - e1,
        Df + a1 / R2 * (V2 - e1) - C1 * d1 - (e1 - e2) / R3,
        (e1 - e2) / R3 - C2 * d2 - a2 / R4 * (e2 - e3),
        a2 * ((e2 - e3) / R4 - e3 / R5),
    ]


def names_of_paper():
    sympy = pytest.importorskip("sympy")
    names = "V1 V2 R1.R R2.R R3.R R4.R R5.R C1.C C2.C Df De1 De2 De3 De1' De2' κ_a1 κ_a2"
    return [sympy.Symbol(n, real=True) for n in names.split()]


def test_the_published_residuals_come_out(found) -> None:
    sympy = pytest.importorskip("sympy")
    symbols = names_of_paper()
    a2 = symbols[-1]
    paper = published(symbols)
    assert len(found) == 4
    for own, printed in zip(found[:3], paper[:3], strict=True):
        assert sympy.simplify(own.sympy() - printed) == 0
    # The last one is printed with the switch in front. Ours is that while the switch is closed;
    # while it is open ours says in addition that nothing flows through R5.
    ours, printed = found["G4"].sympy(), paper[3]
    reduced = sympy.expand(a2 * ours).subs(a2**2, a2)
    assert sympy.simplify(reduced - printed) == 0
    e3, R5 = symbols[12], symbols[6]
    assert sympy.simplify(ours.subs(a2, 0) + e3 / R5) == 0


def test_the_formulas_read_as_printed(found) -> None:
    assert [r.text() for r in found] == [
        "V1 - R1.R*Df - De1",
        "Df - (De1 - De2)/R3.R - C1.C*De1' + κ_a1*(V2 - De1)/R2.R",
        "(De1 - De2)/R3.R - C2.C*De2' - κ_a2*(De2 - De3)/R4.R",
        "κ_a2*(De2 - De3)/R4.R - De3/R5.R",
    ]
    assert found["G2"].latex() == (
        r"\mathrm{Df} - \frac{\mathrm{De1} - \mathrm{De2}}{R_{\mathrm{R3}}} - C_{\mathrm{C1}} \, "
        r"\dot{\mathrm{De1}} + \kappa_{\mathrm{a1}} \, \frac{\mathrm{V2} - \mathrm{De1}}"
        r"{R_{\mathrm{R2}}}"
    )
    assert [r.origin.split()[-1] for r in found] == ["in", "n1", "n2", "n3"]
    assert found.complete and not found.unobserved and found.diagnostic.exists
    page = (EXAMPLES.parent / "docs" / "residuals.md").read_text(encoding="utf-8")
    assert str(found) in page


def test_they_vanish_along_the_trajectory(found, run) -> None:
    values = found.evaluate(run)
    assert set(values.modes) == {
        run.graph.mode_of({"S1": ON_OFF[a], "S2": ON_OFF[b]})
        for a, b in [(1, 0), (0, 0), (0, 1), (1, 1)]
    }
    assert max(values.worst().values()) < 1e-12
    times = np.linspace(0.0, 20.0, 401).tolist()
    sampled = found.evaluate(run, t=times)
    assert len(sampled.t) == 401 and max(sampled.worst().values()) < 1e-12
    assert not any(a.any() for a in sampled.alarms(LIMITS).values())


@pytest.mark.parametrize(
    ("fault", "reacting"),
    [
        ({"R1": {"R": "670 ohm*1.2"}}, {"G1"}),
        ({"C1": {"C": "1500 uF"}}, {"G2"}),
        ({"R3": {"R": "100 ohm"}}, {"G2", "G3"}),
        ({"R4": {"R": "300 ohm"}}, {"G3", "G4"}),
        ({"V2": {"Se": "1 V"}}, {"G2"}),
    ],
)
def test_a_faulty_plant_sets_off_its_signature(circuit, found, fault, reacting) -> None:
    text = hb.dumps(circuit)
    for element, value in fault.items():
        ((kind, new),) = value.items()
        old = text.split(f"\n{element} = ")[1].split("\n")[0].split("#")[0]
        text = text.replace(f"\n{element} = {old}", f'\n{element} = {{ {kind} = "{new}" }}')
    values = found.evaluate(hb.simulate(hb.loads(text)))
    quiet = {name for name, v in values.worst().items() if v < 1e-12}
    assert quiet == {"G1", "G2", "G3", "G4"} - reacting
    (name,) = fault
    signatures = found.signatures()
    own = next(f.name for f in signatures.faults if f.name in (name, f"{name}.{kind}"))
    row = signatures.signature(own)
    assert {r for r, hit in zip(signatures.residuals, row, strict=True) if hit} == reacting


def test_a_switch_that_does_not_open(found, run) -> None:
    """The circuit is in mode (off, off) from 5 to 10 s; a diagnosis that believes (on, off)."""
    times = np.linspace(5.5, 9.5, 9).tolist()
    believed = found.graph.mode_of({"S1": "on", "S2": "off"})
    alarms = found.evaluate(run, t=times, mode=believed).alarms(LIMITS)
    assert {name for name, hit in alarms.items() if hit.all()} == {"G2"}
    assert found.signatures(believed).signature("S1 stuck off") == (False, True, False, False)


def test_the_published_signature_matrix(found) -> None:
    """Coherence of parameters with residuals as the formulas show it, both switches closed."""
    signatures = found.signatures({"S1": "on", "S2": "on"})
    expected = {
        "R1.R": "1000", "R2.R": "0100", "R3.R": "0110", "R4.R": "0011", "R5.R": "0001",
        "C1.C": "0100", "C2.C": "0010", "Df": "1100", "De1": "1110", "De2": "0111", "De3": "0011",
    }  # fmt: skip
    for name, row in expected.items():
        assert signatures.signature(name) == tuple(c == "1" for c in row), name
    assert ("V2", "R2.R", "C1.C", "S1 stuck off") in signatures.groups()
    # open, R2 carries nothing, and De3 is zero whatever R5 is
    off = found.signatures({"S1": "off", "S2": "off"})
    assert set(off.undetectable()) >= {"R2.R", "V2", "R4.R", "R5.R"}
    # all modes together tell C1 and R2 apart
    every = found.signatures()
    assert "C1.C" in every.isolable() and ("V2", "R2.R", "S1 stuck off") in every.groups()
    assert "S1 stuck on" not in signatures.undetectable()


# -- by hand


def test_an_ideal_switch_between_sensors_has_two_laws_in_one_residual() -> None:
    m = hb.Model("charger")
    m.add(V=hb.Se("5 V"), sw=hb.One(), n=hb.Zero(), r=hb.R(2), c=hb.C(3))
    m.bond("V -> sw -> n -> c", "n -> r")
    m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    (only,) = residuals(m, sensors=["n.e"])
    assert only.text((0,)) == "V - n.e"
    assert only.at((1,)) == pytest.approx({"n.e": 1 / 2, "n.e'": 3.0})
    # the resistor is behind the source while the switch is closed
    signatures = only.of.signatures()
    assert signatures.signature("r.R", (0,)) == (False,)
    assert signatures.signature("r.R", (1,)) == (True,)


def test_a_residual_that_says_nothing_in_a_mode() -> None:
    """Closed, the switch draws a current through a law that is not used."""
    m = hb.Model("drain")
    m.add(tank=hb.C(2), n=hb.Zero(), sw=hb.One(), valve=hb.R({"e": "f^3"}))
    m.bond("tank -> n -> sw -> valve")
    m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    found = residuals(m, sensors=["n.e"])
    (only,) = found
    assert only.vacuous((0,)) and not only.vacuous((1,))
    assert only.text() == "(1 - κ)*tank.C*n.e'" and only.silent == ("κ",)
    assert "G1 says nothing (0 = 0) while κ = 1" in found.notes()


def test_storage_that_a_switch_hides() -> None:
    m = hb.Model("joined")
    m.add(a=hb.C(1), sw=hb.One(), b=hb.C(2), n1=hb.Zero(), n2=hb.Zero(), J=hb.Sf(1))
    m.bond("a -> n1 -> sw -> n2 -> b", "J -> n1")
    m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    found = residuals(m, sensors=["n1.e"])
    assert [(u.path, u.where) for u in found.unobserved] == [("b.q", "while (1 - κ) = 1")]
    (only,) = found
    assert only.text() == "J - a.C*n1.e' - κ*b.C*n1.e'"


def test_unknown_storage_is_found_by_derivatives() -> None:
    """Mass, spring, mass with one velocity measured: the other mass is reckoned, order four."""
    m = hb.Model("two masses", domain="translational")
    m.add(F=hb.Se("1 N"), m1=hb.I(2), k=hb.C(3), m2=hb.I(5), v1=hb.One(), v2=hb.One(), n=hb.Zero())
    m.bond("F -> v1 -> m1", "v1 -> n -> v2 -> m2", "n -> k")
    found = residuals(m, sensors=["v1.f"])
    (only,) = found
    assert only.order == 3 and found.complete and not found.unobserved
    # (m1 D + 1/(k D + 1/(m2 D))) v1 = F, multiplied out, the derivatives of a constant zero
    row = only.at(())
    scale = row["v1.f'"] / (2.0 + 5.0)
    assert row == pytest.approx({"F": -scale, "v1.f'": 7.0 * scale, "v1.f'''": 30.0 * scale})
    run = hb.simulate(m, until=3.0, rtol=1e-9)
    assert max(found.evaluate(run).worst().values()) < 1e-10


def test_derivatives_of_a_source_along_a_run() -> None:
    m = hb.Model("two masses", domain="translational")
    m.add(F=hb.Se("sin(2*time)"), m1=hb.I(2), k=hb.C(3), m2=hb.I(5), v1=hb.One(), v2=hb.One())
    m.add(n=hb.Zero())
    m.bond("F -> v1 -> m1", "v1 -> n -> v2 -> m2", "n -> k")
    found = residuals(m, sensors=["v1.f"])
    row = found[0].at(())
    assert row["F''"] == pytest.approx(15.0 * row["F"])  # k m2 F'' + F
    assert found.evaluate(hb.simulate(m, until=3.0)).worst()["G1"] < 1e-12


def test_equal_filters_may_start_differently() -> None:
    """Dividing by the derivative would claim that the outputs are equal."""
    m = hb.Model("filters")
    m.add(V=hb.Se("1 V"), n=hb.Zero())
    for k in "ab":
        m.add(**{f"i{k}": hb.One(), f"r{k}": hb.R(2), f"c{k}": hb.C(3)})
        m.bond(f"n -> i{k} -> r{k}", f"i{k} -> c{k}")
    m.bond("V -> n")
    # RC branches of the difference: 2*3*d' + d = 0, and nothing shorter
    (only,) = residuals(m, sensors=["ca.e - cb.e"])
    row = {name: c for name, c in only.at(()).items() if c}
    d = "ca.e - cb.e"
    assert row[d + "'"] == pytest.approx(6.0 * row[d]) and len(row) == 2
    # whatever the two started with, and only for these values
    m.elements["ca"] = hb.C(3, e="2 V")
    assert residuals(m, sensors=[d]).evaluate(hb.simulate(m, until=5.0)).worst()["G1"] < 1e-12
    assert only.of.special


def test_an_integrated_sensor() -> None:
    m = hb.Model("free fall", domain="translational", parameters={"m": 2.0, "g": 9.81})
    m.add(w=hb.Se("-m*g"), b=hb.I("m"), v=hb.One())
    m.bond("w -> v -> b")
    m.signal(h=hb.Integral("v.f", start="3 m"))
    found = residuals(m, sensors=["h"])
    assert found[0].text() in ("m*g + m*h''", "m*h'' + m*g")
    assert max(found.evaluate(hb.simulate(m, until=1.0)).worst().values()) < 1e-12
    signatures = found.signatures()
    # weight and inertia fall together
    assert signatures.signature("m") == (False,) and signatures.signature("g") == (True,)
    assert "'" in signatures.table().split("\nh ")[1]


def test_a_nonlinear_law_is_left_out_and_said_so() -> None:
    m = hb.Model("valve")
    m.add(V=hb.Se(2), i=hb.One(), valve=hb.R({"e": "f^3"}), n=hb.Zero(), c=hb.C(1), r=hb.R(1))
    m.bond("V -> i -> valve", "i -> n -> c", "n -> r")
    found = residuals(m, sensors=["i.f", "n.e"])
    assert [r.text() for r in found] == ["i.f - n.e/r.R - c.C*n.e'"]
    assert found.unused == {"valve": "its law is not linear"}
    assert max(found.evaluate(hb.simulate(m, until=1.0)).worst().values()) < 1e-7


def test_data_from_a_plant(found) -> None:
    data = {"Df": 0.01, "De1": 2.3, "De1'": 0.0, "De2": [2.0, 2.1], "De2'": 0.0, "De3": 0.0}
    values = found.evaluate(data, mode=(0, 0))
    assert values["G1"] == pytest.approx([9.0 - 6.7 - 2.3] * 2, abs=1e-12)
    assert values["G3"] == pytest.approx([0.3 / 67.5, 0.2 / 67.5])
    healthy = found.evaluate(data, mode=(0, 0), values={"p:R3.R": 135.0})
    assert healthy["G3"] == pytest.approx(values["G3"] / 2)


def test_many_switches_cost_what_they_are() -> None:
    """Sixty switches, a sensor at each node: one local residual per node, no table over two."""
    m = hb.Model("ladder")
    m.add(V=hb.Se("10 V"), n0=hb.Zero(), c0=hb.C(1), i=hb.One(), r0=hb.R(1))
    m.bond("V -> i -> n0 -> c0", "i -> r0")
    for k in range(1, 61):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R(k), f"n{k}": hb.Zero(), f"c{k}": hb.C(k)})
        m.bond(f"n{k - 1} -> s{k} -> n{k} -> c{k}", f"s{k} -> r{k}")
        m.machine(f"M{k}", states={"off": [], "on": [f"s{k}"]}, start="off")
    found = residuals(m, sensors=[f"n{k}.e" for k in range(61)])
    assert len(found) == 61 and found.complete
    assert max(len(r.sensors) for r in found) == 3
    assert found[30].text().count("κ") == 2


def test_switches_without_sensors_between_ask_for_a_mode() -> None:
    m = hb.Model("row")
    m.add(V=hb.Se("10 V"), n0=hb.Zero(), i=hb.One(), r0=hb.R(1))
    m.bond("V -> i -> n0", "i -> r0")
    for k in range(1, 9):
        m.add(**{f"s{k}": hb.One(), f"n{k}": hb.Zero(), f"c{k}": hb.C(k)})
        m.bond(f"n{k - 1} -> s{k} -> n{k} -> c{k}")
        m.machine(f"M{k}", states={"off": [], "on": [f"s{k}"]}, start="off")
    with pytest.raises(hb.EquationError, match="HB-A304"):
        residuals(m, sensors=["n0.e", "n8.e"])
    found = residuals(m, sensors=["n0.e", "n8.e"], mode={f"M{k}": "on" for k in range(1, 9)})
    mode = found.mode
    assert [r.vacuous(mode) for r in found] == [False, False]
    assert any(r.text() in ("n0.e - n8.e", "n8.e - n0.e") for r in found)
    assert found.signatures().modes == (mode,)


# -- relations


@pytest.mark.parametrize("seed", range(20))
def test_membership_against_construction(seed) -> None:
    """Combinations with random polynomials belong; with one coefficient changed they do not."""
    rng = np.random.default_rng(seed)
    keys = "abcd"

    def poly(degree):
        return {n: int(rng.integers(1, 50)) for n in range(degree + 1)}

    rows = [
        {(k, n): c for k in keys for n, c in poly(int(rng.integers(3))).items()} for _ in range(3)
    ]
    total: dict = {}
    for row in rows:
        for shift, factor in poly(2).items():
            for (k, n), c in row.items():
                total[k, n + shift] = total.get((k, n + shift), 0) + factor * c
    module = Module(rows)
    assert module.contains(total)
    other = dict(total)
    other["a", 0] = other.get(("a", 0), 0) + 1
    assert not module.contains(other)


def test_constants_have_no_derivative() -> None:
    module = Module([{("y", 0): 1, ("1", 0): -3 % (2**61 - 1)}])
    assert module.contains({("y", 1): 1}) and not module.contains({("y", 0): 1})
