"""Where a model is linearised: rests that Newton finds, times of runs, states that are given."""

import numpy as np
import pytest

import hybond as hb
from hybond.errors import HybondError


def tanks() -> hb.Model:
    """Two tanks that a pipe joins; nothing leaves: the volume is kept."""
    m = hb.Model("tanks", domain="hydraulic")
    m.add(a=hb.C("2 l/bar", q="3 l"), na=hb.Zero(), pipe=hb.One(), nb=hb.Zero(), b=hb.C("1 l/bar"))
    m.add(r=hb.R({"e": "1e9*f + 1e12*f*abs(f)"}))
    m.bond("na -> a", "na -> pipe -> nb -> b", "pipe -> r")
    return m


def test_of_many_rests_the_one_that_keeps_the_volume() -> None:
    lin = hb.linearise(tanks(), inputs=[], outputs=["na.e", "nb.e"], at="equilibrium")
    # 3 l in 3 l/bar: 1 bar in both
    assert lin.operating["na.e"] == pytest.approx(1e5, rel=1e-9)
    assert lin.operating["nb.e"] == pytest.approx(1e5, rel=1e-9)
    assert any("not the only rest" in note for note in lin.notes)
    # one pole at zero, exactly; the other discharges one into the other: -(1/Ca + 1/Cb)/R
    slow = -(1e5 / 2e-3 + 1e5 / 1e-3) / 1e9
    assert lin.poles().tolist() == pytest.approx([slow, 0.0], rel=1e-9, abs=0.0)


def test_a_rest_at_zero() -> None:
    m = hb.Model("rc")
    m.add(n=hb.Zero(), c=hb.C(3.0, q=2.0), r=hb.R(7.0))
    m.bond("n -> c", "n -> r")
    lin = hb.linearise(m, at="equilibrium")
    assert lin.steady and abs(lin.operating["c.q"]) < 1e-12
    assert lin.poles() == pytest.approx([-1 / 21], rel=1e-12)


def pendulum(torque: str = "0 N*m") -> hb.Model:
    m = hb.Model("pendulum", domain="rotational", parameters={"T": torque})
    m.add(w=hb.One(), J=hb.I("0.5 kg*m^2"), b=hb.R("0.1 N*m*s"), g=hb.Se("T - 4 [N*m]*sin(th)"))
    m.bond("g -> w -> J", "w -> b")
    m.signal(th=hb.Integral("w.f", start=2.6))
    return m


def test_the_rest_that_is_near() -> None:
    up = hb.linearise(pendulum(), inputs=["T"], outputs=["th"], at="equilibrium")
    # from 2.6 rad the iteration goes to the upright rest, which falls: s^2 J + s b - 4 = 0
    assert up.operating["th"] == pytest.approx(np.pi, abs=1e-9) and not up.stable
    assert up.poles() == pytest.approx(np.sort(np.roots([0.5, 0.1, -4.0])), rel=1e-9)
    hanging = hb.linearise(pendulum(), inputs=["T"], outputs=["th"], at={"th": 0.0})
    assert hanging.stable
    assert np.sort_complex(hanging.poles()) == pytest.approx(
        np.sort_complex(np.roots([0.5, 0.1, 4.0])), rel=1e-9
    )
    assert hanging.gain()[0, 0] == pytest.approx(0.25, rel=1e-9)


def test_no_rest_is_refused_with_what_goes_on() -> None:
    m = hb.Model("falling", domain="translational")
    m.add(g=hb.Se("-9.81 N"), v=hb.One(), m=hb.I("1 kg"))
    m.bond("g -> v -> m")
    with pytest.raises(HybondError, match=r"m\.p goes on changing, -9\.81 a second") as refused:
        hb.linearise(m, at="equilibrium")
    assert refused.value.code == "HB-A510"
    with pytest.raises(HybondError, match="HB-A510"):
        # 5 N*m cannot be held by 4
        hb.linearise(pendulum("5 N*m"), at="equilibrium")
    m = hb.Model("driven")
    m.add(V=hb.Se("sin(time/(1 s))"), j=hb.One(), r=hb.R(1), c=hb.C(1))
    m.bond("V -> j -> r", "j -> c")
    with pytest.raises(HybondError, match="V changes with time"):
        hb.linearise(m, at="equilibrium")


