"""A source that jumps onto what is stored just where a run ends or begins, and limits from there.

Oracles: what is stored follows the source; a jump of a source from a to b onto a storage of size
C takes C (b - a), costs b C (b - a), and loses half C (b - a)^2, wherever a run is cut.
"""

from __future__ import annotations

import pytest

import hybond as hb

SIZE = 2.0
SHAPES = {
    "floor": ("floor(time/(1 s))", {1.0: (0.0, 1.0), 2.0: (1.0, 2.0)}),
    "mod": ("1 - mod(time, 1 s)/(1 s)", {1.0: (0.0, 1.0), 2.0: (0.0, 1.0)}),
    "if": ("if time >= 1 then 3 else 1", {1.0: (1.0, 3.0)}),
    "sign": ("sign(time/(1 s) - 1)", {1.0: (-1.0, 1.0)}),
    "ceil": ("ceil(time/(1 s))", {1.0: (1.0, 2.0), 2.0: (2.0, 3.0)}),
    "product": ("(2 + time/(1 s))*floor(time/(1 s) + 1.5)", {0.5: (2.5, 5.0), 1.5: (7.0, 10.5)}),
}


def held(text: str, kind: str, turned: bool) -> hb.Model:
    """A capacitor or a mass on a source, and a resistor beside it."""
    mechanical = kind == "Sf"
    m = hb.Model("held", domain="translational" if mechanical else "electrical")
    if mechanical:
        m.add(s=hb.Sf(f"({text})*1 [m/s]"), store=hb.I(f"{SIZE} kg"), node=hb.One())
        m.add(loss=hb.R("3 N*s/m"))
    else:
        m.add(s=hb.Se(f"({text})*1 [V]"), store=hb.C(f"{SIZE} F"), node=hb.Zero())
        m.add(loss=hb.G("3 S"))
    m.bond("s -> node", "store -> node" if turned else "node -> store", "node -> loss")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["Sf", "Se"])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_jump_where_the_run_ends_is_settled_and_belongs_to_it(
    shape: str, kind: str, turned: bool
) -> None:
    text, jumps = SHAPES[shape]
    stored = "store.p" if kind == "Sf" else "store.q"
    sign = -1.0 if turned and kind == "Sf" else 1.0
    for end, (before, after) in jumps.items():
        run = hb.simulate(held(text, kind, turned), end)
        assert run.status == "ok" and run.audit().holds()
        last = run.events[-1]
        assert last.t == pytest.approx(end, abs=1e-11)
        energy = last.steps[-1].energy
        assert energy is not None
        assert energy.lost == pytest.approx(0.5 * SIZE * (after - before) ** 2, rel=1e-8)
        assert sign * float(run[stored].at(run.t_end)) == pytest.approx(SIZE * after, abs=1e-8)
        value = "s.f" if kind == "Sf" else "s.e"
        assert float(run[value].at(last.t, side="left")) == pytest.approx(before, abs=1e-8)


@pytest.mark.parametrize("shape", ["floor", "mod", "sign", "ceil", "product"])
def test_a_run_that_is_cut_at_its_jumps_is_the_whole(shape: str) -> None:
    text, jumps = SHAPES[shape]
    model = held(text, "Se", False)
    whole = hb.simulate(model, "2.2 s")
    begun = {"mod": 1.0, "sign": -1.0, "ceil": 1.0, "product": 2.0}.get(
        shape, 0.0
    )  # onto an empty storage
    lost = 0.5 * SIZE * (begun**2 + sum((b - a) ** 2 for a, b in jumps.values()))
    assert whole.losses().lost == pytest.approx(lost)
    cuts = [*jumps, 2.2]
    run = hb.simulate(model, cuts[0])
    parts = [run.losses()]
    for end in cuts[1:]:
        run = hb.simulate(model, end, start=run)
        parts.append(run.losses())
    for column in ("supplied", "dissipated", "lost", "stored"):
        total = sum(getattr(part, column) for part in parts)
        assert total == pytest.approx(getattr(whole.losses(), column), rel=1e-8, abs=1e-8)
    again = hb.simulate(model, 2.2, start=whole.state(cuts[0]))  # one instant with the event
    assert float(again["store.q"].at(2.2)) == pytest.approx(float(whole["store.q"].at(2.2)))
    assert len(again.events) == len(jumps) - 1


