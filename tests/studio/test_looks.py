"""What the studio shows of runs and models: sweeps, phase plane, power, equations, schematics."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from studio.asking import asked, edit, eventually, finished

import hybond as hb
from hybond.errors import UnitError, UsageError
from hybond.studio.formulas import equations, formula
from hybond.studio.session import Session
from hybond.studio.sweeps import MOST, values_between


def swept(session: Session, **asks: Any) -> list[dict[str, Any]]:
    told: list[dict[str, Any]] = []
    stop = session.listen(told.append)
    asked(session, "sweep", **asks)
    eventually(lambda: [m for m in told if m["tell"] == "swept"])
    stop()
    json.dumps(told)
    return [m for m in told if m["tell"] == "member"]


@pytest.mark.slow
def test_the_falling_rod_sticks_beyond_the_boundary_of_the_paper() -> None:
    """It slides where J/(m l^2) < sin(theta)*cos(theta)/mu - sin(theta)^2, and sticks beyond."""
    session = Session(None)
    asked(session, "open", example="falling_rod")
    members = swept(session, path="mu", **{"from": 0.2, "to": 0.3, "count": 21}, names=["w.f"])
    theta, ratio = 0.85, 1.3
    boundary = math.sin(theta) * math.cos(theta) / (ratio + math.sin(theta) ** 2)
    assert 0.2 < boundary < 0.3
    for m in members:
        named = {m["named"][k] for k in m["modes"]}
        assert ("stuck" in named) == (float(m["value"]) > boundary), m["value"]
        assert m["status"] == "ok" and m["curves"][0]["y"]


def test_members_of_a_sweep_are_runs() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    edit(session, do="set", path=["parameters", "r"], value="10 ohm")
    edit(session, do="set", path=["elements", "R", "R"], value="r")
    range_ = {"from": "5 ohm", "to": "20 ohm", "count": 3, "log": True}
    members = swept(session, path="r", **range_, names=["L.f", "none"])
    assert [m["value"] for m in members] == ["5 ohm", "10 ohm", "20 ohm"]
    for m, r in zip(members, (5.0, 10.0, 20.0)):
        good, bad = m["curves"]
        assert bad["error"]["code"] == "HB-S109"
        # 10 V over r and 0.1 H
        assert max(good["y"]) == pytest.approx(10 / r * (1 - math.exp(-0.05 * r / 0.1)), rel=1e-7)


def test_a_sweep_over_what_refuses_tells_it_and_goes_on() -> None:
    session = Session(None)
    asked(session, "open", example="bouncing_ball")
    members = swept(session, path="m", **{"from": "0 kg", "to": "1 kg", "count": 2})
    assert members[0]["error"]["code"].startswith("HB-")
    assert members[1]["status"] == "ok"


@pytest.mark.parametrize(
    ("low", "high", "count", "log"),
    [
        ("1 V", "2 A", 3, False),
        (0, 1, 3, True),
        (-1, 1, 3, True),
        (0, 1, 1, False),
        (0, 1, MOST + 1, False),
        (0, 1, "many", False),
        (0, 1, 2.5, False),
    ],
)
def test_what_is_no_range_is_refused(low: Any, high: Any, count: Any, log: bool) -> None:
    with pytest.raises(UsageError) as refused:
        values_between(low, high, count, log=log)
    assert refused.value.code == "HB-W103"


def test_units_stay_as_they_are_written() -> None:
    assert values_between("1eV", "2 eV", 2) == ["1 eV", "2 eV"]
    assert values_between("1e-3 kN*m", "3 N*m", 3) == ["0.001 kN*m", "0.002 kN*m", "0.003 kN*m"]


@pytest.mark.slow
def test_a_sweep_is_cancelled() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    asked(session, "sweep", path="V", **{"from": "10 V", "to": "12 V", "count": 50}, until=1e3)
    eventually(lambda: [m for m in told if m["tell"] == "sweeping"])
    asked(session, "cancel")
    ended = eventually(lambda: [m for m in told if m["tell"] == "swept"])
    assert ended[0]["cancelled"]
    assert not [m for m in told if m["tell"] == "member"]


def test_a_defect_in_a_sweep_is_told_and_the_sweep_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    import hybond.studio.sweeps as sweeps

    def broken(*_: Any, **__: Any) -> None:
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(sweeps, "simulate", broken)
    session = Session(None)
    asked(session, "open", example="bouncing_ball")
    members = swept(session, path="m", **{"from": "1 kg", "to": "2 kg", "count": 2})
    assert [m["error"]["code"] for m in members] == ["HB-X001", "HB-X001"]


@pytest.mark.parametrize("end", ["x", None, "3 furlong"])
def test_an_end_that_is_no_quantity_is_refused_as_that(end: Any) -> None:
    with pytest.raises(UnitError):
        values_between(0, end, 3)


def test_power_balances_at_the_cursor_and_signals_are_read_there() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    run = finished(session)["run"]
    seen = asked(session, "cursor", run=run, t=1.48e-3, names=["out.e", "none"])
    assert seen["signals"] == {"out.e": session.runs.result(run)["out.e"].at(1.48e-3)}
    view = asked(session, "look")["view"]
    outer = {n["name"] for n in view["nodes"] if n["kind"] == "part"}
    into = dict.fromkeys(outer, 0.0)
    for b in view["bonds"]:
        value = seen["values"][b["key"]]
        assert value["power"]
        for end, sign in ((b["tail"], -1), (b["head"], 1)):
            if end in into:
                into[end] += sign * value["e"] * value["f"]
    assert sum(into.values()) == pytest.approx(0.0, abs=1e-9)
    assert max(into, key=lambda n: into[n]) == "heavy"


def test_a_part_is_off_while_all_that_is_switched_in_it_is() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    run = finished(session)["run"]
    met: set[tuple[str, ...]] = set()
    for t in (2e-6, 12e-6, 19e-6, 1.48e-3, 1.505e-3):
        seen = asked(session, "cursor", run=run, t=t)
        states, nodes = seen["mode"], seen["strokes"]["nodes"]
        off = {n for n in ("switch", "diode", "second", "coil") if nodes.get(n, {}).get("off")}
        expected = {n for n in ("switch", "second") if states[f"{n}.contact"] == "open"}
        assert off == expected | ({"diode"} if states["diode.i"] == "blocks" else set()), t
        met.add(tuple(sorted(off)))
    assert {("diode", "second", "switch"), ("second", "switch"), ("diode",)} <= met


def test_energies_up_to_the_cursor_are_those_that_were_lifted_and_turned() -> None:
    session = Session(None)
    asked(session, "open", example="falling_rod")
    run = finished(session)["run"]
    result = session.runs.result(run)
    before = asked(session, "energies", run=run, t=0.3)
    # it falls freely: what the weight gives is kinetic, m v^2/2 with v = g t
    kinetic = 0.5 * (9.81 * 0.3) ** 2
    assert [(s["name"], s["energy"]) for s in before["gives"]] == [
        ("weight", pytest.approx(kinetic, rel=1e-7))
    ]
    assert before["takes"][0]["energy"] == pytest.approx(kinetic, rel=1e-7)
    # beyond the impact all that the weight has given is somewhere, and the rotor has J w^2/2
    after = asked(session, "energies", run=run, t=0.6)
    given, taken = (sum(s["energy"] for s in after[side]) for side in ("gives", "takes"))
    assert given == pytest.approx(taken, rel=1e-6)
    rotor = next(s["energy"] for s in after["takes"] if s["name"] == "rotor")
    assert rotor == pytest.approx(0.5 * 1.3 * result["w.f"].at(0.6) ** 2, rel=1e-7)
    assert asked(session, "energies", run=run, t=0.0)["gives"] == []


def test_the_phase_plane_of_an_oscillator_is_a_circle() -> None:
    session = Session(None)
    m = hb.Model("lc", domain="electrical")
    m.add(c=hb.C("1 F", e="2 V"), l=hb.I("1 H"), loop=hb.One())
    m.bond("c -> loop", "loop -> l")
    asked(session, "replace", text=_text(m))
    run = finished(session, until=20.0)["run"]
    seen = asked(session, "phase", run=run, names=["l.f", "c.e"], t0=0.0, t1=20.0)
    (xs, ys), *more = seen["pieces"]
    assert not more and seen["units"] == ["A", "V"]
    assert all(math.hypot(x, y) == pytest.approx(2.0, rel=1e-6) for x, y in zip(xs, ys))
    refused = session.handle(
        {"id": 1, "ask": "phase", "run": run, "names": ["l.f", "c.e"], "t0": 1.0, "t1": 1.0}
    )
    assert refused["error"]["code"] == "HB-W103"


def _text(model: hb.Model) -> str:
    from hybond.files.save import dumps

    return dumps(model)


def test_equations_of_all_modes_and_of_one_are_formulas() -> None:
    pytest.importorskip("latex2mathml")
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    both = asked(session, "equations")
    assert "diode" in "".join(both["notes"]) and _words(both["formula"]).count("κ") > 4
    mode = {"Sw": "open", "D": "conducts"}
    one = asked(session, "equations", one=True, mode=mode)
    assert one["text"].splitlines()[0] == "L.p' = -drop"
    assert "κ" not in _words(one["formula"])
    told = asked(session, "structure")["text"]
    assert "open, blocks" in told and "L.p" in told


def _words(tree: list[Any]) -> str:
    return "".join(t if isinstance(t, str) else _words(t) for t in tree[2:])


def test_names_that_look_like_markup_stay_words() -> None:
    pytest.importorskip("latex2mathml")
    tree = formula(r"\mathrm{<script>} + \href{x}{y}")
    tags: set[str] = set()

    def walk(t: list[Any]) -> None:
        tags.add(t[0])
        assert set(t[1]) <= {"width", "stretchy", "mathvariant"}
        for inner in t[2:]:
            if isinstance(inner, list):
                walk(inner)

    assert tree is not None
    walk(tree)
    assert tags <= {"math", "mrow", "mi", "mo", "mn", "mtext", "mspace"}


@pytest.mark.slow
def test_very_long_equations_are_text() -> None:
    m = hb.Model("long", domain="electrical")
    m.add(n=hb.Zero())
    for k in range(12):
        m.add(**{f"c{k}": hb.C(f"{k + 1} F"), f"r{k}": hb.R("1 ohm"), f"j{k}": hb.One()})
        m.bond(f"n -> j{k}", f"j{k} -> c{k}", f"j{k} -> r{k}")
    found = equations(m.flatten(), None)
    assert found["text"].count("'") >= 12
    assert found["formula"] is None or found["formula"][0] == "math"


@pytest.mark.slow
def test_the_schematic_is_that_of_the_level_and_places_are_those_of_the_page() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    seen = asked(session, "schematic", level="")
    groups = {g["key"]: g for g in seen["groups"] if g["name"] in ("part", "node")}
    assert set(groups) == {n["name"] for n in asked(session, "look")["view"]["nodes"]}
    picture = asked(session, "picture", form="svg", schematic=True)
    assert picture["name"].endswith(".svg")
    inner = session.handle({"id": 1, "ask": "schematic", "level": "diode"})
    assert inner["error"]["code"] == "HB-D110"
    gone = session.handle({"id": 1, "ask": "schematic", "level": "nobody"})
    assert "error" in gone
