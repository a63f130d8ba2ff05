"""What has come to a limit, waits there, and is asked again: it is at the limit, not past it."""

import itertools
import math
from collections.abc import Iterator

import pytest

import hybond as hb

HEAT, C, G, SWING, HALF = 27375.2, 2000.0, 12.0, 15.0, 2500.0
RULES = {
    "as it is told": (
        "solid -> melting when store.e > Tm",
        "melting -> liquid when melted > heat",
        "melting -> solid when melted < 0",
        "liquid -> melting when store.e < Tm",
    ),
    "compared the other way": (
        "solid -> melting when Tm < store.e",
        "melting -> liquid when heat < melted",
        "melting -> solid when 0 > melted",
        "liquid -> melting when Tm > store.e",
    ),
    "with a state for each way": (
        "solid -> melting when store.e > Tm",
        "melting -> liquid when melted > heat",
        "melting -> solid when melted < 0",
        "liquid -> freezing when store.e < Tm",
        "freezing -> liquid when melted > heat",
        "freezing -> solid when melted < 0",
    ),
}


def ice(rules: tuple[str, ...], towards: bool) -> hb.Model:
    """A block that melts and freezes between two ambients, which change every half period."""
    m = hb.Model("ice", domain="thermal_pseudo", parameters={"Tm": 273.15, "heat": HEAT})
    m.input(day=hb.Input(pwm={"period": 2 * HALF, "duty": 0.5, "high": SWING, "low": -SWING}))
    m.add(ambient=hb.Se("Tm + day"), wall=hb.G(G), air=hb.One(), body=hb.Zero())
    m.add(store=hb.C(C, e=263.15), ice=hb.Se("Tm"), change=hb.One())
    m.bond("ambient -> air -> body -> store", "air -> wall")
    m.bond("ice -> change -> body" if towards else "body -> change -> ice")
    taken = "-change.f" if towards else "change.f"
    changes = 'M.state == "melting"'
    states: dict[str, list[str]] = {"solid": [], "melting": ["change"], "liquid": []}
    if len(rules) > 4:
        states["freezing"] = ["change"]
        changes += ' or M.state == "freezing"'
    m.signal(melted=hb.Integral(f"if {changes} then {taken} else 0"))
    m.machine("M", states=states, start="solid", rules=list(rules))
    return m


def turns() -> Iterator[float]:
    """Yield when it begins or ceases to melt: exponentials between ramps of enthalpy."""
    tau, above, t = C / G, -10.0, 0.0
    for day in itertools.cycle((SWING, -SWING)):
        # on this side of the melting point, then through it; each ambient lasts long enough
        there = t + tau * math.log((day - above) / day)
        yield there
        gone = there + HEAT / (G * SWING)
        yield gone
        t += HALF
        above = day * (1 - math.exp(-(t - gone) / tau))


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau", "qss"])
@pytest.mark.parametrize("written", RULES)
def test_what_has_melted_freezes_again(written: str, solver: str) -> None:
    run = hb.simulate(ice(RULES[written], solver != "radau"), until=20 * HALF, solver=solver)
    expected = list(itertools.islice(turns(), 40))
    found = [event.t for event in run.events if event.cause == "guard"]
    assert found == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("late", [0.0, 1e6])
def test_a_battery_that_was_full_is_used_and_charged_again(late: float) -> None:
    """Far from t = 0 a limit is found by last places of the time, not of what is compared."""
    full, w = 3.7, 2 * math.pi / 10
    m = hb.Model("battery", parameters={"full": full, "w": w, "late": late})
    m.signal(current="if time < late then 0 else 3*sin(w*(time - late))")
    m.signal(q=hb.Integral('if B.state == "used" then current else 0', start=full / 2))
    m.machine(
        "B",
        states={"used": [], "full": [], "empty": []},
        start="used",
        rules=[
            "used -> full when q > full",
            "full -> used when current < 0",
            "used -> empty when q < 0",
            "empty -> used when current > 0",
        ],
    )
    expected, q = [], full / 2
    for k in range(6):
        to_go = q if k % 2 else full - q
        lasts = math.acos(1 - to_go * w / 3) / w
        expected += [late + 5 * k + lasts, late + 5 * k + 5]
        q = 0.0 if k % 2 else full
    run = hb.simulate(m, until=late + 31)
    found = [event.t for event in run.events[1:] if event.t > late + 0.01]
    assert found[:12] == pytest.approx(expected, abs=1e-6)


def test_a_run_that_goes_on_knows_what_waits() -> None:
    m = ice(RULES["as it is told"], towards=True)
    first = hb.simulate(m, until=1.1 * HALF)
    whole = hb.simulate(m, until=4 * HALF)
    rest = hb.simulate(m, until=4 * HALF, start=first)
    assert [e.t for e in rest.events] == [e.t for e in whole.events if e.t > 1.1 * HALF]
