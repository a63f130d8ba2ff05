"""What begins at rest, at zero or with nothing to say: it runs, and it is right.

Oracles: closed forms, what is conserved, a solver of SciPy.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

# -- laws of junctions without bonds ---------------------------------------------------------------

ALONE = {
    "diode": hb.One(law="diode"),
    "dual diode": hb.Zero(law="diode"),
    "friction": hb.One(law="coulomb", limit=1.0),
    "relay": hb.Zero(law="relay", limit=1.0),
    "contact": hb.Zero(law="unilateral", restitution=0.5),
}


@pytest.mark.parametrize("solver", ["auto", "rk45", "moreau-jean"])
@pytest.mark.parametrize("name", ALONE)
def test_a_law_that_joins_nothing_changes_nothing(name: str, solver: str) -> None:
    """A capacitor discharges beside it."""
    m = hb.Model("beside")
    m.add(c=hb.C(1.0, q=0.5), r=hb.R(1.0), n=hb.Zero(), j=ALONE[name])
    m.bond("n -> c", "n -> r")
    step = {"step": 1e-4} if solver == "moreau-jean" else {}
    run = hb.simulate(m, 1.0, solver=solver, **step)
    assert run.status == "ok"
    assert run.final["c.q"] == pytest.approx(0.5 * math.exp(-1.0), rel=1e-7)


# -- laws that are steep, near zero ----------------------------------------------------------------

STEEP = {
    "exponentials against each other": (
        "1e-6*(exp(e/0.04) - 1)",
        "1e-6*(1 - exp(-e/0.04))",
        lambda u: 1e-6 * math.expm1(u / 0.04) + 1e-6 * -math.expm1(-u / 0.04),
    ),
    "hyperbolic sine": (
        "1e-6*sinh(e/0.03)",
        "1e-9*e",
        lambda u: 1e-6 * math.sinh(u / 0.03) + 1e-9 * u,
    ),
    "ninth power": ("(e/1)^9", "1e-7*e", lambda u: u**9 + 1e-7 * u),
    "beyond a threshold": (
        "0.1*(max(e - 0.6, 0) + min(e + 0.6, 0))",
        "1e-8*e",
        lambda u: 0.1 * (max(u - 0.6, 0.0) + min(u + 0.6, 0.0)) + 1e-8 * u,
    ),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("case", STEEP)
def test_steep_laws_are_followed_through_zero(case: str, solver: str) -> None:
    """A source that swings from zero through a resistor: the root of the sum at each time."""
    one, other, current = STEEP[case]
    m = hb.Model("clamp", domain="electrical")
    m.add(u=hb.Se("1 V*sin(6.28*time/(1 s))"), i=hb.One(), rv=hb.R("2 kohm"), n=hb.Zero())
    m.add(d=hb.R({"f": one}), e=hb.R({"f": other}), c=hb.C("1 nF"))
    m.bond("u -> i -> n", "i -> rv", "n -> d", "n -> e", "n -> c")
    run = hb.simulate(m, 1.0, solver=solver, rtol=1e-9)
    for t in np.linspace(0.05, 1.0, 20):
        u = math.sin(6.28 * t)
        root = brentq(lambda x, u=u: (u - x) / 2000.0 - current(x), -1.1, 1.1, xtol=1e-14)
        assert run["n.e"].at(t) == pytest.approx(root, abs=5e-5)


# -- what is shared, and what the shares add up to -------------------------------------------------


@pytest.mark.parametrize("many", [2, 3, 5])
@pytest.mark.parametrize("rate", [1.0, 0.3])
def test_the_sum_of_open_shares_is_determined_at_its_crossing(many: int, rate: float) -> None:
    """A cosine through parallel bonds: a junction that lets go where its flow is zero."""
    m = hb.Model("parallel")
    m.add(V=hb.Se(f"1*cos({rate}*time/(1 [s]))"), R=hb.R(1.0), C=hb.C(0.3), d=hb.One())
    m.add(x=hb.One(), n=hb.Zero(), R2=hb.R(7.0))
    m.bond("V -> d -> R", *(f"b{k}: d -> x" for k in range(many)), "x -> n -> C", "n -> R2")
    rules = ["off -> on when d.e > 0", "on -> off when d.f < 0"]
    m.machine("D", states={"off": [], "on": ["d"]}, start="on", rules=rules)
    run = hb.simulate(m, 3.0 / rate)

    # the same circuit with one bond, whose shares are its own
    def fall(t: float, q: list[float]) -> list[float]:
        return [math.cos(rate * t) - many * q[0] / 0.3 / many - q[0] / 0.3 / 7.0]

    found = solve_ivp(
        fall,
        (0.0, 3.0 / rate),
        [0.0],
        rtol=1e-10,
        atol=1e-12,
        events=lambda t, q: math.cos(rate * t) - q[0] / 0.3,
    )
    off = next(t for t in found.t_events[0] if t > 1e-6)
    assert run.events[1].t == pytest.approx(off, rel=1e-6)


JUMPS = {
    "capacitors": ({"a": hb.C(1.0, q=1.0), "b": hb.C(1.0), "k": hb.One(), "na": hb.Zero()},
                   ["na -> a", "na -> k -> b"]),
    "masses": ({"a": hb.I(1.0, p=1.0), "b": hb.I(2.0), "k": hb.Zero(), "na": hb.One()},
               ["na -> a", "na -> k -> b"]),
    "a coil at a load": ({"a": hb.I(1.0, p=1.0), "k": hb.Zero(), "na": hb.One(), "b": hb.R(1.0)},
                         ["na -> a", "na -> k -> b"]),
    "nothing": ({"k": hb.One()}, []),
}  # fmt: skip


@pytest.mark.parametrize("jump", JUMPS)
def test_a_guard_on_an_open_value_is_refused_whatever_jumps_beside_it(jump: str) -> None:
    parts, bonds = JUMPS[jump]
    m = hb.Model("bypassed")
    m.add(V=hb.Se(5.0), s1=hb.One(), s2=hb.One(), n=hb.Zero(), R=hb.R(1.0), **parts)
    m.bond("V -> s1 -> n -> s2 -> R", *bonds)
    m.machine("A", states={"closed": ["s1", "s2"], "open": []}, start="closed",
              rules=["closed -> open when time >= 0.5"])  # fmt: skip
    m.machine(
        "K", states={"off": [], "on": ["k"]}, start="off", rules=["off -> on when time >= 0.5"]
    )
    m.machine("probe", states={"a": [], "b": []}, start="a", rules=["a -> b when n.e < 4"])
    with pytest.raises(hb.HybondError, match="HB-J102"):
        hb.simulate(m, 1.0)


# -- dust that a rule turns round on ---------------------------------------------------------------


@pytest.mark.parametrize("momenta", [(1.4, 1.6, -1.9, -1.8), (0.1, 0.2, -0.3), (1.1, -2.2, 0.7)])
@pytest.mark.parametrize("charges", [(0.0, 0.0), (0.3, 0.1)])
def test_tied_masses_make_no_dust_for_a_diode_written_by_hand(
    momenta: tuple[float, ...], charges: tuple[float, float]
) -> None:
    """A coil meets two capacitors that are tied: nothing turns back at the instant it begins."""
    m = hb.Model("tied")
    m.add(**{f"a{k}": hb.I(1.0 + k, p=p) for k, p in enumerate(momenta)}, v=hb.One())
    m.bond(*(f"v -> a{k}" for k in range(len(momenta))))
    m.add(L=hb.I(1.0, p=-2.0), Ca=hb.C(2.0, q=charges[0]), Cb=hb.C(1.0, q=charges[1]), n=hb.Zero())
    m.bond("n -> L", "n -> Ca", "n -> Cb")
    rules = ["off -> on when n.f > 0", "on -> off when n.e < 0"]
    m.machine("m", states={"off": [], "on": ["n"]}, start="off", rules=rules)
    run = hb.simulate(m, 1.0)
    assert run.status == "ok" and run.mode["m"] == "on"
    # charge is shared at the start, then swings with the coil: L i' = u, 3 u' = -i
    w, u = 1.0 / math.sqrt(3.0), sum(charges) / 3.0
    flow = -2.0 * math.cos(w) + u / w * math.sin(w)
    assert run["L.f"].at(1.0) == pytest.approx(flow, rel=1e-7)
    total = sum(momenta) / sum(1.0 + k for k in range(len(momenta)))
    assert run["a0.f"].at(1.0) == pytest.approx(total, rel=1e-12, abs=1e-15)


# -- gears from rest -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "torque", ["50", "50*(1 + 0*time/(1 [s]))", "if time < 9 [s] then 50 else 0"]
)
@pytest.mark.parametrize("ratio", [2.0, 3.0, 0.7])
def test_a_planetary_gear_starts_from_rest(ratio: float, torque: str) -> None:
    """The ring is held: the engine drives the carrier, ``w_sun = (1 + z) w_carrier``."""
    m = hb.Model("gear", domain="rotational")
    m.add(T=hb.Se(torque), sun=hb.I(0.2), s=hb.One(), car=hb.I(5.0), c=hb.One(), held=hb.Sf(0.0))
    m.add(g=hb.Submodel("rotational.planetary_gear", ratio=ratio))
    m.bond("T -> s -> sun", "s -> g.sun", "g.carrier -> c -> car", "held -> g.ring")
    run = hb.simulate(m, 4.0)
    speed = 50.0 * 4.0 / (0.2 + 5.0 / (1.0 + ratio) ** 2)
    assert run.status == "ok" and run["s.f"].at(4.0) == pytest.approx(speed, rel=1e-8)


# -- a block by hand at rest -----------------------------------------------------------------------


@pytest.mark.parametrize("mass", [1.0, 1e-3, 70.0])
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_a_body_that_a_machine_holds_breaks_loose_at_its_limit(mass: float, solver: str) -> None:
    """A spring that is drawn at 0.1 m/s: nothing has any energy when it begins."""
    m = hb.Model("by hand", domain="translational")
    m.add(pull=hb.Sf(0.1), spring=hb.C(0.5), n=hb.Zero(), v=hb.One(), body=hb.I(mass))
    m.add(grip=hb.Zero(), hold=hb.Sf(0.0))
    m.bond("pull -> n -> spring", "n -> v -> body", "v -> grip", "hold -> grip")
    m.machine(
        "face",
        states={"sticks": ["grip"], "slides": []},
        start="sticks",
        rules=["sticks -> slides when abs(grip.e) > 1.5"],
    )
    run = hb.simulate(m, 7.6, solver=solver)
    assert [e.t for e in run.events][1:] == pytest.approx([7.5], rel=1e-9)
    assert run["body.f"].at(7.0) == 0.0 and run.audit().holds()
    # from there the spring, of 2 N/m, swings about the speed of its end
    w, t = math.sqrt(2.0 / mass), 0.1
    speed = 0.1 * (1.0 - math.cos(w * t)) + 1.5 / (mass * w) * math.sin(w * t)
    assert run["body.f"].at(7.6) == pytest.approx(speed, rel=1e-5, abs=1e-6)


# -- quantised states beside the audit of steps ----------------------------------------------------


@pytest.mark.parametrize("solver", ["qss1", "qss2", "qss3", "liqss1", "liqss2"])
@pytest.mark.parametrize("load", [0.5, 2.0, 20.0])
def test_the_audit_holds_at_the_tolerance_of_the_quanta(solver: str, load: float) -> None:
    m = hb.Model("swing")
    m.add(u=hb.Se(1.0), w=hb.One(), L=hb.I(0.3, p=0.1), R=hb.R(load), C=hb.C(0.7, q=0.2))
    m.bond("u -> w -> L", "w -> R", "w -> C")
    rtol = 1e-3 if solver.endswith("1") else 1e-5
    run = hb.simulate(m, 2.0, solver=solver, rtol=rtol)
    audit = run.audit()
    assert audit.holds(rtol) and not audit.laws


# -- moduli and laws that are not finite -----------------------------------------------------------


@pytest.mark.parametrize(
    "part",
    [
        {"t": hb.TF("1/sqrt(0.5 - time/(1 [s]))")},
        {"t": hb.TF("log(0.5 - time/(1 [s]))")},
        {"t": hb.GY("sqrt(0.5 - time/(1 [s]))")},
    ],
)
def test_a_modulus_without_a_value_is_refused_and_the_run_handed_back(part: dict) -> None:
    m = hb.Model("modulus")
    m.add(a=hb.C(1.0, q=1.0), n=hb.Zero(), i=hb.One(), r=hb.R(1.0), **part)
    m.bond("n -> a", "n -> t.1", "t.2 -> i -> r")
    run = hb.simulate(m, 1.0, on_error="return", solver="rk45")
    assert run.status == "error" and run.error is not None
    assert run.error.code.startswith("HB-N3") and run.t_end <= 0.5 + 1e-9


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_spring_that_comes_to_the_edge_of_what_a_sign_gives(solver):
    # the flow dies away and never is zero; in the last digits of the charge it was on either side
    # of zero, where the sign gives too much, and from 60 time constants on there was no solution
    # (HB-N301); implicit steps foresaw it there, and crept on until there was none
    c, q0, limit = 1e-3, 0.02, 0.04
    m = hb.Model("sign")
    m.add(j=hb.One(), c=hb.C(c, q=q0), r=hb.R(1.0), s=hb.R({"e": f"{limit}*sign(f)"}))
    m.bond("c -> j", "j -> r", "j -> s")
    run = hb.simulate(m, 0.1, solver=solver)
    t = np.linspace(0.0, 0.1, 101)
    values = run.sample(t.tolist(), ["c.q", "s.e", "r.f"])
    fades = np.exp(-t / c)
    assert values["c.q"] == pytest.approx(limit * c + (q0 - limit * c) * fades, rel=1e-6)
    assert values["s.e"] == pytest.approx(limit)
    assert values["r.f"] == pytest.approx((q0 / c - limit) * fades, abs=1e-6)
    assert run.audit().holds()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", ["mass", "driven", "driven, arrows turned", "behind a gyrator"])
@pytest.mark.slow
def test_implicit_steps_to_the_edge_of_what_a_sign_gives(kind):
    # what is left for the storage once a sign has taken its own part; from 25 time constants on
    # the stages of steps ask for more than it gives, and corrections that lead there are not
    # followed for ever
    tau, own, drive = 1e-3, 0.04, 0.06
    m = hb.Model("sign")
    if kind == "mass":
        m.add(j=hb.Zero(), x=hb.I(tau, p=0.02), r=hb.R(1.0), s=hb.R({"f": f"{own}*sign(e)"}))
        m.bond("x -> j", "j -> r", "j -> s")
        rest = own * tau
    else:
        m.add(v=hb.Sf(drive), z=hb.Zero(), r=hb.R(1.0), s=hb.R({"e": f"{own}*sign(f)"}), j=hb.One())
        m.add(x=hb.I(tau) if "gyrator" in kind else hb.C(tau))
        rest = (drive - own) * tau
    if kind == "driven":
        m.bond("v -> z -> r", "z -> j -> x", "j -> s")
    elif kind == "driven, arrows turned":
        m.bond("z -> v", "z -> r", "j -> z", "x -> j", "s -> j")
    elif kind != "mass":
        m.add(g=hb.GY(1.0))
        m.bond("v -> z -> r", "z -> j -> g -> x", "j -> s")
    run = hb.simulate(m, 0.1, solver="radau", rtol=1e-6)
    name = "x.p" if "x.p" in run.names else "x.q"
    assert abs(float(run[name].at(0.1))) == pytest.approx(rest, rel=1e-5)
    assert run.stats["evaluations"] < 3000


def test_force_well_within_what_a_sign_gives_still_has_no_solution():
    m = hb.Model("sign")
    m.add(j=hb.One(), v=hb.Se(0.039), r=hb.R(1.0), s=hb.R({"e": "0.04*sign(f)"}))
    m.bond("v -> j", "j -> r", "j -> s")
    with pytest.raises(hb.HybondError, match="HB-N301"):
        hb.simulate(m, 1.0)