@pytest.mark.parametrize("shape", ["product", "floor"])
@pytest.mark.parametrize("method", ["auto", "rk45", "radau", "qss2"])
def test_a_run_that_ends_at_the_first_jump_onto_an_empty_storage_ends(
    shape: str, method: str
) -> None:
    text, jumps = {
        "product": ("(2 + time/(1 s))*floor(time/(1 s) + 0.5)", 2.5),
        "floor": ("floor(time/(1 s) + 0.5)", 1.0),
    }[shape]
    m = hb.Model("empty", domain="electrical")
    m.add(s=hb.Se(f"({text})*1 [V]"), store=hb.C(f"{SIZE} F"), node=hb.Zero())
    m.bond("s -> node -> store")
    run = hb.simulate(m, "0.5 s", solver=method)
    assert run.audit().holds() and [e.t for e in run.events] == [0.0, 0.5]
    assert float(run["store.q"].at(0.5)) == pytest.approx(SIZE * jumps, rel=1e-12)


def test_a_closed_switch_loses_nothing_of_what_a_source_jumps_onto() -> None:
    m = hb.Model("switched", domain="electrical")
    m.add(V=hb.Se("floor(time/(1 s) + 0.5)*1 [V]"), s=hb.One(), n=hb.Zero(), C=hb.C("2 F"))
    m.bond("V -> s -> n -> C")
    m.machine(
        "S", states={"on": ["s"], "off": []}, start="on", rules=["on -> off when time >= 2 s"]
    )
    run = hb.simulate(m, "2.2 s")
    found = run.losses()
    assert not found.notes
    assert found["V"].lost == pytest.approx(2.0) and found["V"].supplied == pytest.approx(6.0)
    assert all(row.name != "s" or row.lost == pytest.approx(0.0, abs=1e-12) for row in found)
    for signal in ("V.e", "C.e"):
        (first,) = run[signal].crossings(0.5)
        assert first.jump and first.t == pytest.approx(0.5, abs=1e-11)


def test_a_run_that_ends_where_it_begins_has_values_there() -> None:
    m = hb.Model("still", domain="translational")
    m.add(k=hb.C("1 m/N", q="1 m"), m=hb.I("1 kg"), v=hb.One())
    m.bond("k -> v -> m")
    run = hb.simulate(m, ["k.q >= 1", "8 s"])
    assert run.t_end == 0.0
    assert float(run["k.e"].at(0.0)) == 1.0 and run.sample([0.0], ["m.p"])["m.p"].tolist() == [0.0]
    with pytest.raises(hb.UsageError, match="HB-R102") as refused:
        run["k.q"].mean()
    assert "ended where it began" in str(refused.value)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize(("end", "after"), [(0.5, 2.5), (0.6, 2.6)])
def test_what_was_zero_all_the_time_before_the_jump_has_no_size(
    solver: str, end: float, after: float
) -> None:
    m = hb.Model("empty", domain="electrical")
    m.add(
        V=hb.Se("(2 + time/(1 s))*floor(time/(1 s) + 0.5)*1 [V]"), C=hb.C(f"{SIZE} F"), n=hb.Zero()
    )
    m.bond("V -> n -> C")
    run = hb.simulate(m, end, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert [e.t for e in run.events] == [0.0, pytest.approx(0.5, abs=1e-11)]
    assert float(run["C.q"].at(end)) == pytest.approx(SIZE * after, rel=1e-9)
    assert run.events[-1].steps[-1].impulses["V.f"] == pytest.approx(2.5 * SIZE, rel=1e-9)
