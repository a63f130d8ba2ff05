"""Diodes whose resistance is next to nothing block when their current ends, by their own rounding.

What a source would drive through a nano-ohm in a moment, were nothing charged by it, is no energy
that rounding is measured by; nor is what all energy of a circuit would make of a picofarad that a
resistor keeps at the voltage of the others. Amperes were taken for rounding, and a diode carried
hundreds of them backwards. Closed forms.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

OMEGA = 100.0 * math.pi
PEAK = 10.0
STORED = {
    "alone": ("C", "n -> C", "C = { C = 1e-3 }"),
    "turned": ("C", "n -> C", "C = { C = 1e-3 }"),
    "drawn away from its bond": ("C", "C -> n", "C = { C = 1e-3 }"),
    "behind a transformer": ("C", "n -> T -> C", "T = { TF = 10 }\nC = { C = 0.1 }"),
    "behind a gyrator": ("I", "n -> G -> I", "G = { GY = 100 }\nI = { I = 10 }"),
}


def rectifier(resistance: float, stored: str, amplitude: float) -> str:
    """A sine, a diode and 1 mF beside 100 ohm."""
    _, bond, lines = STORED[stored]
    resistor = "R -> d" if stored == "turned" else "d -> R"
    return f"""
hybond = 1
[elements]
V = {{ Se = "{amplitude!r}*sin({OMEGA!r}*time/(1 [s]))" }}
d = {{ junction = 1, law = "diode" }}
R = {{ R = {resistance!r} }}
n = {{ junction = 0 }}
{lines}
L = {{ R = 100.0 }}
[graph]
bonds = ["V -> d -> n", "{resistor}", "{bond}", "n -> L"]
"""


@pytest.mark.parametrize("amplitude", [PEAK, 1e-6])
@pytest.mark.parametrize("stored", STORED)
@pytest.mark.parametrize("resistance", [1e-6, 1e-9])
def test_a_rectifier_blocks_once_a_period(resistance: float, stored: str, amplitude: float) -> None:
    run = hb.simulate(hb.loads(rectifier(resistance, stored, amplitude)), until=0.05)
    ends = (math.pi - math.atan(OMEGA * 0.1)) / OMEGA
    blocked = [e.t for e in run.events if e.steps[-1].fired[-1].target == "blocks"]
    # rounding of what two voltages differ by, times ten, drives that much
    rounding = 2e-12 * amplitude / resistance
    late = 2.0 * rounding / (1e-3 * amplitude * OMEGA**2)
    assert len(blocked) == 3
    assert blocked == pytest.approx([ends + k * 0.02 for k in range(3)], abs=1e-7 + late, rel=0)
    assert run.audit().holds()


def beside_a_small_one(
    resistance: float, small: float, before: float, amplitude: float, turned: bool
) -> str:
    """A half-wave rectifier of 1 mF and 1 ohm, a small capacitor where its diode is fed."""
    small_one = "P -> a" if turned else "a -> P"
    return f"""
