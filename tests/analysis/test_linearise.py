"""Linearisations against closed forms and differences of the rates that a run has."""

from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.linear.asked import inputs_of
from hybond.analysis.linear.point import valued
from hybond.engine.outcome.apart import Apart
from hybond.equations.calculus import rate_name
from hybond.equations.linear_rows import linear_rows
from hybond.export.linear.proper import proper
from hybond.result import read_name

EXAMPLES = Path(__file__).parents[2] / "examples"


def rlc() -> hb.Model:
    m = hb.Model("rlc", domain="electrical", parameters={"R": "2 ohm", "Lc": "0.5 H"})
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("R"), l=hb.I("Lc"), c=hb.C("0.1 F"))
    m.bond("V -> i -> r", "l -> i", "i -> c")
    return m


def test_rlc_in_closed_form() -> None:
    lin = hb.linearise(rlc(), inputs=["V.e"], outputs=["c.e", "r.f", "l.e"])
    R, L, C = 2.0, 0.5, 0.1
    assert lin.exact and not lin.kinks and lin.states == ("l.p", "c.q") and lin.inputs == ("V.e",)
    assert (lin.state_units, lin.input_units, lin.output_units) == (
        ("V*s", "C"),
        ("V",),
        ("V", "A", "V"),
    )
    for s in (0.3 + 1.0j, 5.0j, 40.0):
        current = 1.0 / (R + s * L + 1.0 / (s * C))
        # `l` lies against its arrow: its bond has the flow -i and the effort -s L i
        expected = [current / (s * C), current, -s * L * current]
        assert lin.transfer(s)[:, 0] == pytest.approx(expected, rel=1e-12)
    own = np.roots([L * C, R * C, 1.0])
    assert np.sort_complex(lin.poles()) == pytest.approx(np.sort_complex(own), rel=1e-12)
    (pair,) = lin.damping()
    assert pair.frequency == pytest.approx(1 / (2 * np.pi * np.sqrt(L * C)), rel=1e-12)
    assert pair.ratio == pytest.approx(R / 2 * np.sqrt(C / L), rel=1e-12)
    assert lin.zeros(output="r.f") == pytest.approx([0.0], abs=0.0)
    assert len(lin.zeros(output="c.e")) == 0
    assert lin.gain()[:, 0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("name", "mode", "outputs"),
    [
        ("boost", {}, ["out.e"]),
        ("clutch_rigid", {"clutch": "closed"}, ["w1.f", "grip.e"]),
        ("bouncing_ball", {"floor": "touching"}, ["contact.e", "v.f"]),
        ("diagnosis_circuit", {"S2": "on"}, ["n1.e", "in.f"]),
    ],
)
def test_examples_as_their_transfer_functions_in_symbols(
    name: str, mode: dict[str, str], outputs: list[str]
) -> None:
    graph = hb.load(EXAMPLES / f"{name}.toml").flatten()
    start = graph.mode_of(mode)
    point = valued(graph, Apart(graph).signals, 0.0, Apart(graph).start, start)
    t = hb.state_equations(graph, outputs=outputs).transfer(mode)
    asked = inputs_of(graph, graph, t.inputs)
    rows = linear_rows(
        graph,
        start,
        point.values,
        inputs=asked.columns,
        outputs={n: read_name(graph, n) for n in outputs},
    )
    found = proper(rows.E, rows.A, rows.B, rows.stored)
    for at in (0.7 + 0.3j, 12.0j, 400.0 + 90.0j):
        inner = np.linalg.solve(at * np.eye(len(found.A)) - found.A, found.B)
        own = found.basis[rows.outputs] @ inner + found.direct[0][rows.outputs]
        expected = [[t.response(y, u, at) for u in t.inputs] for y in outputs]
        assert own == pytest.approx(np.array(expected), rel=1e-9, abs=1e-15)
    assert rows.straight


