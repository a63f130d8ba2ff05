"""Modelica: what is said, and what an independent tool makes of it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.errors import HybondError, ModelError
from hybond.export.modelica import to_modelica

EXAMPLES = Path(__file__).parents[2] / "examples"

REFUSED = {
    "bead_column": "HB-E684",
    "diode_bridge": "HB-E681",
    "elevator_actuators": "HB-E680",
    "impacting_stick": "HB-E680",
    "mmc_arm": "HB-E684",
    "parallel_resonant_converter": "HB-E681",
    "planar_puck": "HB-E680",
    "thyristor_rectifier": "HB-E681",
    "woodpecker": "HB-E680",
}

AGREE = {
    "ball_on_shaker": 1e-5,
    "block_on_incline": 1e-9,
    "bouncing_ball": 1e-6,
    "bouncing_ball_air": 1e-6,
    "bouncing_ball_margetts": 1e-6,
    "bouncing_ball_newton": 1e-5,
    "bouncing_ball_two_junctions": 1e-5,
    "bullet_and_wood": 1e-12,
    "capacitors_joined": 1e-12,
    "check_valve": 1e-6,
    "clutch": 1e-6,
    "clutch_rigid": 1e-6,
    "coulomb_friction": 1e-6,
    "diagnosis_circuit": 1e-6,
    "diode_inductor": 1e-6,
    "diode_inductor_law": 1e-6,
    "end_stops": 1e-5,
    "evaporator": 1e-4,
    "falling_rod": 1e-5,
    "friction_oscillator": 1e-6,
    "half_bridge": 1e-8,
    "half_wave_rectifier": 1e-6,
    "one_way_clutch": 1e-6,
    "relay_fast_switches": 1e-5,
    "rlcd": 1e-6,
    "rope_and_disc": 1e-6,
    "stick_slip": 1e-6,
    "two_body_collision": 1e-12,
    "weirs": 1e-3,
}
"""The largest difference of a stored or integrated quantity, beside its largest value."""


def load(name: str) -> hb.Model:
    return hb.load(EXAMPLES / f"{name}.toml")


def in_peer(text: str, until: float, points: int = 401):
    rumoca = pytest.importorskip("rumoca")
    model = rumoca.Session().loads(text, model=text.split()[1])
    config = rumoca.SimConfig(
        solver="rk-like", rtol=1e-10, atol=1e-12, dt=until / (points - 1), max_wall_seconds=30
    )
    return model.simulate(t=(0.0, until), config=config)


def ident(path: str) -> str:
    return re.sub(r"\W", "_", path)


LONG = {"automatic_gearbox"}
"""Refused as well, HB-E682, after a quarter of a minute of symbols."""


@pytest.mark.sampled(10)
@pytest.mark.parametrize(
    "name",
    [
        # a bridge as in rectifier_dc_machine, which takes a quarter of the time
        pytest.param(n, marks=[pytest.mark.slow] * (n == "six_pulse_rectifier"))
        for n in sorted({p.stem for p in EXAMPLES.glob("*.toml")} - LONG)
    ],
)
def test_every_example_is_written_or_refused_with_its_reason(name: str) -> None:
    if name in REFUSED:
        with pytest.raises(HybondError) as refused:
            to_modelica(load(name))
        assert refused.value.code == REFUSED[name] and refused.value.hint
        return
    text = to_modelica(load(name))
    assert text.startswith(f"model {name} ") or text.startswith(f"model {name}\n")
    assert text.endswith(f"end {name};\n") and text.isascii()
    declared = re.findall(
        r"^  (?:parameter |constant |discrete )?(?:Real|Integer|Boolean) (\w+)", text, re.M
    )
    assert len(set(declared)) == len(declared)
    body = text.partition("\nequation\n")[2]
    body = re.sub(r'"[^"]*"|annotation.*', "", body)
    words = set(re.findall(r"(?<![\w.])[A-Za-z_]\w*", body))
    known = "der pre time if then else elseif when end and or not sqrt abs sin cos tan exp min max"
    known += " reinit noEvent sign assert sample true false log hypot floor " + name
    assert words <= {*known.split(), *declared}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", sorted(AGREE))
def test_a_modelica_tool_finds_the_same_motion(name: str) -> None:
    model = load(name)
    run = hb.simulate(model)
    until = run.t_end
    found = in_peer(to_modelica(model), until)
    t = np.array(found.time)
    graph = run.graph
    for path in [s.path for s in graph.storages] + [i.path for i in graph.integrals]:
        theirs = np.array(found[ident(path)])
        # either side of an event, the time of which is known to its tolerance
        ours = [run.sample(t, [path], side=side)[path] for side in ("left", "right")]
        for shift in (-1e-7, 1e-7):
            ours.append(run.sample(np.clip(t + shift * until, 0.0, until), [path])[path])
        largest = max(float(np.abs(y).max()) for y in ours)
        off = np.min([np.abs(theirs - y) for y in ours], axis=0)
        assert off.max() <= AGREE[name] * max(largest, 1e-300), path


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "name",
    ["diode_inductor", "falling_rod", "end_stops", "clutch_rigid", "half_bridge", "stick_slip"],
)
def test_a_modelica_tool_finds_the_same_events(name: str) -> None:
    """The states of all machines, in the middle between the events."""
    model = load(name)
    run = hb.simulate(model)
    found = in_peer(to_modelica(model), run.t_end)
    t = np.array(found.time)
    times = [e.t for e in run.events] + [run.t_end]
    compared = 0
    for k, event in enumerate(run.events):
        if times[k + 1] - times[k] < 2e-2 * run.t_end / len(times):
            continue
        inside = np.flatnonzero(
            (t > times[k] + 1e-6 * run.t_end) & (t < times[k + 1] - 1e-6 * run.t_end)
        )
        for machine, state in zip(run.graph.machines, event.steps[-1].mode, strict=True):
            name_of = ident(machine.path)
            assert all(round(float(found[name_of][j])) == state + 1 for j in inside)
            compared += len(inside)
    assert compared > 20


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["falling_rod_threshold", "bouncing_ball_no_mode"])
def test_where_time_cannot_advance_the_tool_says_so_at_the_same_instant(name: str) -> None:
    model = load(name)
    with pytest.raises(hb.DivergenceOfTime) as stopped:
        hb.simulate(model)
    at = stopped.value.partial.t_end
    pytest.importorskip("rumoca")
    with pytest.raises(Exception, match="event iteration") as said:
        in_peer(to_modelica(model), float(hb.simulate(model, on_error="return").t_end) * 1.1)
    found = re.search(r"t=([0-9.]+)", str(said.value))
    assert found is not None and float(found[1]) == pytest.approx(at, rel=1e-8)


@pytest.mark.slow
def test_impacts_that_accumulate_end_the_run_instead_of_passing_the_floor() -> None:
    model = load("bouncing_ball_contact")
    limit = hb.simulate(model).accumulations[0].t
    pytest.importorskip("rumoca")
    with pytest.raises(Exception, match="impacts accumulate") as said:
        in_peer(to_modelica(model), 10.0)
    found = re.search(r"t=([0-9.]+)", str(said.value))
    assert found is not None and float(found[1]) == pytest.approx(limit, rel=1e-6)


def test_staying_in_a_state_without_a_field_ends_the_run() -> None:
    model = load("bouncing_ball_newton")
    floor = model.machines["floor"]
    model.machines["floor"] = floor.__class__(
        floor.states, floor.start, (floor.rules[0], "impact -> away when pre(ball.p) >= 100")
    )
    with pytest.raises(HybondError):
        hb.simulate(model)
    with pytest.raises(Exception, match="holds at an instant only"):
        in_peer(to_modelica(model), 6.0)


def test_a_last_state_in_which_a_node_floats_ends_the_run() -> None:
    """No rule leads out of that state, so nothing but the assertion reads it."""
    m = hb.Model("floats", domain="electrical")
    m.add(V=hb.Se("2 V"), W=hb.Se("3 V"), J=hb.Sf("0 A"), v=hb.One(), w=hb.One(), n=hb.Zero())
    m.bond("V -> v -> n", "W -> w -> n", "J -> n")
    m.signal(seen=hb.Integral("n.e"))
    m.machine(
        "S",
        states={"v": ["v"], "w": ["w"], "none": []},
        start="v",
        rules=["v -> w when time >= 1", "w -> none when time >= 1.5"],
    )
    text = to_modelica(m)
    assert in_peer(text, 1.4)["seen"][-1] == pytest.approx(2.0 + 0.4 * 3.0, abs=1e-8)
    with pytest.raises(Exception, match=r"n\.e is not determined: S = none"):
        in_peer(text, 2.0)


@pytest.mark.parametrize("name", ["bouncing_ball", "half_bridge", "end_stops"])
def test_a_parser_reads_the_text(name: str) -> None:
    parser = pytest.importorskip("pymoca.parser")
    tree = parser.parse(to_modelica(load(name)))
    assert tree is not None and name in tree.classes


def test_parameters_stay_parameters() -> None:
    m = hb.Model("rod", domain="rotational", parameters={"m": "2 kg", "l": "3 m"})
    m.parameter(J="m*l^2/3", k="1 kN*m")
    m.add(turn=hb.I("J"), spring=hb.C("1/k"), v=hb.One())
    m.bond("v -> turn", "v -> spring")
    text = to_modelica(m)
    assert 'parameter Real m(unit = "kg") = 2;' in text
    assert "parameter Real J = m*l^2/3;" in text
    assert 'parameter Real k(unit = "J") = 1000;' in text or 'unit = "N.m"' in text
    assert "der(turn_p) = -k*spring_q;" in text and "der(spring_q) = turn_p/J;" in text


def test_a_parameter_that_is_changed_in_the_text_acts_as_in_hybond() -> None:
    model = load("diode_inductor")
    text = to_modelica(model)
    changed = text.replace('I_th(unit = "A") = 0.01', 'I_th(unit = "A") = 0.3')
    changed = changed.replace('t_off(unit = "s") = 0.05', 't_off(unit = "s") = 0.02')
    assert changed.count("0.3;") == 1 and changed.count("0.02;") == 1
    run = hb.simulate(model, parameters={"I_th": "0.3 A", "t_off": "20 ms"})
    found = in_peer(changed, run.t_end)
    for t in (0.01, 0.03, run.events[2].t - 1e-3, run.events[2].t + 1e-3):
        k = int(np.argmin(np.abs(np.array(found.time) - t)))
        ours = run.sample([float(found.time[k])], ["L.p"])["L.p"][0]
        assert found["L_p"][k] == pytest.approx(ours, rel=1e-6, abs=1e-9)


def test_a_parameter_whose_value_went_into_numbers_is_a_constant() -> None:
    text = to_modelica(load("bouncing_ball_contact"))
    assert 'constant Real h0(unit = "m") = 1;' in text  # where the ball starts
    assert 'parameter Real g(unit = "m/s2") = 9.81;' in text


def test_names_of_the_language_and_of_each_other_are_kept_apart() -> None:
    m = hb.Model("end", title='The "end" of it \\ Ω')
    m.add(model=hb.C(1, q=1.0), der=hb.R(2), n=hb.Zero(), when=hb.I(1), a_b=hb.R(1), j=hb.One())
    m.bond("n -> model", "n -> der", "n -> j -> when", "j -> a_b")
    m.signal(algorithm="model.e", model_e="2*model.e")
    m.machine("loop", states={"then": ["j"], "else_": []}, start="then")
    m.machines["loop"] = m.machines["loop"].__class__(
        {"in": ("j",), "out": ()}, "in", ("in -> out when model.e < 0.1",)
    )
    text = to_modelica(m)
    assert (
        text.startswith("model end_ ") and "Real algorithm_ " in text and "Integer loop_(" in text
    )
    found = in_peer(text, 2.0)
    run = hb.simulate(m, until=2.0)
    assert found["model_q"][-1] == pytest.approx(run.final["model.q"], rel=1e-6)


def test_inputs_as_tables_and_pulses_in_closed_form() -> None:
    m = hb.Model("driven")
    m.add(held=hb.Sf("a"), joined=hb.Sf("b"), pulses=hb.Sf("c"))
    m.add(x=hb.C(1), y=hb.C(1), z=hb.C(1), nx=hb.Zero(), ny=hb.Zero(), nz=hb.Zero())
    m.bond("held -> nx -> x", "joined -> ny -> y", "pulses -> nz -> z")
    m.input(
        a=hb.Input(table=[[0, 1], [1, -2]]), b=hb.Input(table=[[0.5, 0], [1.5, 4]], linear=True)
    )
    m.input(c=hb.Input(pwm={"period": 0.5, "duty": 0.25, "high": 2, "low": -1, "phase": 0.1}))
    found = in_peer(to_modelica(m), 2.0)
    assert found["x_q"][-1] == pytest.approx(1.0 - 2.0, abs=1e-8)
    assert found["y_q"][-1] == pytest.approx(2.0 + 2.0, abs=1e-7)
    high = 4 * 0.125  # four pulses; high before the first one never is
    assert found["z_q"][-1] == pytest.approx(2.0 * high - (2.0 - high), abs=1e-8)


def test_tables_that_fall_or_begin_before_the_run_are_words_of_modelica() -> None:
    m = hb.Model("falls")
    m.add(once=hb.Sf("a"), again=hb.Sf("b"), x=hb.C(1), y=hb.C(1), nx=hb.Zero(), ny=hb.Zero())
    m.bond("once -> nx -> x", "again -> ny -> y")
    m.input(
        a=hb.Input(table=[[-1, 3], [0.5, 0], [1, -2], [2, -4]], linear=True),
        b=hb.Input(table=[[-0.5, 2], [0.25, -1]], linear=True, period=1.0),
    )
    text = to_modelica(m)
    assert not re.search(r"[-+*/] -", text)  # no sign stands behind an operator there
    found = in_peer(text, 3.0)
    # triangles and trapezoids: 1/2*1/2 - 1/2*2/2 - 3 - 4, three periods of mean 1/2
    assert found["x_q"][-1] == pytest.approx(0.25 - 0.5 - 3 - 4, abs=1e-6)
    assert found["y_q"][-1] == pytest.approx(1.5, abs=1e-6)


@pytest.mark.parametrize("turned", [False, True])
def test_capacitors_joined_share_their_charge_either_way(turned: bool) -> None:
    m = hb.Model("caps")
    m.add(a=hb.C("1 F", e="10 V"), b=hb.C("2 F", e="4 V"), n1=hb.Zero(), n2=hb.Zero(), sw=hb.One())
    m.bond(
        "n1 -> a",
        "b -> n2" if turned else "n2 -> b",
        "n2 -> sw -> n1" if turned else "n1 -> sw -> n2",
    )
    m.machine(
        "S",
        states={"open": [], "closed": ["sw"]},
        start="open",
        rules=["open -> closed when time >= 1"],
    )
    found = in_peer(to_modelica(m), 2.0)
    run = hb.simulate(m, until=2.0)
    for path in ("a.q", "b.q"):
        assert found[ident(path)][-1] == pytest.approx(run.final[path], rel=1e-12)
    if not turned:
        assert found["a_q"][-1] == pytest.approx(6.0, rel=1e-12)  # 18 C on 3 F


@pytest.mark.parametrize("turned", [False, True])
def test_a_diode_with_a_resistor_in_closed_form_either_way(turned: bool) -> None:
    m = hb.Model("clip")
    m.add(V=hb.Se("10*cos(3*time)"), d=hb.One(law="diode"), r=hb.R(2), n=hb.Zero(), c=hb.C(0.5))
    m.bond("V -> d -> n", *(("r -> d", "c -> n") if turned else ("d -> r", "n -> c")))
    run = hb.simulate(m, until=0.4)
    found = in_peer(to_modelica(m), 0.4)
    # q' = (10 cos 3t - q/C)/R with R C = 1, until the current ends
    t = 0.2
    k = int(np.argmin(np.abs(np.array(found.time) - t)))
    at = float(found.time[k])
    exact = 5.0 * (math.cos(3 * at) + 3 * math.sin(3 * at) - math.exp(-at)) / 10.0
    assert found["c_q"][k] == pytest.approx(exact, rel=1e-8)  # what is stored has no arrow
    assert run.final["c.q"] == pytest.approx(float(found["c_q"][-1]), rel=1e-7)


def test_a_python_function_and_a_table_with_an_end_are_refused() -> None:
    m = hb.Model("m")
    m.add(V=hb.Se("u"), r=hb.R({"e": {"table": [[-1, 1], [-1, 1]]}}), l=hb.I(1), j=hb.One())
    m.bond("V -> j -> r", "j -> l")
    m.input(u=hb.Input(function=lambda t: t))
    with pytest.raises(ModelError) as refused:
        to_modelica(m)
    assert refused.value.code == "HB-E680"


def test_the_product_of_two_impulses_is_refused() -> None:
    m = hb.Model("hit")
    m.add(a=hb.I(1, f=1), b=hb.I(1), v=hb.One(), w=hb.One(), c=hb.Zero())
    m.bond("v -> a", "w -> b", "v -> c -> w")
    m.signal(x=hb.Integral("w.f - v.f", start=0.5))
    m.machine(
        "S",
        states={"off": [], "on": ["c"]},
        start="off",
        rules=["off -> on when x <= 0", "on -> off when c.e*c.e > 1"],
    )
    with pytest.raises(ModelError) as refused:
        to_modelica(m)
    assert refused.value.code == "HB-E683"