def test_what_nothing_reads_may_go_on() -> None:
    m = hb.Model("motor", domain="rotational")
    m.add(T=hb.Se("2 N*m"), w=hb.One(), J=hb.I("1 kg*m^2"), b=hb.R("0.5 N*m*s"))
    m.bond("T -> w -> J", "w -> b")
    m.signal(angle=hb.Integral("w.f"))
    lin = hb.linearise(m, inputs=["T"], outputs=["w.f"], at="equilibrium")
    assert lin.operating["w.f"] == pytest.approx(4.0, rel=1e-9)
    assert any("angle goes on at 4 a second" in note for note in lin.notes)


def switched(guard: str = "time >= 1") -> hb.Model:
    m = hb.Model("rc", domain="electrical")
    m.add(V=hb.Se("6 V"), s=hb.One(), n=hb.Zero(), c=hb.C("1 F"), r=hb.R("4 ohm"), rs=hb.R("2 ohm"))
    m.bond("V -> s -> n -> c", "s -> rs", "n -> r")
    m.machine("S", states={"on": ["s"], "off": []}, start="on", rules=[f"on -> off when {guard}"])
    return m


def test_along_a_run_each_in_its_mode() -> None:
    run = hb.simulate(switched(), until="2 s")
    both = hb.linearise(run, inputs=["V"], outputs=["n.e"], at=[0.5, "1.5 s"])
    assert [lin.mode["S"] for lin in both] == ["on", "off"]
    assert both[0].poles() == pytest.approx([-0.75], rel=1e-12)
    assert both[1].poles() == pytest.approx([-0.25], rel=1e-12)
    # q = 4 (1 - exp(-0.75 t)): two thirds of 6 V
    assert both[0].operating["c.q"] == pytest.approx(4 * (1 - np.exp(-0.375)), rel=1e-8)
    # at the event itself: after all that happened there
    (there,) = hb.linearise(run, inputs=["V"], outputs=["n.e"], at=[1.0])
    assert there.mode["S"] == "off"
    assert hb.linearise(run).mode["S"] == "off"


def test_an_event_at_the_very_end_is_over() -> None:
    run = hb.simulate(switched(), until="1 s")
    assert hb.linearise(run, inputs=["V"], outputs=["n.e"], at="end").mode["S"] == "off"


def test_sliding_has_no_one_mode() -> None:
    m = hb.Model("relay")
    m.add(f=hb.Se("1 - 3*side"), v=hb.One(), m=hb.I(1.0), r=hb.R(0.1))
    m.bond("f -> v -> m", "v -> r")
    m.signal(side='if S.state == "up" then 1 else 0')
    m.machine(
        "S",
        states={"up": [], "down": []},
        start="down",
        rules=["down -> up when v.f > 0.5", "up -> down when v.f < 0.5"],
    )
    run = hb.simulate(m, until="3 s")
    assert run.sliding
    with pytest.raises(HybondError, match="slides along") as refused:
        hb.linearise(run, at=2.5)
    assert refused.value.code == "HB-A505"


@pytest.mark.parametrize(
    ("asked", "code"),
    [
        ({"inputs": ["W"]}, "HB-A501"),
        ({"inputs": ["V.f"]}, "HB-A501"),
        ({"outputs": ["n.q"]}, "HB-S109"),
        ({"at": {"c.x": 1.0}}, "HB-A503"),
        ({"at": {"c.q": "1 m"}}, "HB-A503"),
        ({"at": "2 ms"}, "HB-A503"),
        ({"mode": {"S": "shut"}}, "HB-M144"),
    ],
)
def test_refusals_of_a_model(asked: dict[str, object], code: str) -> None:
    with pytest.raises(HybondError) as refused:
        hb.linearise(switched(), **asked)  # type: ignore[call-overload]
    assert refused.value.code == code and refused.value.hint


def test_a_mode_that_is_left_at_once() -> None:
    m = switched("c.e > 2")
    with pytest.raises(HybondError, match="left at once") as refused:
        hb.linearise(m, at={"c.q": 3.0}, mode={"S": "on"})
    assert refused.value.code == "HB-A507"
    assert hb.linearise(m, at={"c.q": 3.0}).mode == {"S": "off"}


def test_states_that_contradict_each_other() -> None:
    m = hb.Model("pair", domain="electrical")
    m.add(n=hb.Zero(), a=hb.C("1 F"), b=hb.C("1 F"), r=hb.R("1 ohm"))
    m.bond("n -> a", "n -> b", "n -> r")
    with pytest.raises(HybondError, match="cannot stay") as refused:
        hb.linearise(m, at={"a.q": 1.0})
    assert refused.value.code == "HB-A504"
    lin = hb.linearise(m, at={"a.q": 1.0, "b.q": 1.0}, inputs=[], outputs=["n.e"])
    assert lin.poles() == pytest.approx([-0.5], rel=1e-12)


