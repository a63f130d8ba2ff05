"""A law that is a root has an infinite slope where nothing flows: a shut valve is no end of it."""

import math

import numpy as np
import pytest

import hybond as hb

C, R, K, E0, SHUT = 1e-6, 1e6, 1e-6, 1e4, 0.5


def tank(law: str, *, turned: bool = False, **more: float) -> hb.Model:
    """A tank with a leak, and an orifice behind a valve that opens at 0.5 s."""
    m = hb.Model("tank", domain="hydraulic", parameters={"k": K, "leak": R, **more})
    m.add(tank=hb.C(C, e=E0), bleed=hb.R("leak"), hole=hb.R({"f": law}), n=hb.Zero(), v=hb.One())
    m.bond("n -> tank", "n -> bleed", "hole -> v -> n" if turned else "n -> v -> hole")
    m.machine("V", states={"shut": [], "open": ["v"]}, start="shut",
              rules=[f"shut -> open when time >= {SHUT}"])  # fmt: skip
    return m


def level(t: float, k: float, leak: float) -> float:
    """2 C u' = -k - u/leak of the root u of the pressure while it is open; a plain leak before."""
    u = math.sqrt(E0 * math.exp(-min(t, SHUT) / (leak * C)))
    if t > SHUT:
        u = (u + k * leak) * math.exp(-(t - SHUT) / (2.0 * leak * C)) - k * leak
    return u * u


def slope(t: float, which: int) -> float:
    """The derivative of the closed form, by its complex step."""
    import cmath

    k, leak = complex(K), complex(R)
    if which == 0:
        k += 1e-30j
    else:
        leak += 1e-30j * R
    u = cmath.sqrt(E0 * cmath.exp(-min(t, SHUT) / (leak * C)))
    if t > SHUT:
        u = (u + k * leak) * cmath.exp(-(t - SHUT) / (2.0 * leak * C)) - k * leak
    return (u * u).imag / (1e-30 if which == 0 else 1e-30 * R)


LAWS = ["k*sign(e)*sqrt(abs(e))", "k*sign(e)*abs(e)^0.5"]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_derivatives_do_not_end_at_an_orifice_behind_a_shut_valve(law: str, turned: bool) -> None:
    s = hb.sensitivities(tank(law, turned=turned), "1 s", wrt=["k", "leak"], of=["tank.e"],
                         times=[0.25, 0.75], rtol=1e-10)  # fmt: skip
    assert s.ends is None, s.why
    assert s.final("tank.e", "k") == pytest.approx(slope(1.0, 0), rel=1e-7)
    assert s.final("tank.e", "leak") == pytest.approx(slope(1.0, 1), rel=1e-7)
    assert s.at(0.25, "tank.e", "k") == 0.0
    assert s.at(0.25, "tank.e", "leak") == pytest.approx(slope(0.25, 1), rel=1e-9)
    assert s.at(0.75, "tank.e", "k") == pytest.approx(slope(0.75, 0), rel=1e-7)


def test_what_a_shut_orifice_carries_does_not_vary() -> None:
    s = hb.sensitivities(tank(LAWS[0]), "0.4 s", wrt=["k", "leak"], of=["hole.e", "hole.f"])
    assert s.ends is None and not s["hole.e"].any() and not s["hole.f"].any()


@pytest.mark.parametrize("kind", ["e", "f"])
def test_the_dual_a_brake_whose_force_is_a_root_behind_a_shut_junction(kind: str) -> None:
    # a mass that a spring-like root law brakes once a 0-junction is ON: no effort before that
    m = hb.Model("mass", parameters={"k": 3.0, "b": 0.5})
    law = {"e": "k*sign(f)*sqrt(abs(f))"} if kind == "e" else {"f": "sign(e)*(e/k)^2"}
    m.add(mass=hb.I(1.0, f=4.0), drag=hb.R("b"), brake=hb.R(law), v=hb.One(), lets=hb.Zero())
    m.bond("v -> mass", "v -> drag", "v -> lets -> brake")
    m.machine("B", states={"off": [], "on": ["lets"]}, start="off",
              rules=["off -> on when time >= 0.25"])  # fmt: skip
    s = hb.sensitivities(m, "0.5 s", wrt=["k", "b"], of=["mass.f"], rtol=1e-10)
    assert s.ends is None, s.why
    # v' = -b v; then 2 u' = -k - b u of the root of v
    u0 = 2.0 * math.exp(-0.5 * 0.125)
    decay = math.exp(-0.5 * 0.125)
    u = (u0 + 6.0) * decay - 6.0
    by_k = 2.0 * u * (decay - 1.0) / 0.5
    assert s.final("mass.f", "k") == pytest.approx(by_k, rel=1e-7)


def test_an_exponent_that_is_a_parameter() -> None:
    law = "k*sign(e)*abs(e/(1 Pa))^z"
    s = hb.sensitivities(tank(law, z=0.5), "1 s", wrt=["z", "k"], of=["tank.e"], rtol=1e-10)
    assert s.ends is None, s.why
    assert s.final("tank.e", "k") == pytest.approx(slope(1.0, 0), rel=1e-7)
    h = 1e-5
    runs = [hb.simulate(tank(law, z=0.5 + d), "1 s", rtol=1e-11) for d in (h, -h)]
    ends = [float(run.sample([1.0], ["tank.e"])["tank.e"][0]) for run in runs]
    assert s.final("tank.e", "z") == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-5)


def test_a_law_with_a_finite_slope_that_is_no_quotient_at_zero_as_written() -> None:
    law = "k*e*(1 + sqrt(abs(e))/100)"
    s = hb.sensitivities(tank(law), "0.4 s", wrt=["k", "leak"], of=["tank.e", "hole.e"])
    assert s.ends is None, s.why
    assert s.final("tank.e", "leak") == pytest.approx(slope(0.4, 1), rel=1e-8)
    assert s.final("tank.e", "k") == 0.0 and not s["hole.e"].any()


def test_a_root_whose_end_a_parameter_moves_is_not_taken_for_one_that_stays() -> None:
    # f = 0 at e = w: that this pressure follows w is no matter of the slope's size
    s = hb.sensitivities(tank("k*sign(e - w)*sqrt(abs(e - w))", w=0.0), "0.4 s", wrt=["w"],
                         of=["hole.e"])  # fmt: skip
    assert s.ends == 0.0 or s.final("hole.e", "w") == pytest.approx(1.0)


def test_an_open_orifice_at_rest_still_has_no_derivative() -> None:
    m = hb.Model("filled", domain="hydraulic", parameters={"k": 2e-6})
    m.add(pump=hb.Sf(1e-4), tank=hb.C(4e-6), n=hb.Zero(), hole=hb.R({"f": LAWS[0]}))
    m.bond("pump -> n -> tank", "n -> hole")
    s = hb.sensitivities(m, 10.0, wrt=["k"])
    assert s.ends == 0.0 and "no finite slope" in s.why


def test_a_fit_sees_through_a_shut_valve() -> None:
    t = np.linspace(0.0, 1.0, 21)
    data = {"time": t, "tank.e": [level(x, 2.0 * K, R) for x in t.tolist()]}
    found = hb.fit(tank(LAWS[0]), data, free=["k"], rtol=1e-10)
    assert found.converged and found["k"] == pytest.approx(2.0 * K, rel=1e-6)
