"""Models whose motion is stiff, and not linear."""

import hybond as hb


def signals(**rates):
    """Return a model of integrated signals, each with its rate and its start."""
    m = hb.Model("motion")
    m.signal(**{name: hb.Integral(rate, start=start) for name, (rate, start) in rates.items()})
    return m


def van_der_pol():
    return signals(x=("y", "2"), y=("1000*(1 - x^2)*y - x", "0"))


def ladder(cells=8):
    """Return a ladder of resistors that are not linear, fast at its beginning, with a switch."""
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se("1 V"), drive=hb.One(), r0=hb.R("1 ohm"), n0=hb.Zero(), c0=hb.C("1 uF"))
    m.add(leak=hb.One(), load=hb.R("100 ohm"))
    m.bond("V -> drive -> n0 -> c0", "drive -> r0", "n0 -> leak -> load")
    for k in range(1, cells):
        m.add(**{f"i{k}": hb.One(), f"r{k}": hb.R({"f": "1e-3*e + 1e-4*e^3"})})
        m.add(**{f"n{k}": hb.Zero(), f"c{k}": hb.C("10 uF")})
        m.bond(f"n{k - 1} -> i{k} -> n{k} -> c{k}", f"i{k} -> r{k}")
    m.input(gate=hb.Input(pwm={"period": 0.2, "duty": 0.5}))
    m.machine(
        "S",
        states={"on": ["drive"], "off": ["leak"]},
        start="on",
        rules=["on -> off when gate < 0.5", "off -> on when gate > 0.5"],
    )
    return m
