"""An integral whose rate jumps and is driven back from both sides: refused, with a recipe."""

import math

import pytest

import hybond as hb

ANTI_WINDUP = """
hybond = 1
[elements]
u = {{ Se = "if raw > 4 then 4 else raw" }}
i = {{ junction = 1 }}
r = {{ R = 1 }}
c = {{ C = 1 }}
[graph]
bonds = ["u -> i -> r", "i -> c"]
[signals]
error = "5 - c.e"
sum   = {{ integral = "{rate}", start = {start} }}
raw   = "2*error + sum"
{machine}
[experiment]
until = 10
"""
MACHINE = """
[machines.limit]
states = { free = [], high = [] }
start  = "free"
rules  = ["free -> high when raw > 4 and error > 0", "high -> free when raw < 4 or error < 0"]
"""


def refused(rate: str, *, start: float = 0.0, solver: str = "auto") -> hb.Result:
    """Run a PI controller with conditional anti-windup that is written into its rate."""
    m = hb.loads(ANTI_WINDUP.format(rate=rate, start=start, machine=""))
    run = hb.simulate(m, solver=solver, on_error="return", max_steps=20_000)
    assert run.error is not None
    return run


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize(("start", "gain"), [(0.0, 3.0), (1.0, 3.0), (1.0, 0.8)])
def test_conditional_anti_windup_in_a_rate_is_refused_where_it_would_slide(
    start: float, gain: float, solver: str
) -> None:
    # u = 4, so c.e = 4*(1 - exp(-t)), and 2*(5 - c.e) + start falls to 4 at this time
    begin = -math.log(1.0 - (5.0 - 0.5 * (4.0 - start)) / 4.0)
    run = refused(f"if raw > 4 and error > 0 then 0 else {gain}*error", start=start, solver=solver)
    assert run.error.code == "HB-N410"
    assert "'sum'" in str(run.error) and "control.pi_clamped" in str(run.error)
    assert run.t_end == pytest.approx(begin, rel=2e-4)


def test_the_recipe_for_a_rate_that_jumps_slides_along_its_limit() -> None:
    rate = "if limit.state == 'high' then 0 else 3*error".replace("'", '\\"')
    run = hb.simulate(hb.loads(ANTI_WINDUP.format(rate=rate, start=0, machine=MACHINE)))
    begin = math.log(4.0)
    for t in (1.0, begin + 0.01, 2.0, 5.0, 10.0):
        volts = 4.0 * (1.0 - math.exp(-t))
        assert run["c.e"].at(t) == pytest.approx(volts, rel=1e-5)
        # the sum takes up what the gain gives away: raw = 4
        assert run["sum"].at(t) == pytest.approx(max(2.0 * volts - 6.0, 0.0), abs=1e-5)


def test_a_timer_that_runs_away_from_where_it_stops_is_no_slide() -> None:
    # a relative: the rate jumps where it is passed, and nothing drives it back
    m = hb.loads(ANTI_WINDUP.format(rate="if sum > 1 then 3 else 1", start=0, machine=""))
    run = hb.simulate(m)
    assert run["sum"].at(2.0) == pytest.approx(1.0 + 3.0)


def test_the_rate_of_a_level_held_by_two_pumps_is_refused_by_its_name() -> None:
    # a relative without a source that shares the jump: the level is driven to 1 from both sides
    run = refused("if sum > 1 then -2 + sin(1*time) else 3", start=0.0)
    assert run.error.code == "HB-N410" and "'sum'" in str(run.error)
    assert run.t_end == pytest.approx(1.0 / 3.0, abs=1e-3)


RATES = {
    "sign": ("-sign(w)", "w < 0", 1.0, -1.0, lambda t: 0.0),
    "pushed": ("0.3 - sign(w)", "w < 0", 1.3, -0.7, lambda t: 0.0),
    "follows": (
        "-sign(w - 0.2*sin(time/(1 [s])))",
        "w < 0.2*sin(time/(1 [s]))",
        1.0,
        -1.0,
        lambda t: 0.2 * math.sin(t),
    ),
}


@pytest.mark.parametrize("rate", RATES)
def test_an_integral_that_switches_its_own_rate_slides_as_a_machine_only(rate: str) -> None:
    text, low, up, down, level = RATES[rate]
    m = hb.Model("own")
    m.signal(w=hb.Integral(text, start=0.5))
    run = hb.simulate(m, 2, on_error="return")
    assert run.error is not None and run.error.code == "HB-N410" and run.error.where == "w"
    assert "machine" in str(run.error)
    m = hb.Model("machine")
    m.signal(w=hb.Integral(f'if M.state == "low" then {up} else {down}', start=0.5))
    high = low.replace("<", ">")
    rules = [f"low -> high when {high}", f"high -> low when {low}"]
    m.machine("M", states={"low": [], "high": []}, start="high", rules=rules)
    run = hb.simulate(m, 2)
    assert run.sliding and run.audit().holds()
    for t in (1.0, 1.5, 2.0):
        assert float(run["w"].at(t)) == pytest.approx(level(t), abs=1e-9)


def test_the_rate_of_a_gap_that_is_closed_is_no_jump_but_rounding() -> None:
    """Beside a corner that a coil of 1e-9 Wb passes in no time: -3e-17 m/s there, 0 here."""
    m = hb.loads("""
hybond = 1
[elements]
j0 = { junction = 0 }
j1 = { junction = 0, law = "unilateral", gap = "gap", restitution = 0.0 }
r1 = { R = 0.7151515151515152 }
r2 = { R = { e = "0.697*max(-1, min(1, f/1.84))" } }
r3 = { R = { e = "1.65*(f/1.65)*abs(f/1.65)" } }
s0 = { Sf = "1.58*(1 - tanh(clock))" }
[elements.i0]
I = { f = { table = [[-2.78e-9, -1.39e-9, 0, 1.39e-9, 4.17e-9],
                     [-5.61, -1.87, 0, 1.87, 2.805]], extrapolate = "linear" } }
[graph]
bonds = ["j1 -> j0", "s0 -> j0", "j1 -> r2", "r3 -> j1", "j0 -> i0", "j1 -> r1", "j0 -> j1"]
[signals]
w = { integral = "i0.p" }
gap = { integral = "-j1.f", start = 0.2306620169733229 }
clock = { sample = "i0.p", every = 0.35762791318191006 }
""")
    run = hb.simulate(m, 1.79, solver="radau")
    # all that flows in goes to the gap while it is open
    assert run.events[1].t == pytest.approx(0.2306620169733229 / 1.58, rel=1e-9)
    assert run["gap"].at(1.79) == pytest.approx(0.0, abs=1e-9)
