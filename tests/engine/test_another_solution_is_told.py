"""Where laws have several solutions, and nothing says which, a run says so, and names another."""

from __future__ import annotations

import re

import numpy as np
import pytest

import hybond as hb

NUMBERS = re.compile(
    r"at t = (\S+) s .*: -?\S+\.[ef] is (\S+)(?: \S+)?, and (\S+)(?: \S+)? would do as well"
)


def cubic(drive: str, *, away: bool = False, dual: bool = False) -> hb.Model:
    """Return ``x^3 - 2*x = drive`` for ``x = G.e``, or ``G.f``, with a storage apart."""
    m = hb.Model("cubic", domain="electrical")
    if dual:
        m.add(V=hb.Sf(f"({drive})*1 [A]"), z=hb.One(), ic=hb.Zero(), i0=hb.Zero(), C=hb.I("1 H"))
        m.add(G=hb.R({"e": "((f/(1 [A]))^3 - 3*f/(1 [A]))*1 [V]"}))
    else:
        m.add(V=hb.Se(f"({drive})*1 [V]"), z=hb.Zero(), ic=hb.One(), i0=hb.One(), C=hb.C("1 F"))
        m.add(G=hb.G({"f": "((e/(1 [V]))^3 - 3*e/(1 [V]))*1 [A]"}))
    m.add(Rc=hb.R("1 ohm"), R0=hb.R("1 ohm"))
    m.bond("V -> z -> ic -> Rc", "ic -> C", "z -> i0 -> R0", "G -> i0" if away else "i0 -> G")
    return m


def told(run: hb.Result) -> list[tuple[float, float, float]]:
    """Return when it is told that there is another solution, the one taken, and the other."""
    texts = [str(w) for w in run.warnings if "HB-N416" in str(w)]
    return [tuple(float(x) for x in NUMBERS.search(text).groups()) for text in texts]


def holds(drive: float, here: float, there: float, *, away: bool = False) -> None:
    """Assert that both are solutions of the cubic, and different ones."""
    way = -1.0 if away else 1.0
    for x in (way * here, way * there):
        roots = np.roots([1.0, 0.0, -2.0, -drive])
        assert np.abs(roots - x).min() == pytest.approx(0.0, abs=1e-5)
    assert abs(here - there) > 0.1


@pytest.mark.parametrize("drive", [0.0, 0.5, -0.9])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("away", [False, True])
def test_which_solution_a_run_begins_with_is_told(drive: float, dual: bool, away: bool) -> None:
    run = hb.simulate(cubic(f"{drive}", away=away, dual=dual), 0.1)
    ((t, here, there),) = told(run)
    assert t == 0.0 and run.status == "ok"
    holds(drive, here, there, away=away)


@pytest.mark.parametrize("drive", ["3*cos(time/(1 [s]))", "1.1", "-5"])
def test_nothing_is_told_of_one_solution_nor_of_one_that_is_followed_on(drive: str) -> None:
    """Folds are at 1.0887: of a drive of 3 V that falls to 0.2 V the solution goes on."""
    m = cubic(drive)
    first = hb.simulate(m, 1.5)
    assert told(first) == [] and first.status == "ok"
    assert told(hb.simulate(m, 1.6, start=first.state())) == []


@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("beside", ["nothing", "diode", "switch"])
def test_which_solution_is_taken_behind_a_jump_is_told(beside: str, away: bool) -> None:
    m = cubic("if time < 1 [s] then 3 else 0.5", away=away)
    if beside == "diode":
        m.add(U=hb.Se("1 [V]*sin(40*time/(1 [s]))"), d=hb.One(law="diode"), Rd=hb.R("1 ohm"))
        m.add(k=hb.Zero(), K=hb.C("0.1 F"), load=hb.R("3 ohm"))
        m.bond("U -> d -> k -> K", "d -> Rd", "k -> load")
    if beside == "switch":
        m.add(U=hb.Se("1 V"), k=hb.One(), Rk=hb.R("1 ohm"))
        m.bond("U -> k -> Rk")
        m.machine("S", states={"a": [], "b": ["k"]}, start="a", rules=["a -> b when time > 0.5 s"])
    run = hb.simulate(m, 1.3)
    ((t, here, there),) = told(run)
    assert t == pytest.approx(1.0, abs=1e-6)
    holds(0.5, here, there, away=away)


@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("solver", ["moreau-jean", "qss2", "qss3"])
def test_solvers_that_follow_none_say_so(solver: str, away: bool) -> None:
    """At 1.246 s the drive comes below the fold; at 1.942 s the solution ends, without a word."""
    m = cubic("3*cos(time/(1 [s]))", away=away)
    step = {"step": 0.01} if solver == "moreau-jean" else {}
    run = hb.simulate(m, 2.0, solver=solver, **step)
    ((t, here, there),) = told(run)
    assert 1.2 < t < 1.95 and "follows none" in str(run.warnings)
    if solver == "moreau-jean":
        holds(3.0 * np.cos(t), here, there, away=away)
    assert told(hb.simulate(m, 1.1, solver=solver, **step)) == []


@pytest.mark.parametrize("away", [False, True])
def test_along_surfaces_none_is_followed(away: bool) -> None:
    m = cubic("3*cos(time/(1 [s]))", away=away)
    m.add(q=hb.I("1 H"), a=hb.One(), U=hb.Se("if s.state == 'up' then 1 [V] else -1 [V]"))
    m.bond("U -> a -> q")
    rules = ["up -> down when q.f > 0.1 A", "down -> up when q.f < 0.1 A"]
    m.machine("s", states={"up": [], "down": []}, start="up", rules=rules)
    run = hb.simulate(m, 1.6)
    ((t, here, there),) = told(run)
    assert 1.2 < t < 1.6 and "along surfaces" in str(run.warnings)
    holds(3.0 * np.cos(t), here, there, away=away)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("fed_back", [True, False])
