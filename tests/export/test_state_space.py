"""Linear modes as state space: against closed forms, and the transfer functions in symbols."""

import builtins
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.errors import EquationError, UsageError
from hybond.export.linear.state_space import StateSpace, state_space

EXAMPLES = Path(__file__).parents[2] / "examples"


def response(s: StateSpace, at: complex) -> np.ndarray:
    n = len(s.A)
    return s.C @ np.linalg.solve(at * np.eye(n) - s.A, s.B) + s.D


def rlc(*, turned: bool = False) -> hb.Model:
    m = hb.Model("rlc", domain="electrical", parameters={"R": "2 ohm", "L": "0.5 H", "C": "0.1 F"})
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("R"), l=hb.I("L"), c=hb.C("C"))
    m.bond(
        *(
            ("V -> i", "r -> i", "l -> i", "c -> i")
            if turned
            else ("V -> i -> r", "i -> l", "i -> c")
        )
    )
    return m


@pytest.mark.parametrize("turned", [False, True])
def test_rlc_in_closed_form(turned: bool) -> None:
    s = state_space(rlc(turned=turned), ["c.e", "r.f", "i.f"])
    R, L, C = 2.0, 0.5, 0.1
    for at in (0.3 + 1.0j, 5.0j, 40.0):
        current = 1.0 / (R + at * L + 1.0 / (at * C))
        sign = -1.0 if turned else 1.0  # power into the element, against its arrow
        expected = [sign * current / (at * C), current, current]
        assert response(s, at)[:, 0] == pytest.approx(expected, rel=1e-13)


def motor() -> hb.Model:
    m = hb.Model("motor", domain="electrical")
    m.add(supply=hb.Se("u"), i=hb.One(), R=hb.R("1 ohm"), L=hb.I("2 mH"), k=hb.GY("0.1 N*m/A"))
    m.add(w=hb.One(domain="rotational"), J=hb.I("1e-3 kg*m^2", domain="rotational"))
    m.add(b=hb.R("1e-4 N*m*s", domain="rotational"), load=hb.Se("-T", domain="rotational"))
    m.bond("supply -> i -> R", "i -> L", "i -> k -> w -> J", "w -> b", "load -> w")
    m.input(u="24 V", T=hb.Input(table=[["0 s", "0 N*m"], ["1 s", "0.1 N*m"]]))
    m.signal(angle=hb.Integral("w.f"))
    return m


def test_dc_motor_in_closed_form_with_named_inputs() -> None:
    s = state_space(motor(), ["w.f", "angle"])
    assert s.inputs == ("u", "T") and s.states == ("L.p", "J.p", "angle")
    R, L, k, J, b = 1.0, 2e-3, 0.1, 1e-3, 1e-4
    for at in (1.0j, 30.0 + 5.0j, 700.0j):
        bottom = (R + at * L) * (b + at * J) + k * k
        speed = np.array([k / bottom, -(R + at * L) / bottom])
        assert response(s, at)[0] == pytest.approx(speed, rel=1e-12)
        assert response(s, at)[1] == pytest.approx(speed / at, rel=1e-12)


def test_a_control_loop_is_closed() -> None:
    m = rlc()
    m.elements["V"] = hb.Se("set - 3*c.e + err")
    m.input(set="1 V")
    m.signal(err=hb.Integral("2 [1/s]*(set - c.e)"))
    s = state_space(m, ["c.e"])
    assert s.inputs == ("set",)
    R, L, C = 2.0, 0.5, 0.1
    for at in (0.2 + 1.0j, 8.0j):
        plant = 1.0 / (at * at * L * C + at * R * C + 1.0)
        expected = plant * (1.0 + 2.0 / at) / (1.0 + plant * (3.0 + 2.0 / at))
        assert response(s, at)[0, 0] == pytest.approx(expected, rel=1e-12)


