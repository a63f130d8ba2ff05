"""Energy and losses by element against closed forms; sums against the audit."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest

import hybond as hb
from hybond.measures import energies
from hybond.measures.window import window_of

EXAMPLES = Path(__file__).parents[2] / "examples"


def run_of(name: str, until: str | None = None) -> hb.Result:
    return hb.simulate(hb.load(EXAMPLES / f"{name}.toml"), until=until)


def test_a_capacitor_charged_through_a_resistor() -> None:
    # to the end of charging a resistor takes as much as is stored, whatever it is
    m = hb.Model("rc", domain="electrical")
    m.add(u=hb.Se("10 V"), line=hb.One(), r=hb.R("1 kohm"), c=hb.C("1 mF", e="0 V"))
    m.bond("u -> line", "line -> r", "line -> c")
    run = hb.simulate(m, until="2 s", rtol=1e-11)
    found = run.losses()
    q = 1 - math.exp(-2)
    assert found["u"].supplied == pytest.approx(0.1 * q, rel=1e-10)
    assert found["c"].stored == pytest.approx(0.05 * q**2, rel=1e-10)
    assert found["r"].dissipated == pytest.approx(0.05 * (1 - math.exp(-4)), rel=1e-10)
    assert found.lost == 0.0 and found.holds(1e-12)
    # of a window, and of periods
    part = run.losses(start="0.5 s", end="1.5 s")
    wanted = 0.05 * (math.exp(-1) - math.exp(-3))
    assert part["r"].dissipated == pytest.approx(wanted, rel=1e-10)
    last = run.losses(period="0.25 s", periods=4).mean_power()
    assert last["r"].dissipated == pytest.approx(
        0.05 * (math.exp(-2) - math.exp(-4)) / 1.0, rel=1e-10
    )
    assert last.unit == "W" and last.mean_power() is last
    assert found.efficiency("c") == pytest.approx(0.5 * q, rel=1e-9)


def test_capacitors_joined_lose_at_the_switch() -> None:
    # 1 F at 10 V and 2 F at 4 V: C1 C2 / (C1 + C2) (u1 - u2)^2 / 2
    run = run_of("capacitors_joined")
    wanted = 0.5 * 2 / 3 * 6**2
    found = run.losses()
    assert found["join"].lost == pytest.approx(wanted, rel=1e-12)
    assert found["join"].kind == "switch"
    # the window after the jump knows nothing of it, the one that ends there does
    assert run.losses(start=1.0).lost == 0.0
    assert run.losses(end=1.0).lost == pytest.approx(wanted, rel=1e-12)


def test_a_ball_loses_at_its_contact() -> None:
    run = run_of("bouncing_ball_newton", until="5 s")
    bounces = 4  # at 0.78, 2.20, 3.50 and 4.67 s
    height = 9.81 * 3
    found = run.losses()
    assert found["contact"].lost == pytest.approx(height * (1 - 1.1 ** (-2 * bounces)), rel=1e-9)
    fallen = 3 - float(run["height"].at(5.0))
    assert found["weight"].supplied == pytest.approx(9.81 * fallen, rel=1e-9)
    assert [r.name for r in found] == ["weight", "ball", "contact"]


def test_two_switches_in_series_only_one_of_which_closes() -> None:
    # the one that is closed carries the same charge, and loses nothing
    m = hb.Model("two", domain="electrical")
    m.add(
        a=hb.C("1 mF", e="10 V"),
        b=hb.C("1 mF", e="0 V"),
        na=hb.Zero(),
        nb=hb.Zero(),
        s1=hb.One(),
        s2=hb.One(),
        middle=hb.Zero(),
    )
    m.bond("na -> a", "nb -> b", "na -> s1 -> middle -> s2 -> nb")
    m.machine(
        "first",
        states={"open": [], "closed": ["s1"]},
        start="closed",
        rules=[],
    )
    m.machine(
        "second",
        states={"open": [], "closed": ["s2"]},
        start="open",
        rules=["open -> closed when time >= 1"],
    )
    found = hb.simulate(m, until="2 s").losses()
    assert found["s2"].lost == pytest.approx(0.025, rel=1e-9)
    assert "s1" not in {r.name for r in found}
    assert found.notes == ()


def test_a_source_that_steps_onto_a_capacitor() -> None:
    # half of what the source gives is lost, and there is no switch that could lose it
    m = hb.Model("step", domain="electrical")
    m.add(u=hb.Se("if time >= 1 then 4 V else 0 V"), n=hb.Zero(), c=hb.C("1 mF", e="0 V"))
    m.bond("u -> n", "n -> c")
    found = hb.simulate(m, until="2 s").losses()
    assert found["u"].supplied == pytest.approx(16e-3, rel=1e-9)
    assert found["u"].lost == pytest.approx(8e-3, rel=1e-9)
    assert found["c"].stored == pytest.approx(8e-3, rel=1e-9)


def test_friction_is_lost_at_its_junction() -> None:
    # a block that slides to rest: all that it had goes into friction
    m = hb.Model("block", domain="translational")
    m.add(
        mass=hb.I("2 kg", f="3 m/s"),
        v=hb.One(),
        rub=hb.Zero(),
        slip=hb.One(law="coulomb", limit="4 N", breakaway="5 N"),
    )
    m.bond("v -> mass", "v -> rub -> slip")
    found = hb.simulate(m, until="4 s").losses()
    assert found["slip"].dissipated == pytest.approx(9.0, rel=1e-9)
    assert found["mass"].stored == pytest.approx(-9.0, rel=1e-9)


NAMES = (
    "clutch",
    "boost",
    "diode_inductor_law",
    "two_body_collision",
    "newtons_cradle",
    "tank_overflow_sliding",
    "sliding_clutch",
    "coulomb_friction",
    "thyristor_rectifier",
    "check_valve",
    "ratchet",
)


@pytest.mark.parametrize("name", NAMES)
def test_the_columns_add_up(name: str) -> None:
    run = run_of(name)
    found = run.losses()
    assert found.holds(1e-8)
    # what the audit's own quadrature says of sources and resistors
    sums = sum(run.energies(s)[-1] for s in run.segments)
    struck = sum(
        s.energy.source - s.energy.lost
        for e in run.events
        for s in e.steps
        if s.energy is not None and s.kind != "mythical"
    )
    assert found.stored == pytest.approx(
        sums[0] - sums[1] + struck, abs=1e-8 * max(found.through, 1e-30)
    )
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    assert found.lost == pytest.approx(lost, abs=1e-9 * max(found.through, 1e-30))


def test_windows_add_up_to_the_run() -> None:
    run = run_of("clutch")
    whole = run.losses()
    parts = [run.losses(start=a, end=b) for a, b in ((0, 4), (4, 15), (15, 20))]
    for row in whole:
        for column in ("supplied", "dissipated", "lost", "stored"):
            split = sum(getattr(p[row.name], column) for p in parts if row.name in _names(p))
            assert split == pytest.approx(getattr(row, column), abs=1e-9)


def _names(found: object) -> set[str]:
    return {r.name for r in found}  # type: ignore[attr-defined]


def test_grouped_and_other_forms() -> None:
    run = run_of("boost")
    found = run.losses(depth=1)
    assert [r.name for r in found] == ["supply", "coil", "C", "light", "heavy"]
    assert found.supplied == pytest.approx(run.losses().supplied)
    assert run.losses()["light"].dissipated == pytest.approx(found["light"].dissipated)
    table = found.to_pandas()
    assert table.loc["supply", "supplied"] == found["supply"].supplied
    assert "<td>supply</td>" in found._repr_html_()
    assert found.to_dict()["total"]["supplied"] == found.supplied
    assert str(found).splitlines()[-1].startswith("total")
    # at the end of periods in which nothing is stored, all that comes in goes to the loads
    steady = run.losses(period="20 us", periods=5)
    assert steady.efficiency(["light", "heavy"]) == pytest.approx(1.0, rel=1e-3)
    assert steady.efficiency(["light", "heavy"], sources="supply") > 0.99


def test_names_that_are_not_there() -> None:
    run = run_of("boost")
    with pytest.raises(hb.UsageError) as refused:
        run.losses().efficiency("heavi")
    assert refused.value.code == "HB-R111" and "heavy" in refused.value.hint
    with pytest.raises(hb.UsageError, match="HB-R112"):
        run.losses().efficiency("light", sources="heavy")


def test_time_stepping_does_not_know() -> None:
    m = hb.load(EXAMPLES / "half_wave_rectifier.toml")
    run = hb.simulate(m, until="5 ms", solver="moreau-jean", step="0.1 ms")
    with pytest.raises(hb.UsageError, match="HB-R113"):
        run.losses()


def test_pictures(tmp_path: Path) -> None:
    run = run_of("clutch")
    for name, write in (("over_time", run.plot_losses), ("sankey", run.sankey)):
        figure = write(str(tmp_path / f"{name}.png"))
        assert (tmp_path / f"{name}.png").stat().st_size > 5000
        texts = {t.get_text() for ax in figure.axes for t in ax.texts}
        texts |= {
            t.get_text() for ax in figure.axes if ax.get_legend() for t in ax.get_legend().texts
        }
        assert any("ohmic" in t for t in texts)


def test_clocks_of_controllers_store_no_energy() -> None:
    """A timer, a period meter and the firing of a bridge count seconds, which are no joules."""
    m = hb.Model("clocks", domain="electrical")
    m.add(
        v=hb.Submodel("electrical.voltage_source", inputs={"u": "1 [mV]*sin(314*time/(1 s))"}),
        r=hb.Submodel("electrical.resistor", R="1 kohm"),
        g=hb.Submodel("electrical.ground"),
        timer=hb.Submodel("control.timer", T="10 s", inputs={"u": "1"}),
        meter=hb.Submodel("control.period_meter", inputs={"u": "v.plus.e/(1 V)"}),
        firing=hb.Submodel("control.line_firing", inputs={"u": "v.plus.e/(1 V)", "alpha": "1"}),
    )
    m.bond("v.plus -> r.plus", "v.minus -> r.minus", "g.pin -> v.minus")
    run = hb.simulate(m, "0.1 s")
    found = run.losses(depth=1)
    assert {row.name for row in found} == {"v", "r"} and not found.notes and found.holds()
    assert found["r"].dissipated == pytest.approx(1e-9 * (0.05 - math.sin(62.8) / 1256), rel=1e-8)
    assert float(run["timer.waited"].at(0.1)) == pytest.approx(0.1, rel=1e-12)
    assert float(run["firing.frequency"].at(0.1)) == pytest.approx(314 / (2 * math.pi), rel=1e-8)


@pytest.mark.parametrize(("relay", "diode"), [("a", "z"), ("z", "a")])
def test_what_friction_takes_in_a_jump_is_the_same_whichever_law_lasts(
    relay: str, diode: str
) -> None:
    """10 V onto an empty capacitor of the same size, through a relay of 2 V: 4 C pass.

    The relay takes 2 V times 4 C. The voltage that closes is shared by the two junctions before,
    5 V each: the diode loses 4 C times the mean of 5 V and 0, and the relay 4 C times that of 3 V
    and 0 beside what it takes. Behind it nothing flows, and either of them may hold.
    """
    m = hb.Model("joined", domain="electrical")
    laws = {relay: hb.One(law="relay", limit="2 V"), diode: hb.One(law="diode")}
    m.add(**laws, c1=hb.C("1 F", e="10 V"), c2=hb.C("1 F"))
    m.bond(f"c1 -> {diode} -> c2", f"{diode} -> {relay}")
    run = hb.simulate(m, "1 s")
    jump = run.events[0].steps[0].energy
    assert jump is not None
    assert (jump.source, jump.lost) == pytest.approx((0.0, 24.0), rel=1e-12)
    lost = {row.name: row.lost for row in run.losses().rows if row.lost}
    assert lost == pytest.approx({relay: 14.0, diode: 10.0}, rel=1e-12)


@pytest.mark.parametrize("domain", ["thermal_pseudo", "generic_pseudo"])
def test_a_model_of_pseudo_bonds_alone_has_no_losses_and_says_so(
    domain: str, tmp_path: Path
) -> None:
    m = hb.Model("room", domain=domain)
    m.add(room=hb.C(1e5, e=293), wall=hb.R(0.02), air=hb.Zero())
    m.bond("air -> room", "air -> wall")
    run = hb.simulate(m, until=3600)
    found = run.losses()
    assert not len(found) and found.supplied == found.stored == found.through == 0.0
    assert found.notes == ("on pseudo bonds there is no energy: room, wall",)
    assert not len(run.losses(end="1 s").mean_power())
    run.plot_losses(str(tmp_path / "none.png"))


def test_losses_and_audit_judge_by_one_rule() -> None:
    """A condenser microphone: errors of explicit steps add up to 4e-7 of the energy at 1e-8.

    The states are right to 1e-9; the audit knows that no step was off by more than it may be.
    """
    m = hb.Model("mic", domain="electrical", parameters={"eA": 8.854e-16, "d0": 1e-4, "k": 500.0})
    m.add(V=hb.Se(20), i=hb.One(), R=hb.R(1e6), v=hb.One(domain="generic"))
    m.add(M=hb.I(1e-3, domain="generic"), b=hb.R(0.05, domain="generic"))
    law = {"e": ["q1*(d0+q2)/eA", "q1^2/(2*eA)+k*q2"]}
    m.add(cf=hb.C(law, domain="generic", q=[0, 0]))
    m.bond("V -> i -> R", "i -> cf.1", "v -> cf.2", "v -> M", "v -> b")
    run = hb.simulate(m, until=5e-3, solver="rk45")
    audit, losses = run.audit(), run.losses()
    assert abs(losses.unbalanced) > 1e-7 * losses.through
    assert (audit.holds(), losses.holds()) == (True, True)
    assert (audit.holds(1e-9), losses.holds(1e-9)) == (False, False)
    # what no step accounts for is no less wrong for it
    wrong = dataclasses.replace(losses, rows=losses.rows[1:], beyond=math.inf)
    assert not wrong.holds()


def test_where_next_to_nothing_passes_is_measured_against_the_rest_of_the_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a long run a part is integrated at a time: the end of one that has died out alone too.

    Of ``V**2/R*exp(-2*t/(R*C))`` next to nothing is left there, known by its last digits.
    """
    m = hb.Model("discharged", domain="electrical")
    m.add(c=hb.C("1 uF", e="10 V"), c2=hb.C("1 uF", e="10 V"))
    m.add(r=hb.R("1 kohm"), r2=hb.R("1 kohm"), a=hb.Zero(), b=hb.Zero())
    m.bond("a -> c", "a -> r", "b -> c2", "b -> r2")
    run = hb.simulate(m, "60 ms")
    nodes = energies.power_nodes(run.graph)
    window = window_of(run, start=None, end=None, period=None, periods=None)
    at_once = energies.energies_into(run, nodes, window)
    monkeypatch.setattr(energies, "AT_ONCE", 22 * 4 * len(at_once.low) // 9)
    in_parts = energies.energies_into(run, nodes, window)
    assert len(in_parts.low) <= 1.1 * len(at_once.low)
    taken = dict(zip([n.path for n in nodes], in_parts.total.tolist(), strict=True))
    assert taken["r"] == pytest.approx(0.5e-6 * 100.0, rel=1e-8)
    assert taken["c"] == pytest.approx(-0.5e-6 * 100.0, rel=1e-8)