def plant() -> hb.Model:
    """Everything that bends: storage, resistors, moduli, sources that read signals, integrals."""
    m = hb.Model("plant")
    m.add(a=hb.One(), L=hb.I({"f": "p + p^3/5"}), ra=hb.R({"e": "2*f + 0.3*f*abs(f)"}))
    m.add(V=hb.Se("u + 0.2*sin(turn)"), gy=hb.GY("1 + 0.5*cos(turn)"))
    m.add(b=hb.One(), J=hb.I(0.7), rb=hb.R({"e": "0.4*tanh(3*f) + 0.1*f"}))
    m.add(tf=hb.TF("exp(-0.3*k.q)"), n=hb.Zero(), k=hb.C({"e": "q + 0.2*q^3"}))
    m.add(leak=hb.R({"f": "e/(2 + e^2)"}))
    m.bond("V -> a -> L", "a -> ra", "a -> gy -> b -> J", "b -> rb", "b -> tf -> n -> k")
    m.bond("n -> leak")
    m.signal(turn=hb.Integral("b.f - 0.1*sin(turn)"))
    m.input(u=0.6)
    return m


def test_the_jacobian_of_a_nonlinear_model_at_random_states() -> None:
    m = plant()
    graph = m.flatten()
    apart = Apart(graph)
    rates = [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]
    names = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
    random = np.random.default_rng(7)
    for _ in range(4):
        y = random.uniform(-1.5, 1.5, len(names))
        lin = hb.linearise(m, inputs=["u"], outputs=["leak.f"], at=dict(zip(names, y.tolist())))
        assert lin.states == tuple(names) and not lin.exact

        def slopes(h: float, y: np.ndarray = y) -> np.ndarray:
            columns = []
            for k in range(len(y)):
                step = np.zeros(len(y))
                step[k] = h
                ahead, behind = (
                    np.array(apart.signals.after(0.0, y + d, (), rates)) for d in (step, -step)
                )
                columns.append((ahead - behind) / (2 * h))
            return np.array(columns).T

        coarse, fine = slopes(2e-2), slopes(1e-2)
        # differences are of second order: half the step, a quarter of the error
        off, less = np.abs(coarse - lin.A).max(), np.abs(fine - lin.A).max()
        assert 3.5 < off / less < 4.5
        assert (4.0 * fine - coarse) / 3.0 == pytest.approx(lin.A, rel=1e-5, abs=1e-5)


def crank() -> hb.Model:
    m = hb.Model("crank", domain="rotational", parameters={"arm": "0.4 m"})
    m.add(w=hb.One(), J=hb.I(0.3), tau=hb.Se("T"), b=hb.R(0.1), tf=hb.TF("arm*(2 + sin(th))"))
    m.add(v=hb.One(domain="translational"), M=hb.I(2.0, domain="translational"))
    m.bond("tau -> w -> J", "w -> b", "w -> tf -> v -> M")
    m.signal(th=hb.Integral("w.f", start=0.7))
    m.input(T="1 N*m")
    return m


def test_a_mass_behind_a_crank_follows_while_both_move() -> None:
    """Storage in derivative causality, its constraint turning with the angle."""
    J, M, a, b, T, th, w = 0.3, 2.0, 0.4, 0.1, 1.0, 0.7, 3.0
    r, r1, r2 = a * (2 + np.sin(th)), a * np.cos(th), -a * np.sin(th)
    lin = hb.linearise(crank(), inputs=["T"], outputs=["w.f"], at={"J.p": J * w, "M.p": M * r * w})
    assert len(lin.states) == 2 and "th" in lin.states
    # (J + M r^2) w' = T - b w - M r r' w^2, in the momentum that was kept
    whole = J + M * r * r
    w1 = (T - b * w - M * r * r1 * w * w) / whole
    w1_w = (-b - 2 * M * r * r1 * w) / whole
    w1_th = (-M * (r1 * r1 + r * r2) * w * w - 2 * M * r * r1 * w1) / whole
    w1_T = 1 / whole
    if lin.states[0] == "J.p":
        A = [[w1_w, J * w1_th], [1 / J, 0.0]]
        B = J * w1_T
    else:
        # p = M r w, so that w = p/(M r) and dw = dp/(M r) - w r'/r dth
        p1_w = M * (r * w1_w + 2 * r1 * w)
        p1_th = M * (r1 * w1 + r * w1_th + r2 * w * w)
        A = [[p1_w / (M * r), p1_th - p1_w * w * r1 / r], [1 / (M * r), -w * r1 / r]]
        B = M * r * w1_T
    assert lin.input_units == ("N*m",)
    np.testing.assert_allclose(lin.A, A, rtol=1e-11, atol=1e-11)
    assert lin.B[:, 0] == pytest.approx([B, 0.0], rel=1e-11)