def test_a_root_at_its_end_has_no_slope() -> None:
    m = hb.Model("tank")
    m.add(t=hb.C(1.0), n=hb.Zero(), o=hb.R({"f": "sqrt(e)"}))
    m.bond("n -> t", "n -> o")
    with pytest.raises(HybondError) as refused:
        hb.linearise(m)
    assert refused.value.code == "HB-A506" and refused.value.where == "o"
    # in names of the model, not of its flat graph
    assert '"n -> o".f - sqrt("n -> o".e) has no finite slope by "n -> o".e' in refused.value.why


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(
    "law", ["2e-6*sqrt(e)", "(1 + y)*2e-6*sign(e)*sqrt(abs(e))", "3e-6*sign(e)*abs(e)^0.5"]
)
def test_an_orifice_behind_a_valve_that_is_shut_has_a_slope(law: str, back: bool) -> None:
    """Nothing flows whatever the pressures do: the tank empties by its leak, the drop stays 0."""
    if back:
        law = f"-({law})".replace("(e)", "(-e)").replace("sign(e)*abs(e)", "sign(-e)*abs(-e)")
    m = hb.Model("tap", domain="hydraulic")
    m.add(tank=hb.C("1e-6 m^3/Pa", e="2 bar"), n=hb.Zero(), v=hb.One(), o=hb.R({"f": law}))
    m.add(out=hb.Se("0 Pa"), leak=hb.R("1e9 Pa*s/m^3"))
    m.bond("n -> tank", "n -> v -> out", "o -> v" if back else "v -> o", "n -> leak")
    m.signal(y=hb.Integral("-y/(5 s)", start=1.0))
    m.machine("tap", states={"shut": [], "open": ["v"]}, start="shut")
    lin = hb.linearise(m, inputs=[], outputs=["n.e", "o.e", "o.f", "y"])
    poles = [-1e-3, -0.2] if "y" in law else [-1e-3]
    assert np.sort(lin.poles())[-1] == pytest.approx(-1e-3, rel=1e-12)
    assert set(np.round(lin.poles(), 12)) >= set(poles)
    # neither the tank nor the signal moves what is at the orifice
    assert not lin.C[1:3].any()


def test_an_orifice_that_a_junction_at_rest_feeds_is_refused() -> None:
    """Its drop is zero but may move: there a root holds levels together, or has no value."""
    m = hb.Model("level", domain="hydraulic")
    m.add(a=hb.C("1e-6 m^3/Pa", e="2 bar"), b=hb.C("1e-6 m^3/Pa", e="2 bar"), j=hb.One())
    m.add(na=hb.Zero(), nb=hb.Zero(), o=hb.R({"f": "2e-6*sign(e)*sqrt(abs(e))"}))
    m.bond("na -> a", "na -> j -> nb -> b", "j -> o")
    with pytest.raises(HybondError, match="HB-A506"):
        hb.linearise(m)


def ball() -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se("-10 N"), v=hb.One(), ball=hb.I("1 kg"), drag=hb.R("0.5 N*s/m"))
    m.add(contact=hb.Zero(), floor=hb.Sf("-0.4*pre(v.f)"))
    m.bond("weight -> v -> ball", "v -> drag", "contact -> v", "floor -> contact")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    m.machine(
        "impact",
        states={"away": [], "hits": ["contact"]},
        start="away",
        rules=["away -> hits when height <= 0 and v.f < 0", "hits -> away when pre(v.f) >= 0"],
    )
    return m


def test_a_law_of_impacts_says_nothing_in_flight_and_holds_at_rest() -> None:
    run = hb.simulate(ball(), until="6 s")
    flight, rest = hb.linearise(run, inputs=["weight"], outputs=["v.f"], at=[0.2, 6.0])
    # m v' = F - d v, and the height follows
    assert flight.mode["impact"] == "away"
    assert flight.poles().tolist() == pytest.approx([-0.5, 0.0], rel=1e-12)
    assert flight.transfer(2.0)[0, 0] == pytest.approx(1 / 2.5, rel=1e-12)
    # landed: the velocity is zero whatever the weight
    assert run.accumulations and rest.mode["impact"] == "hits"
    assert "ball.p" not in rest.states and rest.transfer(2.0)[0, 0] == pytest.approx(0.0, abs=1e-12)
    # and a state that lasts no time has no motion
    with pytest.raises(HybondError, match="left at once") as refused:
        hb.linearise(ball(), at={"ball.p": -1.0, "height": 0.0}, mode={"impact": "hits"})
    assert refused.value.code == "HB-A507"


