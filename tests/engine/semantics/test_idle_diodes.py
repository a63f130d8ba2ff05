"""Diodes that neither carry nor block: what location leaves of zero decides nothing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

DECKS = {
    "three phases": (3, 0.00247, 0.0007, 35.82),
    "three phases, small choke": (3, 0.0008, 0.0007, 20.0),
    "three phases, light load": (3, 0.004, 0.0003, 300.0),
    "one phase": (1, 0.003, 0.001, 30.0),
}


def rectifier(phases: int, coil: float, capacitor: float, load: float) -> str:
    """A bridge behind chokes charges a capacitor; sources meet in a star that is not earthed."""
    lines = ["bridge"]
    for k in range(phases if phases > 1 else 2):
        shift = -120.0 * k if phases > 1 else -180.0 * k
        amplitude = 378.6 if phases > 1 else 189.3
        lines += [
            f"V{k} s{k} 0 SIN(0 {amplitude} 50 0 0 {shift})",
            f"L{k} s{k} a{k} {coil} IC=0",
            f"Dp{k} a{k} p DI",
            f"Dn{k} m a{k} DI",
        ]
    lines += [f"C1 p m {capacitor} IC=0", f"RL p m {load}"]
    lines += [".model DI D(IS=1e-12 N=0.1 RS=2m)", ".tran 0.1m 0.1 0 10u uic", ".print tran v(p,m)"]
    return "\n".join([*lines, ".end", ""])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk45"])
@pytest.mark.parametrize("deck", list(DECKS))
def test_a_bridge_whose_diodes_close_at_zero_current_runs_to_its_end(
    deck: str, solver: str, tmp_path: Path
) -> None:
    """No diode conducts backwards, none blocks what would flow, and the energy adds up."""
    phases, coil, capacitor, load = DECKS[deck]
    path = tmp_path / "bridge.cir"
    path.write_text(rectifier(phases, coil, capacitor, load), encoding="utf-8")
    model = hb.read_circuit(path).model
    run = hb.simulate(model, until=0.1, solver=solver)
    assert run.status == "ok"
    t = np.linspace(0.0, 0.1, 2001)[1:-1]
    diodes = [name for name in run.graph.by_path if name[:2] in ("Dp", "Dn") and "_" not in name]
    assert len(diodes) == 2 * max(phases, 2)
    most = max(np.abs(run[f"{d}.f"].at(t)).max() for d in diodes)
    for d in diodes:
        assert run[f"{d}.f"].at(t).min() > -1e-9 * most
        assert run[f"{d}.e"].at(t).max() < 1e-6 * 378.6
    assert run.audit().holds()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_idle_diodes_in_a_loop_stay_as_they_were(order: tuple[int, ...]) -> None:
    """A source turns against the current of a coil: it ends at 0.2/1.515, and nothing follows."""
    m = hb.Model("idle")
    parts = [{"j0": hb.One(law="diode")}, {"j3": hb.One(law="diode")}, {"j4": hb.Zero(law="diode")}]
    for k in order:
        m.add(**parts[k])
    m.add(s7=hb.Se(-1.515), i8=hb.I(1.0, p=0.2))
    m.bond("j3 -> i8", "s7 -> j3", "j0 -> j3", "j4 -> j0")
    for until in (0.5, 1.0, 7.3):
        run = hb.simulate(m, until=until)
        assert [e.t for e in run.events] == pytest.approx([0.0, 0.2 / 1.515])


@pytest.mark.parametrize("many", [2, 3, 5])
def test_diodes_in_series_all_block_where_their_current_ends(many: int) -> None:
    """At any tolerance, by any solver."""
    m = hb.Model("series")
    m.add(L=hb.I(1e-3), u=hb.Se("10*sin(100*time/(1 [s]))"), r=hb.R(0.5), w=hb.One())
    m.add(**{f"d{k}": hb.One(law="diode") for k in range(many)})
    m.bond("u -> d0", *(f"d{k} -> d{k + 1}" for k in range(many - 1)), f"d{many - 1} -> w")
    m.bond("w -> L", "w -> r")
    found = set()
    for solver in ("rk45", "exact"):
        for rtol in (1e-6, 1e-9, 1e-11):
            run = hb.simulate(m, until=0.2, solver=solver, rtol=rtol)
            found.add(tuple(len(e.steps[-1].fired) for e in run.events))
            names = [{f.target for f in e.steps[-1].fired} for e in run.events]
            assert {frozenset(n) for n in names} == {frozenset({"conducts"}), frozenset({"blocks"})}
    assert len(found) == 1
    assert set(found.pop()) == {many}


@pytest.mark.parametrize("phase", [0.0, 0.3, 1.1])
def test_a_peak_detector_lets_go_at_the_peak(phase: float) -> None:
    """The current of its capacitor passes zero at the peak of the sine, to the last place."""
    m = hb.Model("peak")
    m.add(u=hb.Se(f"325*sin(314*time/(1 [s]) + {phase})"), d=hb.One(law="diode"))
    m.add(c=hb.C(1e-4), n=hb.Zero(), load=hb.One(), d2=hb.One(law="diode"), c2=hb.C(1e-5))
    m.bond("u -> d -> n", "n -> c", "n -> d2 -> c2")
    for rtol in (1e-6, 1e-8, 1e-11):
        run = hb.simulate(m, until=0.03, rtol=rtol)
        peak = (0.5 * math.pi - phase) / 314.0
        let_go = [e.t for e in run.events if e.t > 0.0]
        assert let_go[0] == pytest.approx(peak, abs=1e-9)
        assert len(let_go) == 1
        assert run["c.e"].at(0.03) == pytest.approx(325.0)


@pytest.mark.parametrize("law", ["diode", "coulomb", "unilateral"])
@pytest.mark.parametrize("kind", [hb.Zero, hb.One])
def test_a_law_at_a_junction_without_bonds_does_nothing(kind: object, law: str) -> None:
    """Beside it a capacitor runs empty by ``q' = -q^(1/3)``: its charge is ``(1 - 2t/3)^1.5``.

    Where laws are curved, what a port does is found by differences, also where it has no bonds.
    """
    m = hb.Model("alone")
    limit = {"limit": 1.0} if law == "coulomb" else {}
    m.add(lone=kind(law=law, **limit), c=hb.C(1.0, q=1.0), r=hb.R({"e": "f^3"}), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    assert hb.simulate(m, 1.0)["c.q"].at(1.0) == pytest.approx(3.0**-1.5, rel=1e-7)
