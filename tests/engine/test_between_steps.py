"""What follows its source far faster than a step is right between steps as well.

At the end of each step it was right before too, and steps were as long as if it were nothing:
driven by `cos(10 t)` and read between them, it was half an amplitude off.
"""

import numpy as np
import pytest

import hybond as hb

W = 10.0


def charged(tau, turned):
    """Return a capacitor behind a resistor, and its closed form for a current cos(W t)."""
    m = hb.Model("charged", domain="electrical")
    m.add(S=hb.Sf(f"{'-' if turned else ''}cos({W}*time)"), n=hb.Zero(), R=hb.R(1.0))
    m.add(C=hb.C(tau, e=1.0 / (1.0 + (W * tau) ** 2)))
    m.bond("n -> S" if turned else "S -> n", "n -> C", "n -> R")
    return m, "C.e", 1.0


def dragged(tau, turned):
    """Return a light mass in a damper, pushed by cos(W t), and the same closed form."""
    m = hb.Model("dragged", domain="translational")
    m.add(F=hb.Se(f"{'-' if turned else ''}3*cos({W}*time)"), v=hb.One(), R=hb.R(2.0))
    m.add(M=hb.I(2.0 * tau, f=1.5 / (1.0 + (W * tau) ** 2)))
    m.bond("v -> F" if turned else "F -> v", "v -> M", "v -> R")
    return m, "M.f", 1.5


def turned_by_a_motor(tau, turned):
    """Return a light rotor behind a gyrator: e = K w, i = (u - K w)/R, J w' = K i."""
    m = hb.Model("motor")
    m.add(u=hb.Se(f"{'-' if turned else ''}cos({W}*time)"), i=hb.One(), R=hb.R(0.5))
    m.add(K=hb.GY(0.2), w=hb.One(), J=hb.I(tau * 0.04 / 0.5, f=5.0 / (1.0 + (W * tau) ** 2)))
    m.bond("i -> u" if turned else "u -> i", "i -> R", "i -> K -> w -> J")
    return m, "J.f", 5.0


@pytest.mark.parametrize("turned", [False, True], ids=["", "source turned round"])
@pytest.mark.parametrize("tau", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("made", [charged, dragged, turned_by_a_motor])
def test_what_is_driven_and_fast_is_right_between_steps(made, tau, turned):
    m, name, gain = made(tau, turned)
    for rtol in (1e-6, 1e-8):
        run = hb.simulate(m, 2.0, solver="radau", rtol=rtol)
        t = np.linspace(0.0, 2.0, 1733)
        right = gain * (np.cos(W * t) + W * tau * np.sin(W * t)) / (1.0 + (W * tau) ** 2)
        assert np.abs(run[name].at(t) - right).max() < 2.0 * rtol * gain
        # no more of them than a motion needs that is as fast as the source, but for a torque that
        # is a difference of what is 1e8 times as large: it has to be right as well
        more = 3.0 if made is turned_by_a_motor and tau == 1e-9 else 1.0
        assert run.stats["steps"] < more * 600 * (1e-8 / rtol) ** 0.25


def test_a_pump_chamber_between_two_valves_adds_up():
    """The chamber settles in 1e-6 s; what the piston does to it is a matter of a second."""
    m = hb.Model("pump", domain="hydraulic")
    m.add(piston=hb.Sf("5e-4*cos(10*time)"), chamber=hb.Zero(), oil=hb.C(1e-13), tank=hb.Se(0.0))
    m.add(inlet=hb.One(law="diode"), r_in=hb.R(1e7), outlet=hb.One(law="diode"), r_out=hb.R(1e8))
    gas = "1e6*(1e-3/(1e-3 - q))^1.4 - 1e6"
    m.add(line=hb.Zero(), load=hb.G({"f": "1e-8*sqrt(e)"}), gas=hb.C({"e": gas}, q=1e-4))
    m.bond("piston -> chamber -> oil", "tank -> inlet -> chamber -> outlet -> line")
    m.bond("inlet -> r_in", "outlet -> r_out", "line -> gas", "line -> load")
    run = hb.simulate(m, 2.0)
    assert run.audit().holds()
    # where the inlet conducts the chamber is at what its flow needs, but for the oil's own
    t = np.linspace(0.2, 0.4, 41)
    drawn = 5e-4 * np.cos(10.0 * t)
    own = 1e7 * 1e-13 * 5e-3 * 1e7  # what the oil takes up of it
    assert np.abs(run["chamber.e"].at(t) - 1e7 * drawn).max() < 1.5 * own
    # the start, the outlet at once, and for each turn of the piston four more
    assert len(run.events) == 2 + 4 * 3