def test_a_run_by_time_stepping() -> None:
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se("10 V"), d=hb.One(law="diode"), rs=hb.R("2 ohm"), n=hb.Zero())
    m.add(c=hb.C("0.5 F", q="1 C"), r=hb.R("8 ohm"))
    m.bond("V -> d -> n", "d -> rs", "n -> c", "n -> r")
    run = hb.simulate(m, until="1 s", solver="moreau-jean", step="1 ms")
    lin = hb.linearise(run, inputs=["V"], outputs=["n.e"], at=0.5)
    assert lin.poles() == pytest.approx([-(1 / 2 + 1 / 8) / 0.5], rel=1e-12)
    assert lin.B[0, 0] == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("bulk", [1e6, 1e9, 2e10])
def test_a_piston_on_fluid_that_is_hardly_compressible_is_determined(
    bulk: float, back: bool
) -> None:
    """1e13 Pa/m^3 beside 1e-3 m^2: its closed chamber is a spring of ``area^2*bulk/V``."""
    m = hb.Model("press", domain="hydraulic", parameters={"B": bulk, "D": 1e-5, "A": 1e-3})
    laws = ["B*(q1 - q2 - D)/(D + q2)", "-B*(q1 - q2 - D)*(q1 + q2 + D)/(2*(D + q2)^2)"]
    m.add(pump=hb.Sf("0 m^3/s"), a=hb.Zero(), fluid=hb.C({"e": laws}, q=[1.1e-4, 1e-4]))
    m.add(p=hb.TF("1/A" if back else "A"), rod=hb.One(domain="translational"))
    m.add(mass=hb.I("3 kg", domain="translational"), d=hb.R("100 N*s/m", domain="translational"))
    if back:
        m.bond("fluid.1 -> a", "a -> pump", "fluid.2 -> p -> rod", "mass -> rod", "d -> rod")
    else:
        m.bond("pump -> a -> fluid.1", "rod -> p -> fluid.2", "rod -> mass", "rod -> d")
    lin = hb.linearise(m, inputs=["pump"], outputs=["a.e", "rod.f"])
    poles = np.sort_complex([*np.roots([3.0, 100.0, 1e-6 * bulk / 1.1e-4]), 0.0])
    assert np.sort_complex(lin.poles()) == pytest.approx(poles, rel=1e-6, abs=1e-9)


def test_a_cylinder_of_the_library_is_determined() -> None:
    m = hb.Model("cylinder", domain="hydraulic")
    m.add(c=hb.Submodel("hydraulic.cylinder", x_0="0.1 m"), s=hb.Sf(0), t=hb.Sf(0))
    m.add(rod=hb.Submodel("translational.mass", m="8 kg"))
    m.bond("s -> c.a", "t -> c.b", "c.rod -> rod.flange")
    lin = hb.linearise(m, outputs=["rod.speed"])
    k = 1.4e9 * (1e-3**2 / (20e-6 + 1e-3 * 0.1) + 6e-4**2 / (20e-6 + 6e-4 * 0.2))
    assert max(lin.poles().imag) == pytest.approx(np.sqrt(k / 8.0), rel=1e-6)