hybond = 1
[elements]
V = {{ Se = "{325.0 * amplitude!r}*sin({OMEGA!r}*time/(1 [s]))" }}
s = {{ junction = 1 }}
B = {{ R = {before!r} }}
a = {{ junction = 0 }}
P = {{ C = {small!r} }}
d = {{ junction = 1, law = "diode" }}
R = {{ R = {resistance!r} }}
n = {{ junction = 0 }}
C = {{ C = 1e-3 }}
L = {{ R = 1.0 }}
[graph]
bonds = ["V -> s -> a -> d -> n", "s -> B", "{small_one}", "d -> R", "n -> C", "n -> L"]
"""


@pytest.mark.parametrize(
    ("small", "before", "amplitude"),
    [(1e-12, 0.1, 1.0), (1e-9, 0.0047, 1.0), (1e-9, 0.0047, 1e-7), (1e-4, 0.1, 1e6)],
)
@pytest.mark.parametrize("resistance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("turned", [False, True])
def test_a_diode_fed_beside_a_small_capacitor_carries_nothing_back(
    resistance: float, small: float, before: float, amplitude: float, turned: bool
) -> None:
    model = hb.loads(beside_a_small_one(resistance, small, before, amplitude, turned))
    run = hb.simulate(model, until=0.04)
    flows = run.sample([0.0005 + 0.00097 * k for k in range(40)], "d.f")["d.f"]
    assert run.status == "ok"
    assert min(flows) > -1e-3 * amplitude
    assert max(flows) > 100.0 * amplitude
    assert len(run.events) == 4


def reversals(until: float) -> list[float]:
    """When 1 kg that 2*sin(3*t) pushes over dry friction of 0.5 begins to move, and turns round."""
    begins = math.asin(0.25) / 3.0
    found = [begins]
    way = 1.0
    while True:

        def speed(t: float, since: float = found[-1], way: float = way) -> float:
            pushed = 2.0 / 3.0 * (math.cos(3.0 * since) - math.cos(3.0 * t))
            return way * pushed - 0.5 * (t - since)

        low = found[-1] + 0.05
        while speed(low) > 0.0:
            low += 0.05
        high, low = low, low - 0.05
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if speed(middle) > 0.0 else (low, middle)
        if low > until:
            return found
        assert abs(2.0 * math.sin(3.0 * low)) > 0.5  # it goes on at once
        found.append(low)
        way = -way


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("light", [1e-12, 1e-6])
@pytest.mark.parametrize("damper", [1e6, 1e9])
def test_a_light_block_behind_a_stiff_damper_turns_round_with_what_pulls_it(
    damper: float, light: float, turned: bool
) -> None:
    model = hb.Model("x", domain="translational")
    model.add(F=hb.Se("2*sin(3*time)"), a=hb.One(), M=hb.I(1.0), z=hb.Zero(), o=hb.One())
    model.add(b=hb.R(damper), l=hb.One(law="coulomb", limit=0.5), m=hb.I(light))
    model.bond("F -> a", "a -> M", "a -> z -> l", "z -> o", "l -> m")
    model.bond("b -> o" if turned else "o -> b")
    run = hb.simulate(model, until=10.0)
    times: list[float] = []
    for event in run.events[1:]:
        if not times or event.t > times[-1] + 1e-3:
            times.append(event.t)
    assert times == pytest.approx(reversals(10.0), abs=2e-6)


@pytest.mark.parametrize(
    "order", [(0, 1, 2, 3, 4, 5, 6), (0, 3, 4, 5, 6, 1, 2), (6, 3, 5, 0, 2, 1, 4)]
)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(
    ("joined", "first", "second", "current", "resistance"),
    [
        (1e-9, 1e-6, 1e-6, 1e-6, 1e-3),
        (1e-6, 1e-3, 1e-9, 1.0, 1e-9),
        (1e-6, 1e-6, 1e-12, 1.0, 1e-9),
        (1e-3, 1e-3, 1e-9, 1.0, 1e-9),
    ],
)
def test_capacitors_that_next_to_nothing_joins_let_a_diode_go_together(
    joined: float,
    first: float,
    second: float,
    current: float,
    resistance: float,
    solver: str,
    order: tuple[int, ...],
) -> None:
    whole = first + second
    third = whole / current  # when a current has charged both to 1 V
    m = hb.Model("n", domain="electrical")
    m.add(a=hb.Zero(), b=hb.Zero(), c1=hb.C(first), c2=hb.C(second), k=hb.One(), r=hb.R(joined))
    m.add(d=hb.One(law="diode"), rd=hb.R(resistance), E=hb.Se(1.0))
    m.add(s=hb.Sf(f"if time < {2.0 * third!r} [s] then {current} [A] else {-current} [A]"))
    store = ("c1 -> a", "b -> c2") if solver == "radau" else ("a -> c1", "c2 -> b")
    bonds = ["s -> a", *store, "b -> d -> E", "d -> rd", "a -> k -> b", "k -> r"]
    m.bond(*[bonds[i] for i in order])
    run = hb.simulate(m, until=3.0 * third, solver=solver)
    times = [e.t / third for e in run.events[1:]]
    assert times == pytest.approx([1.0, 2.0], abs=2e-3)
    assert float(run["d.f"].at(1.5 * third)) == pytest.approx(current, rel=1e-4)
    assert abs(float(run["d.f"].at(2.7 * third))) < 1e-6 * current
    assert abs(float(run["c2.e"].at(3.0 * third))) < 2e-3


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_diode_fed_beside_a_small_field_carries_nothing_back(solver: str, turned: bool) -> None:
    m = hb.Model("f", domain="electrical")
    m.add(V=hb.Se("10*sin(314*time)"), s=hb.One(), B=hb.R(1e-4), a=hb.Zero())
    m.add(P=hb.C([[1e-12, 2e-13], [2e-13, 1e-12]]), x=hb.Zero(), Rx=hb.R(1e-3))
    m.add(d=hb.One(law="diode"), Rd=hb.R(1e-4), n=hb.Zero(), C=hb.C(1e-3), L=hb.R(100.0))
    ports = ("P.1 -> a", "P.2 -> x") if turned else ("a -> P.1", "x -> P.2")
    m.bond("V -> s -> a", "s -> B", *ports, "x -> Rx", "a -> d -> n", "d -> Rd", "n -> C", "n -> L")
    run = hb.simulate(m, until=0.06, solver=solver)
    late = 314.0 * 0.1  # of 100 ohm and 1 mF
    ends = (math.pi - math.atan(late)) / 314.0
    blocked = [e.t for e in run.events if e.steps[-1].fired[-1].target == "blocks"]
    assert blocked == pytest.approx([ends + k * math.tau / 314.0 for k in range(3)], abs=2e-6)
    at = ends + 2.0 * math.tau / 314.0 + 5e-3
    decayed = 10.0 * math.sin(314.0 * ends) * math.exp(-5e-3 / 0.1)
    assert float(run["C.e"].at(at)) == pytest.approx(decayed, rel=1e-4)


def warned(model: hb.Model) -> list[str]:
    run = hb.simulate(model, until=0.025)
    return [w for w in run.warnings if "HB-N414" in w]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("amplitude", [1e-3, 440.0])
def test_a_diode_that_carries_hardly_more_than_rounding_is_warned_of(
    amplitude: float, turned: bool
) -> None:
    # 1e-8 ohm, which carry a thousandth of an ampere for each volt
    fed = hb.Model("fed", domain="electrical")
    fed.add(V=hb.Se(f"{amplitude!r}*sin({OMEGA!r}*time)"), s=hb.One(), B=hb.R(60.0), a=hb.Zero())
    fed.add(P=hb.C(4e-10), d=hb.One(law="diode"), R=hb.R(1e-8), n=hb.Zero(), C=hb.C(2e-6))
    fed.add(L=hb.R(2e3))
    fed.bond("V -> s -> a", "s -> B", "a -> P", "n -> C", "n -> L")
    fed.bond("R -> d" if turned else "d -> R", "n -> d -> a" if turned else "a -> d -> n")
    (text,) = warned(fed)
    assert "'d.f < 0' of d is known to" in text
    # what it names is what flows back, and no more than that is known
    known = float(text.split("known to ")[1].split()[0])
    run = hb.simulate(fed, until=0.025)
    flows = run.sample([0.0001 * k for k in range(1, 250)], "d.f")["d.f"]
    assert 1e-3 * max(flows) < -min(flows) < 2.0 * known < max(flows)


@pytest.mark.parametrize("resistance", [1e-3, 1e-5])
@pytest.mark.parametrize("stored", STORED)
def test_what_is_resolved_is_not_warned_of(resistance: float, stored: str) -> None:
    assert not warned(hb.loads(rectifier(resistance, stored, PEAK)))


@pytest.mark.parametrize("before", [1e-5, 1e-7])
def test_a_run_that_goes_on_knows_what_a_diode_has_carried(before: float) -> None:
    model = hb.loads(rectifier(1e-7, "alone", PEAK))
    whole = hb.simulate(model, until=0.02)
    at = whole.events[-1].t
    run = hb.simulate(model, until=0.02, start=hb.simulate(model, until=at - before))
    assert [e.t for e in run.events] == pytest.approx([at], abs=1e-9)
    # what is left of the amperes that it had is hardly more than rounding
    assert not whole.warnings
    assert not run.warnings


def beside_many(many: int, turned: bool) -> str:
    """Diodes from one sine to one load, each fed through a milliohm beside a picofarad."""
    parts = [f'V = {{ Se = "10*sin({OMEGA!r}*time/(1 [s]))" }}', "s = { junction = 0 }"]
    parts += ["n = { junction = 0 }", "L = { R = 10.0 }"]
    bonds = ["V -> s", "n -> L"]
    for k in range(many):
        parts.append(f"b{k} = {{ junction = 1 }}\nB{k} = {{ R = 1e-3 }}")
        parts.append(f"a{k} = {{ junction = 0 }}\nP{k} = {{ C = 1e-12 }}")
        parts.append(f'd{k} = {{ junction = 1, law = "diode" }}\nR{k} = {{ R = 1e-3 }}')
        small = f"P{k} -> a{k}" if turned else f"a{k} -> P{k}"
        bonds += [f"s -> b{k} -> a{k} -> d{k} -> n", f"b{k} -> B{k}", small, f"d{k} -> R{k}"]
    listed = ", ".join(f'"{b}"' for b in bonds)
    return "hybond = 1\n[elements]\n" + "\n".join(parts) + f"\n[graph]\nbonds = [{listed}]\n"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.slow
def test_eighty_that_settle_together_block_once_a_period(turned: bool) -> None:
    run = hb.simulate(hb.loads(beside_many(80, turned)), until=0.04)
    flows = run.sample([0.0105 + 0.0003 * k for k in range(30)], ["d7.f", "n.e"])
    late = [e.t for e in run.events if any(f.target == "blocks" for s in e.steps for f in s.fired)]
    assert late == pytest.approx([0.01, 0.03], abs=1e-9)
    assert min(flows["d7.f"]) == max(flows["d7.f"]) == 0.0
    assert max(abs(flows["n.e"])) == 0.0
    assert not run.warnings


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("gain", [1e2, 1e3])
def test_a_diode_behind_an_amplifier_that_is_led_its_voltage_back_blocks(
    gain: float, turned: bool
) -> None:
    # an ideal rectifier of 1 V that falls by 100 V/s; at first it would push amperes into the
    # capacitor, which has its voltage within picoseconds
    fall, inner, load, held = 100.0, 0.026, 1e4, 1e-8
    fed = hb.Model("fed", domain="electrical")
    fed.signals["u"] = f"1 V - {fall!r} [V/s]*time"
    fed.add(E=hb.Se(f"{gain!r}*(u - n.e)"), d=hb.One(law="diode"), R=hb.R(inner))
    fed.add(n=hb.Zero(), C=hb.C(held), L=hb.R(load))
    fed.bond("C -> n" if turned else "n -> C", "L -> n" if turned else "n -> L")
    fed.bond("R -> d" if turned else "d -> R", "E -> d -> n")
    run = hb.simulate(fed, until=0.02)
    # C n' = (gain*(u - n) - n)/R - n/L is followed by a straight line within picoseconds
    total = (gain + 1) / inner + 1 / load
    slope = -fall * gain / inner / total
    begins = (gain / inner - held * slope) / total
    # where it carries nothing, n = -L*C*n'
    blocks = (-load * held * slope - begins) / slope
    assert [e.t for e in run.events][1:] == pytest.approx([blocks], rel=1e-3)
    left = float(run["n.e"].at(blocks + load * held))
    assert left == pytest.approx(-load * held * slope * math.exp(-1.0), rel=1e-2)
    assert abs(float(run["n.e"].at(0.02))) < 1e-9


def test_what_flows_back_behind_a_huge_gain_is_warned_of() -> None:
    fed = hb.Model("fed", domain="electrical")
    fed.signals["u"] = "1 V*sin(2*pi*100 Hz*time)"
    fed.add(E=hb.Se("1e5*(u - n.e)"), d=hb.One(law="diode"), R=hb.R(1e-3))
    fed.add(n=hb.Zero(), C=hb.C(1e-8), L=hb.R(1e4))
    fed.bond("n -> C", "n -> L", "d -> R", "E -> d -> n")
    (text,) = (w for w in hb.simulate(fed, until=0.02).warnings if "HB-N414" in w)
    assert "'d.f < 0' of d is known to" in text


def peak_detector(gain: float, inner: float, turned: bool, behind: bool) -> hb.Model:
    """An amplifier that nothing limits holds the peaks of a sine on a capacitor, by a diode.

    While the diode blocks, the amplifier goes to a million volts, and so does the capacitor that
    stands before the diode, by which all rounding is measured from then on. A diode that is turned
    round holds the lowest values.
    """
    fed = hb.Model("peaks", domain="electrical")
    fed.signals["u"] = "1 V*sin(2*pi*1000 Hz*time)"
    fed.add(E=hb.Se(f"{gain!r}*(u - n.e)"), s=hb.One(), B=hb.R(10.0), a=hb.Zero(), P=hb.C(1e-8))
    fed.add(d=hb.One(law="diode"), R=hb.R(inner), n=hb.Zero(), L=hb.R(1e4))
    fed.bond("E -> s -> a", "s -> B", "a -> P", "n -> L")
    fed.bond("R -> d" if turned else "d -> R", "n -> d -> a" if turned else "a -> d -> n")
    if behind:
        fed.add(T=hb.TF(10.0), C=hb.C(1e-4))
        fed.bond("n -> T -> C")
    else:
        fed.add(C=hb.C(1e-6))
        fed.bond("C -> n" if turned else "n -> C")
    return fed


@pytest.mark.parametrize("behind", [False, True])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("gain", "inner"), [(1e6, 2.6e-5), (3e6, 1e-4)])
def test_a_diode_that_carries_backward_for_good_beside_a_surge_is_warned_of(
    gain: float, inner: float, turned: bool, behind: bool
) -> None:
    run = hb.simulate(peak_detector(gain, inner, turned, behind), until=0.0017)
    (text,) = (w for w in run.warnings if "HB-N414" in w)
    assert "'d.f < 0' of d is known to" in text
    # the load alone would leave 93 % of a peak there; here the diode lets it follow the sine
    begins = 0.8e-3 if turned else 1.3e-3
    at = begins + 0.3e-3
    assert float(run["n.e"].at(at)) == pytest.approx(math.sin(2e3 * math.pi * at), abs=1e-3)
    known = float(text.split("known to ")[1].split()[0])
    flows = run.sample([begins + 1e-5 * k for k in range(40)], "d.f")["d.f"]
    assert -0.01 < min(flows) < -0.005
    assert -min(flows) < 2.0 * known


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("gain", [1e2, 1e3])
def test_a_diode_that_holds_peaks_behind_a_small_gain_is_not_warned_of(
    gain: float, turned: bool
) -> None:
    run = hb.simulate(peak_detector(gain, 1e-2, turned, False), until=0.0017)
    held = -float(run["n.e"].at(0.0011)) if turned else float(run["n.e"].at(0.0016))
    assert held > 0.9
    assert not [w for w in run.warnings if "HB-N414" in w]
