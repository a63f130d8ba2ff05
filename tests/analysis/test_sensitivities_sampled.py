"""Derivatives through sampled controllers, against the algebra of what is done step by step."""

import numpy as np
import pytest

import hybond as hb

TINY = 1e-30


def loop() -> hb.Model:
    """A discrete PI controller of the voltage of a capacitor behind a resistor."""
    values = {"kp": 0.5, "ki": 20.0, "T": "1 ms", "R": "1 kohm", "C": "2 uF", "ref": "2 V"}
    m = hb.Model("pi", domain="electrical", parameters=values)
    m.add(V=hb.Se("u"), r=hb.R("R"), c=hb.C("C"), n=hb.One())
    m.bond("V -> n -> c", "n -> r")
    m.signal(acc=hb.Sampled("acc + ki*T/(1 s)*(ref - c.e)", every="T", start="0.1 V"))
    # z^-1: what acc was one instant ago
    m.signal(u=hb.Sampled("kp*(ref - c.e) + acc", every="T"))
    return m


def stepped(p: dict[str, complex], until: float, steps: int) -> list[complex]:
    """Return charge, integral and output at a time behind so many samples."""
    e, acc, u = 0j, p["acc.start"], 0j
    for k in range(steps):
        acc, u = acc + p["ki"] * p["T"] * (p["ref"] - e), p["kp"] * (p["ref"] - e) + acc
        h = p["T"] if k < steps - 1 else until - (steps - 1) * p["T"]
        e = u + (e - u) * np.exp(-h / (p["R"] * p["C"]))
    return [e * p["C"], acc, u]


def test_a_discrete_controller_by_its_gains_and_its_period() -> None:
    wrt = ["kp", "ki", "T", "R", "C", "ref", "acc.start"]
    m = loop()
    s = hb.sensitivities(m, "20.5 ms", wrt=wrt, rtol=1e-12)
    assert s.of == ("c.q", "acc", "u") and s.ends is None
    back = {name: hb.gradient(m, hb.Final(name), "20.5 ms", wrt=wrt, rtol=1e-12) for name in s.of}
    for k, name in enumerate(wrt):
        p = dict(zip(wrt, s.values.astype(complex).tolist(), strict=True))
        p[name] += 1j * TINY * abs(p[name])
        exact = np.imag(stepped(p, 20.5e-3, 21)) / (TINY * abs(s.values[k]))
        assert s.derivatives[-1, :, k] == pytest.approx(exact, rel=1e-8)
        assert [back[of][name] for of in s.of] == pytest.approx(exact, rel=1e-8)


def test_a_thermostat_that_looks_now_and_then() -> None:
    m = hb.Model("thermostat", parameters={"on": 2.0, "loss": 0.5})
    m.add(heat=hb.Sf('if s.state == "hot" then 0 else on'), c=hb.C(1.0), r=hb.R("1/loss"))
    m.add(n=hb.Zero())
    m.bond("heat -> n -> c", "n -> r")
    m.signal(seen=hb.Sampled("c.e", every="0.5 s"))
    m.machine("s", states={"cold": [], "hot": []}, start="cold",
              rules=["cold -> hot when seen > 1.2", "hot -> cold when seen < 1"])  # fmt: skip
    s = hb.sensitivities(m, "3.2 s", wrt=["on", "loss"], of=["c.e"], rtol=1e-11)
    hot = [e for e in s.run.events if e.cause == "sample"]
    assert hot and s.ends is None
    # the instants of switching are those of the clock, and do not move
    assert all(e.by == pytest.approx([0, 0], abs=1e-15) for e in s.events)

    def end(on: complex, loss: complex) -> complex:
        e, heats = 0j, True
        for k in range(7):
            heats = e.real <= 1.2 if heats else e.real < 1.0
            rest = on / loss if heats else 0.0
            e = rest + (e - rest) * np.exp(-loss * (0.5 if k < 6 else 0.2))
        return e

    exact = [end(2.0 + 1j * TINY, 0.5).imag / TINY, end(2.0, 0.5 + 1j * TINY).imag / TINY]
    assert s["c.e"][-1] == pytest.approx(exact, rel=1e-8)