def cart(*, back: bool) -> hb.Model:
    """A cart with friction carries a pendulum, whose angle counts from the top."""
    m = hb.Model("cart", domain="translational", parameters={"L": "0.5 m", "g": "9.81 m/s^2"})
    m.add(cart=hb.I("1 kg"), bx=hb.I("0.3 kg"), by=hb.I("0.3 kg"), weight=hb.Se("-0.3*g"))
    m.add(v=hb.One(), x=hb.One(), y=hb.One(), s=hb.Zero(), d=hb.R("0.5 N*s/m"))
    m.add(w=hb.One(domain="rotational"), tx=hb.TF("L*cos(th)"), ty=hb.TF("-L*sin(th)"))
    m.signal(th=hb.Integral("w.f", start=3.0))
    m.bond("v -> s -> x", "w -> tx -> s", "w -> ty -> y", "weight -> y")
    ends = [("v", "cart"), ("v", "d"), ("x", "bx"), ("y", "by")]
    m.bond(*(f"{b} -> {a}" if back else f"{a} -> {b}" for a, b in ends))
    return m


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("angle", [1e-17, 1e-13, np.pi, np.pi + 1e-13, np.pi / 2])
def test_a_pendulum_whose_sine_is_rounding_has_its_poles(angle: float, back: bool) -> None:
    """At pi, where it hangs, it was refused; at a quarter turn it had no poles at all."""
    M, m, L, g, d = 1.0, 0.3, 0.5, 9.81, 0.5
    s, c = round(np.sin(angle)), round(np.cos(angle))  # th, w, v at rest; by Newton's laws
    inertia = np.array([[m * L * L, m * L * c], [m * L * c, M + m]])
    a = np.linalg.solve(inertia, [m * g * L * s, 0.0])
    # what turns the inertia with the angle counts where the pendulum starts to fall
    turned = np.array([-m * L * s * a[1], -m * L * s * a[0]])
    by_angle = np.linalg.solve(inertia, np.array([m * g * L * c, 0.0]) - turned)
    by_speed = np.linalg.solve(inertia, [0.0, -d])
    A = np.array([[0.0, 1.0, 0.0], [by_angle[0], 0.0, by_speed[0]], [by_angle[1], 0, by_speed[1]]])
    lin = hb.linearise(cart(back=back), inputs=[], outputs=["th"], at={"th": angle})
    want = np.sort_complex(np.linalg.eigvals(A))
    assert np.sort_complex(lin.poles()) == pytest.approx(want, rel=1e-6, abs=1e-5)


def test_a_pendulum_comes_to_hang_at_its_equilibrium() -> None:
    lin = hb.linearise(cart(back=False), inputs=[], outputs=["th"], at="equilibrium")
    assert lin.operating["th"] == pytest.approx(np.pi, rel=1e-9)
    assert len(lin.poles()) == 3


@pytest.mark.parametrize("back", [False, True])
def test_a_solenoid_rests_where_its_spring_holds_it(back: bool) -> None:
    """Gap and spring are moved by one speed: the rounding of that was told as a change of 0."""
    m = hb.Model("solenoid", domain="electrical", parameters={"L0": "0.1 H", "a": "5 mm"})
    m.add(U=hb.Se("12 V"), R=hb.R("10 ohm"), i=hb.One(), turns=hb.GY(1))
    m.add(n=hb.Zero(domain="magnetic"), v=hb.One(domain="translational"), M=hb.I("50 g"))
    m.add(field=hb.C({"e": ["q1*(1 + q2/a)/L0", "q1^2/(2*L0*a)"]}, q=[0, "4 mm"]))
    m.add(spring=hb.C({"e": "6000 [N/m]*(q - 4 [mm])"}, q="4 mm"), B=hb.R("3 N*s/m"))
    m.bond("U -> i -> R", "i -> turns -> n", "n -> field.1")
    ends = ["field.2", "spring", "M", "B"]
    m.bond(*(f"{end} -> v" if back else f"v -> {end}" for end in ends))
    lin = hb.linearise(m, inputs=["U"], outputs=["field.2.q"], at="equilibrium")
    x = lin.operating["field.2.q"]
    flux = 1.2 * 0.1 / (1 + x / 5e-3)
    assert flux**2 / (2 * 0.1 * 5e-3) == pytest.approx(6000 * (4e-3 - x), rel=1e-8)
    A = np.array(
        [
            [-10 * (1 + x / 5e-3) / 0.1, -10 * flux / (0.1 * 5e-3), 0.0],
            [0.0, 0.0, 20.0],
            [-flux / (0.1 * 5e-3), -6000.0, -60.0],
        ]
    )
    want = np.sort_complex([*np.linalg.eigvals(A), 0.0])
    assert np.sort_complex(lin.poles()) == pytest.approx(want, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("start", [0.7, -0.2])
def test_a_bead_in_a_parabola_rests_at_its_lowest_point(start: float, back: bool) -> None:
    """Its modulus, the slope 2 s, was 1e-17 there and counted: HB-Q105."""
    m = hb.Model("bead", domain="translational")
    m.add(x=hb.One(), y=hb.One(), mx=hb.I(1.0), my=hb.I(1.0), t=hb.TF("2*s"), g=hb.Se(-9.81))
    m.signal(s=hb.Integral("x.f", start=start))
    m.bond("x -> t -> y", "g -> y", *(["mx -> x", "my -> y"] if back else ["x -> mx", "y -> my"]))
    lin = hb.linearise(m, inputs=[], outputs=["s"], at="equilibrium")
    assert lin.operating["s"] == pytest.approx(0.0, abs=1e-10)
    assert abs(lin.poles().imag) == pytest.approx([np.sqrt(2 * 9.81)] * 2, rel=1e-9)
