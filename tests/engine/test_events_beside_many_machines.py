"""An instant beside many machines that take no part in it: neurons that fire one at a time.

A neuron is a capacitor that a current charges through a leak. At 1 V it fires: its node is off for
no time, and the charge is lost. What it holds then is a closed form. The current is a source at a
junction that the machine controls, so that each of the others is in a state that could be struck.
"""

import cProfile
import math

import pytest

import hybond as hb

UNTIL = 2.0


def neurons(currents: list[float], turned: bool) -> hb.Model:
    """Return one neuron for each current."""
    m = hb.Model("neurons", domain="electrical")
    for k, current in enumerate(currents):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C("1 F"), f"r{k}": hb.R("1 ohm")})
        m.add(**{f"J{k}": hb.Sf(-current if turned else current)})
        m.bond(f"z{k} -> J{k}" if turned else f"J{k} -> z{k}", f"z{k} -> c{k}", f"z{k} -> r{k}")
        m.machine(
            f"N{k}",
            states={"rests": [f"z{k}"], "fires": []},
            start="rests",
            rules=[
                f"rests -> fires when pre(c{k}.e) >= 1",
                f"fires -> rests when pre(c{k}.e) < 0.5",
            ],
        )
    return m


def held(current: float) -> float:
    """Return the voltage of one at the end."""
    period = math.log(current / (current - 1.0))
    return -current * math.expm1(-math.fmod(UNTIL, period))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("many", [1, 30])
def test_neurons_that_fire_one_at_a_time(many: int, solver: str, turned: bool) -> None:
    currents = [3.2 - 0.0517 * k for k in range(many)]
    run = hb.simulate(neurons(currents, turned), UNTIL, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    fired = sum(math.floor(UNTIL / math.log(i / (i - 1.0))) for i in currents)
    assert len(run.events) == 1 + fired
    for k, current in enumerate(currents):
        assert run.final[f"c{k}.e"] == pytest.approx(held(current), abs=1e-7)


def test_who_does_not_fire_is_not_looked_at_as_struck() -> None:
    with cProfile.Profile() as profile:
        run = hb.simulate(neurons([1.7, 1.6, *(12 * [1.001])], False), UNTIL, engine="python")
    speeds = sum(
        entry.callcount
        for entry in profile.getstats()
        if not isinstance(entry.code, str) and entry.code.co_name == "contact_speed"
    )
    assert len(run.events) == 1 + 2 + 2
    assert speeds <= 2 * 4  # of the one that fires, before and behind it
