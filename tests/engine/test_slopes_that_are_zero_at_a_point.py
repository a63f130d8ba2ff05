"""Sources that are powers of what is across them: structure counts their slopes, also at zero.

A coil that empties through ``i = k*v*abs(v)^n`` has ``i^m = i0^m - m*t/(L*k^(1/(n+1)))`` with
``m = n/(n+1)``; a capacitor that empties through ``v = k*i*abs(i)^n`` likewise. While the slope of
such a law was taken for none, before anything is solved, the first point that was read lacked what
is across the source, and what was stored jumped to zero at the start.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import hybond as hb
from hybond.equations.isolated import isolated
from hybond.model.expressions import parse

K, STORED, START = 2e-3, 0.1, 0.5


def left(t: float, n: float) -> float:
    """Return what the storage has at a time."""
    m = n / (n + 1)
    return float((START**m - m * t / (STORED * K ** (1 / (n + 1)))) ** (1 / m))


def law(read: str, unit: str, n: float) -> str:
    """Return the law of the source."""
    return f"{K}*({read}/1[{unit}])*abs({read}/1[{unit}])^{n}"


def emptying(storage: str, n: float, arrow: str, read: str) -> hb.Model:
    """Return a storage that empties through a source that reads what is across it."""
    coil = storage == "I"
    sign = "" if arrow == "n -> B" else "-"
    m = hb.Model("a storage behind a power", domain="electrical")
    given = sign + law(f"{read}.{'e' if coil else 'f'}", "V" if coil else "A", n)
    if coil:
        m.add(S=hb.I(STORED, f=-START), B=hb.Sf(f"1[A]*({given})"), n=hb.Zero())
    else:
        m.add(S=hb.C(STORED, e=-START), B=hb.Se(f"1[V]*({given})"), n=hb.One())
    m.bond("n -> S", arrow)
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(("read", "n"), [("B", 2), ("B", 3.5), ("B", 9), ("B", 30), ("S", 3)])
@pytest.mark.parametrize("arrow", ["n -> B", "B -> n"])
@pytest.mark.parametrize("storage", ["I", "C"])
def test_first_reads_of_powers_behind_storages(
    storage: str, arrow: str, read: str, n: float, solver: str
) -> None:
    run = hb.simulate(emptying(storage, n, arrow, read), until=0.004, solver=solver)
    had, across = ("S.f", "B.e") if storage == "I" else ("S.e", "B.f")
    for t in (0.0, 0.002, 0.004):
        assert float(run[had].at(t)) == pytest.approx(-left(t, n), rel=1e-5)
        assert abs(float(run[across].at(t))) == pytest.approx(
            (left(t, n) / K) ** (1 / (n + 1)), rel=1e-5
        )
    assert run.audit().holds()


def test_slopes_of_which_forms_say_where_they_are_zero() -> None:
    """Powers have none along a ray; what has a limit, a corner or a flat side may."""
    points = ["3*v^2", "5*abs(v/40)^4 + v*sign(v)", "2*v*w - 1", "sinh(v)*cosh(v)", "sqrt(abs(v))"]
    rays = ["1 + sign(v)", "2*abs(v) + 2*v", "exp(v)", "1 - tanh(v)^2", "v/cosh(v)", "v - v"]
    more = ["if v > 1 then v else 0", "floor(v)", "(v + w)^2 - v^2 - 2*v*w - w^2"]
    assert [isolated(parse(e)) for e in points] == [True] * len(points)
    assert [isolated(parse(e)) for e in rays + more] == [False] * len(rays + more)


def test_flat_side_of_a_source_is_still_one() -> None:
    """Where a source lets nothing pass, structure says so: what is stored there does not move."""
    m = hb.Model("a coil behind a flat side", domain="electrical")
    m.add(S=hb.I(0.1), B=hb.Sf("1[A]*max(0, B.e/1[V] - 1)^2"), V=hb.Se("0.5 V"), n=hb.Zero())
    m.add(s=hb.One())
    m.bond("V -> s -> n -> B", "s -> S")
    run = hb.simulate(m, until=0.1)
    assert float(run["S.f"].at(0.1)) == 0.0
    assert run.audit().holds()


def test_power_beside_what_a_source_ties(tmp_path: Path) -> None:
    """What holds a capacitor at the square of another is a constraint, the power is none."""
    deck = tmp_path / "tied.cir"
    deck.write_text(
        "* tied\nI1 0 c SIN(0 1 50)\nC1 c 0 1m\nR1 c 0 5\nE1 d 0 VALUE={v(c)*v(c)}\nC2 d 0 2m\n"
        f"V1 q 0 0\nL1 q a {STORED} IC={START}\nB1 a 0 I={K}*v(a)*abs(v(a))^5\n.tran 10u 4m UIC\n"
    )
    run = hb.simulate(hb.read_circuit(deck).model, until=0.004)
    assert float(run["L1.f"].at(0.004)) == pytest.approx(left(0.004, 5), rel=1e-6)
    assert float(run["C2.e"].at(0.004)) == pytest.approx(float(run["C1.e"].at(0.004)) ** 2)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", ["resistor", "source", "source against the arrow"])
@pytest.mark.slow
def test_powers_of_sizes_are_no_corners_for_steps(kind: str) -> None:
    """A varistor with ``abs(v)^4`` is driven through zero, as one with ``v^4`` is (HB-N410).

    The coil has next to nothing across it: the current is what the law gives of all of the voltage.
    """
    m = hb.Model("a varistor behind a coil", domain="electrical")
    m.add(V=hb.Se("5*cos(2*pi*50*time)"), L=hb.I(0.01, f=0.001), R=hb.R(10.0), s=hb.One())
    law = "1e-3[A]*B.e/1[V]*abs(B.e/40[V])^4"
    m.add(B=hb.R({"f": law.replace("B.e", "e")}) if kind == "resistor" else hb.Sf(law))
    m.bond("V -> s -> L", "s -> R", "s -> B")
    if kind == "source against the arrow":
        m = hb.loads(hb.dumps(m).replace("s -> B", "B -> s").replace("1e-3[A]", "-1e-3[A]"))
    run = hb.simulate(m, until=0.01)
    assert run.audit().holds()
    for t, volts in ((0.01, -5.0), (0.0085, -5.0 * math.cos(0.15 * math.pi))):
        assert float(run["L.f"].at(t)) == pytest.approx(1e-3 * volts * (volts / 40) ** 4, rel=1e-3)