def test_a_parameter_is_an_input() -> None:
    # R c.q' = V - q/C: the current falls by V/R^2 for each ohm more, at the start
    m = hb.Model("rc", domain="electrical", parameters={"R": "2 ohm", "V0": "6 V"})
    m.add(V=hb.Se("2*V0"), j=hb.One(), r=hb.R("R"), c=hb.C("1 F", q="3 C"))
    m.bond("V -> j -> r", "j -> c")
    lin = hb.linearise(m, inputs=["R", "V0", "V"], outputs=["r.f"])
    current = (12.0 - 3.0) / 2.0
    assert lin.D[0] == pytest.approx([-current / 2.0, 2.0 / 2.0, 1.0 / 2.0], rel=1e-12)
    assert lin.B[0] == pytest.approx([-current / 2.0, 1.0, 0.5], rel=1e-12)
    assert lin.input_units[1:] == ("V", "V")
    assert lin.operating["R"] == 2.0 and lin.operating["V"] == 12.0


@pytest.mark.parametrize(("kind", "value"), [("storage", "C"), ("modulus", "n")])
def test_parameters_of_storage_and_moduli(kind: str, value: str) -> None:
    m = hb.Model("net", domain="electrical", parameters={"C": "2 F", "n": 3.0})
    m.add(V=hb.Se("12 V"), j=hb.One(), r=hb.R("4 ohm"), tf=hb.TF("n"), k=hb.Zero())
    m.add(c=hb.C("C", q="1 C"), g=hb.R("1 ohm"))
    m.bond("V -> j -> r", "j -> tf -> k -> c", "k -> g")
    lin = hb.linearise(m, inputs=[value], outputs=["r.f"])
    # q' = n i - q/(C g), i = (V - n q/C)/r
    V, r, n, C, q = 12.0, 4.0, 3.0, 2.0, 1.0
    i = (V - n * q / C) / r
    if kind == "storage":
        expected = [n * n * q / (C * C * r) + q / (C * C), n * q / (C * C * r)]
    else:
        expected = [i - n * q / (C * r), -q / (C * r)]
    assert [lin.B[0, 0], lin.D[0, 0]] == pytest.approx(expected, rel=1e-12)


def test_kinks_at_the_point_are_named() -> None:
    m = hb.Model("slider", domain="translational")
    m.add(v=hb.One(), m=hb.I("2 kg"), drag=hb.R({"e": "3 [N*s^2/m^2]*f*abs(f) + 1 [N*s/m]*f"}))
    m.bond("v -> m", "v -> drag")
    rest = hb.linearise(m, inputs=[], outputs=["v.f"])
    (kink,) = rest.kinks
    assert kink.startswith("drag: ")
    assert rest.A[0, 0] == pytest.approx(-0.5, rel=1e-12)
    moving = hb.linearise(m, inputs=[], outputs=["v.f"], at={"m.p": "4 kg*m/s"})
    assert not moving.kinks
    assert moving.A[0, 0] == pytest.approx(-(1 + 2 * 3 * 2.0) / 2.0, rel=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_a_law_of_a_junction_in_its_branch(turned: bool) -> None:
    """A diode conducts or blocks: the linearisation is that of the branch which holds."""
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se("10 V"), d=hb.One(law="diode"), rs=hb.R("2 ohm"), n=hb.Zero())
    m.add(c=hb.C("0.5 F", q="1 C"), r=hb.R("8 ohm"))
    m.bond("V -> d -> n", "rs -> d" if turned else "d -> rs", "n -> c", "n -> r")
    on = hb.linearise(m, inputs=["V"], outputs=["n.e"])
    off = hb.linearise(m, inputs=["V"], outputs=["n.e"], at={"c.q": 7.0})
    assert on.poles() == pytest.approx([-(1 / 2 + 1 / 8) / 0.5], rel=1e-12)
    assert off.poles() == pytest.approx([-1 / (8 * 0.5)], rel=1e-12)
    assert on.B[0, 0] == pytest.approx(0.5, rel=1e-12) and off.B[0, 0] == 0.0
    assert on.mode != off.mode
