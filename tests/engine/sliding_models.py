"""Small models that slide, one of each kind."""

from __future__ import annotations

import hybond as hb


def signum(machine: str) -> str:
    """Return +1 in the state ``above``, -1 below."""
    return f'(if {machine}.state == "above" then 1 else -1)'


def system(rates: list[str], start: list[float]) -> hb.Model:
    """Return ``x_k' = rates[k]``: a C fed by a modulated source per state."""
    m = hb.Model("system")
    for k, (rate, x0) in enumerate(zip(rates, start, strict=True), 1):
        m.add(**{f"x{k}": hb.C(1.0, q=x0), f"s{k}": hb.Sf(rate), f"n{k}": hb.Zero()})
        m.bond(f"s{k} -> n{k} -> x{k}")
    return m


def add_relay(
    m: hb.Model, name: str, g: str, start: str = "below", up: str = "", down: str = ""
) -> None:
    m.machine(
        name,
        states={"above": [], "below": []},
        start=start,
        rules=[f"above -> below when {g} < 0{down}", f"below -> above when {g} > 0{up}"],
    )


def allowed() -> hb.Model:
    """Up only while x2 < 2: slides from 2/3 to 2 s, then rises."""
    m = system([f"-{signum('r')} + 0.5", "1"], [-1.0, 0.0])
    add_relay(m, "r", "x1.q", up=" and x2.q < 2")
    return m


def charger() -> hb.Model:
    """A voltage relay charges a capacitor through a diode: up to 1 V, at ln(4)/1.5 s."""
    m = hb.Model("charger")
    m.add(
        c=hb.C(1.0),
        u=hb.Se('if r.state == "above" then -2 else 2'),
        R=hb.R(1.0),
        load=hb.R(2.0),
        n=hb.Zero(),
        d=hb.One(law="diode"),
    )
    m.bond("u -> d -> n -> c", "d -> R", "n -> load")
    add_relay(m, "r", "c.e - 1")
    return m


def drained() -> hb.Model:
    """Held at 1 V while a diode beside the relay, the same on both sides, opens and closes."""
    m = hb.Model("drained")
    m.add(
        c=hb.C(1.0),
        u=hb.Sf(f"-{signum('r')}"),
        R=hb.R(1.0),
        sink=hb.Se("1 + 0.5*cos(2*time/(1 s))"),
        n=hb.Zero(),
        d=hb.One(law="diode"),
    )
    m.bond("u -> n -> c", "n -> d -> R", "d -> sink")
    add_relay(m, "r", "c.e - 1")
    return m


def coupled() -> hb.Model:
    """x1' = -s1 + 0.5 + 0.4 s1 s2, x2' = -s2 + 0.2: the switches act on each other."""
    one, two = signum("r1"), signum("r2")
    m = system([f"-{one} + 0.5 + 0.4*{one}*{two}", f"-{two} + 0.2"], [-0.1, -1.0])
    add_relay(m, "r1", "x1.q")
    add_relay(m, "r2", "x2.q")
    return m


def swapped() -> hb.Model:
    """A level decides which of two capacitors a third is joined to: no jump moves the level."""
    m = hb.Model("swapped")
    m.add(
        c=hb.C(1.0, q=1.0),
        c1=hb.C(0.5, q=0.0),
        c2=hb.C(2.0, q=5.0),
        level=hb.C(1.0, q=-1.0),
        source=hb.Sf('if k.state == "high" then -1 else 2'),
        n=hb.Zero(),
        n1=hb.Zero(),
        n2=hb.Zero(),
        nz=hb.Zero(),
        l1=hb.One(),
        l2=hb.One(),
    )
    m.bond("n -> c", "n -> l1 -> n1 -> c1", "n -> l2 -> n2 -> c2", "source -> nz -> level")
    m.machine(
        "k",
        states={"low": ["l1"], "high": ["l2"]},
        start="low",
        rules=["low -> high when level.q > 0", "high -> low when level.q < 0"],
    )
    return m


def measured() -> hb.Model:
    """The switch reads the flow of a resistor, (c.e - 1)/2: 0.25 is reached at 2 ln(8/6.5) s."""
    m = hb.Model("measured")
    m.add(
        c=hb.C(1.0, e=3.0),
        r=hb.R(2.0),
        bias=hb.Se(1.0),
        pump=hb.Sf('if k.state == "above" then -3 else 1'),
        n=hb.Zero(),
        i=hb.One(),
    )
    m.bond("pump -> n -> c", "n -> i -> r", "i -> bias")
    add_relay(m, "k", "r.f - 0.25", "above")
    return m


def relays(n: int, drift: list[float]) -> hb.Model:
    """Return n relays on surfaces of their own, all met at 1 s."""
    start = [-(1.0 + d) for d in drift]
    m = system([f"-{signum(f'r{k}')} + {d}" for k, d in enumerate(drift, 1)], start)
    for k in range(1, n + 1):
        add_relay(m, f"r{k}", f"x{k}.q")
    return m


KINDS = {
    "allowed": (allowed, 3.0),
    "charger": (charger, 4.0),
    "drained": (drained, 6.0),
    "coupled": (coupled, 3.0),
    "swapped": (swapped, 2.0),
    "measured": (measured, 3.0),
}