def buck(duty: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the averaged matrices of a buck converter from its two modes."""
    m = hb.Model("buck", domain="electrical")
    m.add(V=hb.Se("12 V"), up=hb.One(), low=hb.One(), out=hb.Zero(), i=hb.One(), node=hb.Zero())
    m.add(zero=hb.Se("0 V"), L=hb.I("1 mH"), C=hb.C("10 uF"), R=hb.R("5 ohm"))
    m.bond("V -> up -> out", "zero -> low -> out", "out -> i -> L", "i -> node -> C", "node -> R")
    m.machine("leg", states={"high": ["up"], "low": ["low"]}, start="high")
    on = state_space(m, ["node.e"], inputs=["V"])
    off = state_space(m, ["node.e"], inputs=["V"], mode={"leg": "low"})
    assert on.states == off.states == ("L.p", "C.q") and off.mode == {"leg": "low"}
    return duty * on.A + (1 - duty) * off.A, duty * on.B + (1 - duty) * off.B


def test_buck_converter_averaged_over_its_modes() -> None:
    a, b = buck(0.4)
    L, C, R = 1e-3, 1e-5, 5.0
    assert a == pytest.approx(np.array([[0.0, -1 / C], [1 / L, -1 / (R * C)]]), rel=1e-13)
    assert b == pytest.approx(np.array([[0.4], [0.0]]), rel=1e-13)
    rest = np.linalg.solve(a, -b * 12.0)
    assert rest[1, 0] / C == pytest.approx(0.4 * 12.0, rel=1e-12)


def test_tied_storage_is_one_state() -> None:
    m = hb.Model("shafts")
    m.add(
        M=hb.Se(1), w=hb.One(), a=hb.I(2), b=hb.I(3), tf=hb.TF(4), v=hb.One(), c=hb.I(5), r=hb.R(7)
    )
    m.bond("M -> w -> a", "w -> b", "w -> tf -> v -> c", "v -> r")
    s = state_space(m, ["w.f", "v.f", "b.e"])
    assert len(s.states) == 1
    inertia, drag = 2 + 3 + 5 * 16, 7 * 16  # f2 = m f1
    for at in (0.1j, 2.0 + 1.0j):
        speed = 1.0 / (at * inertia + drag)
        assert response(s, at)[:, 0] == pytest.approx([speed, 4 * speed, 3 * at * speed], rel=1e-12)


def chain() -> hb.Model:
    """A source across two capacitors in series, one of them with a leak."""
    m = hb.Model("chain")
    m.add(V=hb.Se(1), i=hb.One(), a=hb.C(1), n=hb.Zero(), b=hb.C(2), r=hb.R(3))
    m.bond("V -> i -> a", "i -> n -> b", "n -> r")
    return m


def test_a_source_that_sets_storage_at_once_goes_through_d() -> None:
    s = state_space(chain(), ["n.e", "a.e"])
    assert s.D.any() and len(s.states) == 1
    for at in (0.1j, 2.0 + 1.0j):
        above, below = 1.0 / at, 1.0 / (2.0 * at + 1.0 / 3.0)
        part = below / (above + below)
        assert response(s, at)[:, 0] == pytest.approx([part, 1.0 - part], rel=1e-12)


def test_the_derivative_of_an_input_is_refused() -> None:
    with pytest.raises(EquationError) as refused:
        state_space(chain(), ["i.f"])
    assert refused.value.code == "HB-E672" and "derivative of V" in str(refused.value)


@pytest.mark.parametrize(
    ("name", "mode", "outputs"),
    [
        ("clutch_rigid", {"clutch": "closed"}, ["w1.f", "grip.e", "i.f"]),
        ("clutch_rigid", {"clutch": "open"}, ["w1.f", "w2.f"]),
        ("clutch", {"clutch": "closed"}, ["w1.f", "torque.e"]),
        ("bouncing_ball", {"floor": "touching"}, ["contact.e", "v.f"]),
        ("diagnosis_circuit", {"S2": "on"}, ["n1.e", "in.f"]),
        ("half_bridge", {"leg": "low"}, ["L.f"]),
    ],
)
def test_examples_agree_with_transfer_functions(
    name: str, mode: dict[str, str], outputs: list[str]
) -> None:
    model = hb.load(EXAMPLES / f"{name}.toml")
    s = state_space(model, outputs, mode=mode)
    t = hb.state_equations(model, outputs=outputs).transfer(mode)
    for at in (0.7 + 0.3j, 12.0j, 400.0 + 90.0j):
        expected = [[t.response(y, u, at) for u in s.inputs] for y in outputs]
        assert response(s, at) == pytest.approx(np.array(expected), rel=1e-9, abs=1e-15)


def test_scipy_and_control_objects_say_the_same() -> None:
    control = pytest.importorskip("control")
    s = state_space(motor(), ["w.f", "L.f"])
    ours = s.control()
    assert ours.input_labels == ["u", "T"] and ours.output_labels == ["w_f", "L_f"]
    assert ours.state_labels == ["L_p", "J_p", "angle"]
    at = 20.0j
    assert control.evalfr(ours, at) == pytest.approx(response(s, at), rel=1e-12)
    theirs = s.scipy()
    assert [m.shape for m in (theirs.A, theirs.B, theirs.C, theirs.D)] == [
        (3, 3),
        (3, 2),
        (2, 3),
        (2, 2),
    ]
    _, step = control.step_response(ours, np.linspace(0, 3, 400), output=0, input=0, squeeze=True)
    assert step[-1] == pytest.approx(0.1 / (1e-4 + 0.01), rel=1e-6)


def test_without_python_control_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def missing(name: str, *rest: object, **more: object) -> object:
        if name == "control":
            raise ImportError(name)
        return real(name, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(UsageError) as refused:
        state_space(rlc()).control()
    assert refused.value.code == "HB-E674"


def test_what_is_not_linear_is_refused() -> None:
    m = rlc()
    m.elements["V"] = hb.Se("c.e*c.e*1 [1/V]")
    with pytest.raises(EquationError) as refused:
        state_space(m)
    assert refused.value.code in ("HB-E671", "HB-Q103")
    m.elements["V"] = hb.Se("1 V")
    with pytest.raises(EquationError) as refused:
        state_space(m, ["c.e*c.e"])
    assert refused.value.code == "HB-E671"
    m.elements["r"] = hb.R({"e": "2 [ohm/A^2]*f^3"})
    with pytest.raises(EquationError) as refused:
        state_space(m)
    assert refused.value.code == "HB-Q103"
    with pytest.raises(UsageError) as wrong:
        state_space(rlc(), inputs=["v"])
    assert wrong.value.code == "HB-E673" and "V" in wrong.value.hint


def test_a_floating_node_is_refused() -> None:
    model = hb.load(EXAMPLES / "half_bridge.toml")
    model.machines["leg"] = model.machines["leg"].__class__(
        {"high": ("upper",), "low": ("lower",), "both": ("upper", "lower")}, "high", ()
    )
    with pytest.raises(EquationError) as refused:
        state_space(model, ["L.f"], mode={"leg": "both"})
    assert refused.value.code == "HB-Q105"


def test_a_sampled_signal_has_no_matrices() -> None:
    m = hb.Model("controlled")
    m.add(V=hb.Se("u"), j=hb.One(), r=hb.R(2), c=hb.C(1))
    m.bond("V -> j -> r", "j -> c")
    m.signal(u=hb.Sampled("1 - c.e", every="0.1 s"))
    with pytest.raises(hb.EquationError) as caught:
        hb.state_space(m, ["c.e"])
    assert caught.value.code == "HB-E671"


def test_a_source_that_follows_the_time_as_well() -> None:
    """What is driven by the time is what is driven from outside; the rest is in the loop."""
    m = rlc()
    m.elements["V"] = hb.Se(
        "set - 3*c.e + 2 [V]*sin(time/(1 s)) + (if time > 1 then 1 else 0)*1 [V]"
    )
    m.input(set="1 V")
    s = state_space(m, ["c.e"], inputs=["set", "V"])
    R, L, C = 2.0, 0.5, 0.1
    expected = 1.0 / (4j * 4j * L * C + 4j * R * C + 4.0)
    assert response(s, 4j)[0] == pytest.approx([expected, expected], rel=1e-12)
    # but time must not multiply what it is added to
    m.elements["V"] = hb.Se("set*(time/(1 s))")
    with pytest.raises(EquationError) as refused:
        state_space(m, ["c.e"])
    assert refused.value.code == "HB-E671" and "linearise" in refused.value.hint
