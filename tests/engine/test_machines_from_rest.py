"""What is at rest stays found at rest: teeth that do not touch yet, oil that has levelled out."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

STIFF, FREE, INERTIA, DRAG = 400.0, 0.1, 0.03, 0.05
BACKLASH = {
    "max": f"{STIFF}*(max(q - {FREE}, 0) - max(-{FREE} - q, 0))",
    "if": f"if abs(q) < {FREE} then 0 else {STIFF}*(q - {FREE}*sign(q))",
    "hard": f"{STIFF}*(max(q - {FREE}, 0)^1.5 - max(-{FREE} - q, 0)^1.5)",
}


def geared(tooth: str, turned: bool) -> hb.Model:
    """Return a wheel that a drive swings through a gap, at rest until the teeth meet."""
    m = hb.Model("backlash", domain="rotational")
    m.add(drive=hb.Sf("5*cos(6*time/(1 [s]))"), wheel=hb.I(INERTIA), w=hb.One(), gap=hb.Zero())
    m.add(tooth=hb.C({"e": BACKLASH[tooth]}), drag=hb.R(DRAG))
    m.bond("drive -> gap -> w", "gap -> tooth")
    m.bond(*("wheel -> w", "drag -> w") if turned else ("w -> wheel", "w -> drag"))
    return m


def speed_of_wheel(tooth: str, until: float) -> float:
    """Return the speed of the wheel by SciPy, from where the teeth meet first."""
    power = 1.5 if tooth == "hard" else 1.0

    def rates(t: float, y: np.ndarray) -> list[float]:
        q, w = y
        force = STIFF * math.copysign(max(abs(q) - FREE, 0.0) ** power, q)
        return [5 * math.cos(6 * t) - w, (force - DRAG * w) / INERTIA]

    meets = math.asin(FREE * 6 / 5) / 6
    found = solve_ivp(rates, (meets, until), [FREE, 0.0], rtol=1e-11, atol=1e-12, max_step=1e-3)
    return float(found.y[1, -1])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("tooth", BACKLASH)
def test_implicit_steps_pass_the_end_of_a_backlash_from_rest(tooth: str, turned: bool) -> None:
    """Steps became too small there: what was foreseen left dust of a momentum that is nothing."""
    want = speed_of_wheel(tooth, 0.05)
    for rtol in (1e-4, 1e-6, 1e-9):
        run = hb.simulate(geared(tooth, turned), 0.05, solver="radau", rtol=rtol)
        assert run["wheel.p"].at(0.01) == 0.0
        np.testing.assert_allclose(run["w.f"].at(0.05), want, rtol=max(300 * rtol, 1e-8))
        assert run.audit().holds()


GAS = {
    "adiabatic": ("8e6*(2e-3/(2e-3 - q))^1.4", lambda q: 8e6 * (2e-3 / (2e-3 - q)) ** 1.4),
    "cubic": ("1e10*q + 1e16*q^3", lambda q: 1e10 * q + 1e16 * q**3),
}


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("gas", GAS)
def test_a_gas_that_an_orifice_has_levelled_out_rests(gas: str, solver: str) -> None:
    """Oil went on to flow for ever, or for thousands of steps: rest was missed by the bend."""
    text, pressure = GAS[gas]
    m = hb.Model("accumulator", domain="hydraulic")
    m.add(gas=hb.C({"e": text}, q="0.8 L"), n=hb.Zero(), out=hb.One(), back=hb.Se("90 bar"))
    m.add(orifice=hb.R({"f": "3e-7*sign(e)*sqrt(abs(e))"}))
    m.bond("n -> gas", "n -> out -> back", "out -> orifice")

    def rates(t: float, q: np.ndarray) -> list[float]:
        return [-3e-7 * math.sqrt(max(pressure(q[0]) - 9e6, 0.0))]

    half = solve_ivp(rates, (0, 0.4), [0.8e-3], rtol=1e-11, atol=1e-16).y[0, -1]
    for rtol in (1e-6, 1e-8, 1e-10):
        run = hb.simulate(m, 5.0, solver=solver, rtol=rtol)
        np.testing.assert_allclose(run["gas.q"].at(0.4), half, rtol=100 * rtol)
        assert run["orifice.e"].at(4.0) == 0.0 and run["orifice.f"].at(4.0) == 0.0
        assert run.stats["steps"] < 300


def bouncing(restitution: object) -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se(-9.81), ball=hb.I(1), v=hb.One())
    m.add(floor=hb.Zero(law="unilateral", gap="height", restitution=restitution))
    m.bond("weight -> v -> ball", "floor -> v")
    m.signal(height=hb.Integral("v.f", start="1 m"), hit="0.1*abs(v.f)/(1 [m/s])")
    return m


NONSENSE = {
    "height": "HB-U103",
    "0.9 - 0.1*abs(v.f)": "HB-U103",
    "0.9 - 0.1*abs(v.f)/(1 [m/s])": "HB-M207",
    "hit": "HB-M207",
    "ball.p/(1 [N*s])": "HB-M207",
    "0.9 - 0.3 [s/m]*abs(pre(v.f))": "HB-N412",
    "sqrt(0.4 - time/(1 [s]))": "HB-N412",
}
WAYS = ({}, {"impact": "poisson"}, {"impact": "lzb"}, {"solver": "moreau-jean", "step": 1e-3})


@pytest.mark.parametrize("restitution", NONSENSE)
def test_a_restitution_that_makes_no_sense_is_refused_in_words(restitution: str) -> None:
    """It was said that a law did not hold, and that no model should do this."""
    for how in WAYS:
        with pytest.raises(hb.HybondError) as caught:
            hb.simulate(bouncing(restitution), 1.0, **how)
        assert caught.value.code == NONSENSE[restitution]
        assert caught.value.where == "elements.floor.restitution"


def test_a_restitution_may_read_the_speed_of_approach() -> None:
    run = hb.simulate(bouncing("0.9 - 0.1*abs(pre(v.f))/(1 [m/s])"), 1.0)
    fast = math.sqrt(2 * 9.81)
    slow = fast * (0.9 - 0.1 * fast)
    first, second = run.events.t[1:3]
    np.testing.assert_allclose([first, second - first], [fast / 9.81, 2 * slow / 9.81], rtol=1e-9)


RULES = {
    "time >= 1 [s] and not (time >= 3 [s])": "time >= 3 [s]",
    "turned > 2 and not (turned > 5)": "turned > 5",
}


@pytest.mark.parametrize("repaired", RULES)
def test_guards_that_hold_at_once_are_told_how_to_exclude_each_other(repaired: str) -> None:
    """The remedy spoke of a threshold on pre(), where what is read does not jump at all."""
    back = RULES[repaired]
    m = hb.Model("coupling", domain="rotational")
    m.add(a=hb.I(1, f=2), b=hb.I(2), wa=hb.One(), wb=hb.One(), c=hb.Zero())
    m.bond("wa -> a", "wb -> b", "wa -> c -> wb")
    m.signal(turned=hb.Integral("wa.f"))

    def dog(first: str) -> hb.Result:
        m.machines.clear()
        rules = [f"off -> on when {first}", f"on -> off when {back}"]
        m.machine("dog", states={"off": [], "on": ["c"]}, start="off", rules=rules)
        return hb.simulate(m, 9.0)

    with pytest.raises(hb.DivergenceOfTime) as caught:
        dog(repaired.partition(" and not")[0])
    assert f"write {repaired}, or" in caught.value.hint
    run = dog(repaired)
    # once on, both turn at 2/3, and stay so
    assert [len(e.steps[-1].fired) for e in run.events[1:]] == [1, 1]
    assert run["wb.f"].at(9.0) == pytest.approx(2 / 3, rel=1e-12)