def test_of_a_comparator_by_its_sign_none_is_followed(fed_back: bool, turned: bool) -> None:
    """``n = (v + 5 sign(n))/2`` has two solutions if v is below 5, one if not fed back."""
    m = hb.Model("loop", domain="electrical")
    m.add(V=hb.Se("0.5 [V]*cos(time/(1 [s]))"), z=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"))
    m.add(C=hb.C("1 F"), a=hb.One(), Ra=hb.R("1 ohm"), n=hb.Zero(), b=hb.One(), Rb=hb.R("1 ohm"))
    read = "n.e" if fed_back else "z.e"
    m.add(A=hb.Se(f"5 [V]*sign({read})"))
    m.bond("V -> z -> a -> Ra", "a -> n", "z -> ic -> Rc", "ic -> C")
    m.bond("n -> b -> A" if turned else "A -> b -> n", "b -> Rb")
    run = hb.simulate(m, 1.0)
    assert len(told(run)) == (1 if fed_back else 0)
    if fed_back:
        # the current of the comparator is half of what it gives less v
        ((t, here, there),) = told(run)
        found = sorted(abs(x) for x in (here, there))
        assert t == 0.0 and found == pytest.approx([2.25, 2.75], rel=1e-5)


@pytest.mark.parametrize("law", ["5*tanh(-10*u)", "max(min(-50*u, 5), -5)"])
def test_of_a_latch_of_two_inverters_both_states_are_solutions(law: str) -> None:
    m = hb.Model("latch", domain="electrical")
    m.add(C=hb.C("1 F"), Rc=hb.R("1 ohm"), n=hb.Zero(), Rp=hb.R("1 ohm"), Rq=hb.R("1 ohm"))
    m.add(p=hb.Zero(), q=hb.Zero())
    for own, other in (("P", "q"), ("Q", "p")):
        m.add(**{own: hb.Se(f"({law.replace('u', f'({other}.e/(1 [V]))')})*1 [V]")})
    m.bond("n -> C", "n -> Rc", "P -> p -> Rp", "Q -> q -> Rq")
    ((_, here, there),) = told(hb.simulate(m, 0.1))
    assert here == pytest.approx(0.0, abs=1e-9) and abs(there) == pytest.approx(5.0, rel=1e-5)


COMES_BACK = """Comes back to zero
V1 s 0 -0.0005355471971006938
Rs s n5 1k
Rc n5 c 2k
C1 c 0 1u IC=0
R0 n1 0 571.1883191172863
R1 n2 0 17.462275489672646
R2 n3 n1 17525.108823459468
R3 n4 0 1193.1785329864902
R4 n5 0 296.70845521645157
R5 n2 n4 102.94038953755522
R6 n2 n3 939.610411124326
R7 n4 0 100.46133447752842
R8 n2 n3 1304.910752701021
B0 n2 n3 I = 0.01*tanh(0.0007394584551668794*V(n2,n4))
B1 n1 0 V = 12*tanh(1.8147064611159684*V(n3,n2))
.tran 1u 1m 0 uic
.end
"""
"""Of one volt about its loop at most 0.66 V come back, so that zero is its only solution."""


def test_what_comes_back_to_zero_but_for_its_rounding_is_not_told(tmp_path) -> None:
    """It ended at -3e-321, which is as far from zero as zero is from anything."""
    path = tmp_path / "back.cir"
    path.write_text(COMES_BACK)
    assert told(hb.simulate(hb.read_circuit(path).model, 1e-5)) == []


@pytest.mark.parametrize("solver", ["moreau-jean", "qss2"])
def test_a_run_that_went_on_told_it_again(solver: str) -> None:
    """What has been told of a run is told: it is the same run that goes on."""
    m = cubic("3*cos(time/(1 [s]))")
    options = {"solver": solver} | ({"step": 0.01} if solver == "moreau-jean" else {})
    run = hb.simulate(m, 0.3, **options)
    said = told(run)
    for k in range(2, 9):
        run = hb.simulate(m, 0.3 * k, start=run.state(), **options)
        said += told(run)
    assert len(said) == len(told(hb.simulate(m, 2.4, **options))) == 1


@pytest.mark.parametrize("law", [{"f": "P/e"}, {"e": "P/f"}])
@pytest.mark.parametrize("part", [0.02, 0.3, 0.8])
@pytest.mark.parametrize("turned", [False, True])
def test_constant_power_behind_a_resistor_is_taken_in_two_ways(
    law: dict[str, str], part: float, turned: bool
) -> None:
    """Of ``e^2 - V e + P R = 0`` one root is near V, the other near nothing."""
    volts, ohms = 48.0, 0.5
    power = part * volts * volts / 4.0 / ohms
    m = hb.Model("load", domain="electrical")
    m.add(V=hb.Se(volts), z=hb.Zero(), c=hb.One(), C=hb.C(1.0), Rc=hb.R(1.0))
    m.add(i=hb.One(), R=hb.R(ohms), n=hb.Zero())
    m.add(P=hb.R({k: text.replace("P", f"{power} [W]") for k, text in law.items()}))
    m.bond("V -> z -> c -> C", "c -> Rc", "z -> i -> n", "i -> R", "P -> n" if turned else "n -> P")
    ((_, here, there),) = told(hb.simulate(m, 0.1))
    volt = "P.e is" in hb.simulate(m, 0.1).warnings[0]
    for x in (here, there):
        e = abs(x) if volt else power / abs(x)
        assert e * e - volts * e + power * ohms == pytest.approx(0.0, abs=1e-3 * volts * e)
    assert abs(here - there) > 0.1
