"""The stiff solver in the kernel makes the steps of the reference."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from switched_models import converter, striking

import hybond as hb
from hybond.kernel import marcher as marching
from hybond.kernel import plan
from hybond.kernel.marcher import Marcher, marcher
from hybond.programs.program import Program
from hybond.simulation import ErrorScale
from hybond.solvers.implicit import RadauIIA

# the reference tries points at which a law overflows, too
pytestmark = pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")


def both(model, until=None, **options):
    """Return the reference's run and the kernel's."""
    options = {"solver": "radau", "on_error": "return", **options}
    return [hb.simulate(model, until, kernel=k, **options) for k in (False, True)]


def told(run):
    """What happened: causes, modes, guards."""
    return [
        (e.cause, [(s.mode, s.kind, [(f.machine, f.guard) for f in s.fired]) for s in e.steps])
        for e in run.events
    ]


def assert_alike(a, b, rel):
    """Compare final states in units of the largest that each has been, and events."""
    assert (a.status, told(a)) == (b.status, told(b))
    assert b.t_end == pytest.approx(a.t_end, rel=1e-9)
    for one, other in zip(a.events, b.events, strict=True):
        assert other.t == pytest.approx(one.t, abs=rel * a.t_end)
    t = np.linspace(0.0, a.t_end, 50).tolist()
    for name in [s.path for s in a.graph.storages] + [i.path for i in a.graph.integrals]:
        x, y = float(a[name].at(t)[-1]), float(b[name].at(t)[-1])
        assert y == pytest.approx(x, abs=rel * np.abs(a[name].at(t)).max()), name
    # near a law that overflows, what a step's control decides hangs on the last bits
    assert b.stats["steps"] == pytest.approx(a.stats["steps"], rel=0.03, abs=5)
    assert b.stats["rejected"] == pytest.approx(a.stats["rejected"], rel=0.2, abs=3)


def network(far=1e6):
    """Return two capacitors with time constants that are `far` apart, and a source."""
    m = hb.Model("network")
    m.add(V=hb.Se("1"), i=hb.One(), r=hb.R(1.0), n=hb.Zero(), c=hb.C(1.0), j=hb.One())
    m.add(s=hb.R(2.0), k=hb.Zero(), d=hb.C(1.0 / far), g=hb.G(0.5))
    m.bond("V -> i -> n -> c", "i -> r", "n -> j -> k -> d", "j -> s", "k -> g")
    return m


def oregonator():
    """Return integrals alone: waves of a reaction, stiff in some of their parts."""
    m = hb.Model("waves")
    m.add(c=hb.C(1, q=1.0), n=hb.Zero(), g=hb.G(0.1))
    m.bond("n -> c", "n -> g")
    m.signal(
        x=hb.Integral("77.27*(y + x*(1 - 8.375e-6*x - y))", start=1.0),
        y=hb.Integral("(z - (1 + x)*y)/77.27", start=2.0),
        z=hb.Integral("0.161*(x - z)", start=3.0),
    )
    return m


def relaxation(mu=1000.0):
    """Return van der Pol's circuit: a law with a falling part."""
    m = hb.Model("relaxation")  # its period is about 1600 s
    m.add(c=hb.C(1.0 / mu, q=2.0 / mu), l=hb.I(mu), n=hb.Zero())
    m.add(d=hb.G({"f": "e^3/3 - e"}))
    m.bond("n -> c", "n -> l", "n -> d")
    return m


def joined():
    """Return capacitors that a source and a wire join: storage that depends, and a fast one."""
    m = hb.Model("joined", domain="electrical")
    m.add(V=hb.Se("sin(3*time) + 2"), i=hb.One(), r=hb.R("1 mohm"), a=hb.Zero(), c1=hb.C("1 mF"))
    m.add(w=hb.One(), b=hb.Zero(), c2=hb.C("2 mF"), L=hb.I("10 H"), s=hb.One(), q=hb.R(3))
    m.bond("V -> i -> a", "i -> r", "a -> c1", "a -> w -> b", "b -> c2", "b -> s -> L", "s -> q")
    m.signal(charge=hb.Integral("i.f"))
    return m


def diode(sharp=3000.0):
    """Return a capacitor that charges through a law which overflows at points that are tried."""
    m = hb.Model("sharp")
    m.add(V=hb.Se("10*sin(40*time)"), i=hb.One(), r=hb.R(1e-2), n=hb.Zero(), c=hb.C(1e-2))
    m.add(d=hb.G({"f": f"1e-12*(exp({sharp}*e) - 1)"}))
    m.bond("V -> i -> n -> c", "i -> r", "n -> d")
    return m


def rhythm():
    """Return a stiff circuit that machines switch, on values and at times."""
    m = network(1e4)
    m.add(x=hb.One(), y=hb.R(0.3))
    m.bond("n -> x -> y")
    m.machine(
        "M",
        states={"off": [], "on": ["x"]},
        start="off",
        rules=["off -> on when c.e > 0.4", "on -> off when c.e < 0.25 and d.e < 0.2"],
    )
    m.machine(
        "T",
        states={"a": [], "b": [], "c": []},
        start="a",
        rules=["a -> b when time >= 0.5", "b -> c when time >= 1.5"],
    )
    return m


MODELS = {
    "network": (network, 5.0),
    "integrals": (oregonator, 30.0),
    "relaxation": (relaxation, 2000.0),
    "dependent": (joined, 2.0),
    "overflow": (diode, 0.3),
    "events": (rhythm, 2.0),
}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("rtol", [1e-6, 1e-11])
def test_steps_are_those_of_the_reference(kernel, name, rtol):
    make, until = MODELS[name]
    a, b = both(make(), until, rtol=rtol)
    assert a.status == "ok"
    assert b.stats["marched"] >= 0.95 * b.stats["steps"]
    # what makes steps differ at all is the rounding in differences, of a part of the tolerance
    assert_alike(a, b, max(1e-9, rtol))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
@pytest.mark.parametrize("name", MODELS)
def test_the_first_steps_differ_by_rounding(kernel, name, rtol):
    """Before any decision falls the other way."""
    make, until = MODELS[name]
    a, b = (run.trace.segments[0].t[1:7] for run in both(make(), until, rtol=rtol))
    assert np.diff(b, prepend=0.0) == pytest.approx(np.diff(a, prepend=0.0), rel=1e-5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("make", [converter, striking])
def test_random_models_are_the_same(kernel, make, seed):
    a, b = both(make(seed), 2.0, rtol=1e-11)
    assert b.stats["marched"] > 0
    assert_alike(a, b, 1e-8)


def test_passages_are_made_with_it(kernel):
    a, b = both(rhythm(), 2.0)
    assert len(b.events) > 5 and b.stats["crossed"] >= len(b.events) - 2
    assert b.kernel.startswith(f"{int(b.stats['steps'])} of {int(b.stats['steps'])} steps")
    assert told(a) == told(b)


def test_a_linear_network_against_its_exponentials(kernel):
    far = 1e6
    run = hb.simulate(network(far), 5.0, solver="radau", rtol=1e-10)
    rates = np.array([[-1.0 - 0.5, 0.5 * far], [0.5, -(0.5 + 0.5) * far]])
    values, vectors = np.linalg.eig(rates)
    rest = -np.linalg.solve(rates, [1.0, 0.0])
    parts = np.linalg.solve(vectors, -rest)
    for t in (1e-6, 1e-3, 0.5, 5.0):
        exact = rest + vectors @ (parts * np.exp(values * t))
        assert run["c.q"].at(t) == pytest.approx(exact[0], rel=1e-8), t
    assert run.final["d.q"] == pytest.approx(exact[1], rel=1e-8)
    # an explicit step could not be longer than a millionth of this run
    assert run.stats["steps"] == run.stats["marched"] < 2000


@pytest.mark.slow
def test_energies_balance(kernel):
    for name in ("network", "dependent", "relaxation"):
        make, until = MODELS[name]
        a, b = both(make(), until, rtol=1e-9)
        x, y = (run.audit() for run in (a, b))
        assert y.power <= 1e-9 and y.energy <= max(1e-9, 2.0 * x.energy), name


def test_few_steps_in_a_call_are_as_many_in_one(kernel, monkeypatch):
    """What the method keeps outlives a call: Jacobian, factors, and what the last step foresees."""
    model = oregonator()
    whole = hb.simulate(model, 30.0, solver="radau", rtol=1e-8)
    cost = []
    made = plan._cost

    def dear(mode, **options):
        cost.append(made(mode, **options))
        return 1e9

    monkeypatch.setattr(plan, "_cost", dear)
    one = hb.simulate(model, 30.0, solver="radau", rtol=1e-8)
    assert cost and one.stats["marched"] == whole.stats["marched"] > 300
    for name in ("x", "y", "z", "c.q"):
        assert one.final[name] == whole.final[name]
    # the passage that came to nothing made steps of its own
    assert one.stats["evaluations"] <= whole.stats["evaluations"]


@pytest.mark.slow
def test_steps_may_be_made_by_turns(kernel, monkeypatch):
    turns = {"kernel": 0, "reference": 0}
    march = Marcher.march

    def some(self, *args, **options):
        taken = march(self, *args, **options)
        if taken is None or taken.arrived or taken.event:
            return taken
        turns["kernel"] += len(taken.t)
        turns["reference"] += 1
        return replace(taken, interrupted=False)

    reference = hb.simulate(oregonator(), 30.0, solver="radau", rtol=1e-9, kernel=False)
    monkeypatch.setattr(Marcher, "march", some)
    monkeypatch.setattr(marching, "MOST", 5)
    monkeypatch.setattr(Marcher, "cross", lambda self, *args, **options: None)
    run = hb.simulate(oregonator(), 30.0, solver="radau", rtol=1e-9)
    assert min(turns.values()) > 20
    assert run.stats["marched"] == run.stats["steps"] - turns["reference"]
    assert run.stats["steps"] == pytest.approx(reference.stats["steps"], rel=0.1)
    for name in ("x", "y", "z", "c.q"):
        assert run.final[name] == pytest.approx(reference.final[name], rel=1e-6)


def test_what_overflows_is_left_to_the_reference(kernel):
    run = hb.simulate(diode(), 0.3, solver="radau")
    assert 0 < run.stats["steps"] - run.stats["marched"] < 0.05 * run.stats["steps"]


def test_a_law_without_a_value_stops_both(kernel):
    m = hb.Model("dry", domain="hydraulic")
    m.add(tank=hb.C("1 [m^3/Pa]", q=1.0), bottom=hb.Zero(), pump=hb.Sf(-1.0))
    m.add(drain=hb.R({"f": "1e-3*sqrt(e)"}))
    m.bond("bottom -> tank", "pump -> bottom", "bottom -> drain")
    a, b = both(m, 2.0)
    assert a.error is not None and b.error is not None
    assert b.error.code == a.error.code
    assert b.t_end == pytest.approx(a.t_end, rel=1e-6)
    assert b.stats["marched"] > 0


def test_the_longest_step_is_kept(kernel):
    a, b = both(network(), 5.0, max_step=0.1)
    steps = np.concatenate([np.diff(s.t) for s in b.trace.segments])
    assert steps.max() <= 0.1 * (1.0 + 1e-9)
    assert_alike(a, b, 1e-8)


def test_an_absolute_tolerance_is_kept(kernel):
    a, b = both(relaxation(), 2.0, atol=1e-7, rtol=1e-7)
    assert_alike(a, b, 1e-6)


def test_large_modes_are_left_to_the_reference(kernel, monkeypatch):
    for module in (plan, marching):
        monkeypatch.setattr(module, "LARGEST", 1)
    a, b = both(network(), 1.0)
    assert "1 mode left to the reference: an implicit step of more than 1 states" in b.kernel
    assert b.stats["marched"] == 0 and b.final == a.final
    # an explicit step has no matrices
    explicit = hb.simulate(network(10.0), 1.0)
    assert explicit.stats["marched"] == explicit.stats["steps"]


def test_a_jacobian_of_its_own_is_left_to_the_reference(kernel):
    program = Program(network().flatten())
    scale = ErrorScale(program, 1e-8, None, 1.0)
    solver = RadauIIA(scale, rtol=1e-8)
    assert isinstance(marcher(program, solver, scale), Marcher)
    solver.jacobian = lambda t, y: np.zeros((4, 4))
    assert marcher(program, solver, scale) == "a function gives the Jacobian"


# -- linear systems


def at(array):
    return array.ctypes.data_as(ctypes.c_void_p)


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_systems_are_solved(kernel, n):
    rng = np.random.default_rng(n)
    a, b = rng.normal(size=(n, n)), rng.normal(size=n)
    # no pivot stands where it is needed, and half of the rest is zero
    a[np.arange(n), np.arange(n)] = 0.0 if n > 1 else 3.0
    a *= (rng.random((n, n)) < 0.5) | (np.roll(np.eye(n), 1, axis=0) > 0.0)
    factors, x, row = np.array(a.T, order="C"), b.copy(), np.zeros(n, dtype=np.int32)
    assert kernel.hb_factor(n, at(factors), at(row)) == 1
    kernel.hb_unfactor(n, at(factors), at(row), at(x))
    assert a @ x == pytest.approx(b, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_complex_systems_are_solved(kernel, n):
    rng = np.random.default_rng(n)
    a = rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n))
    b = rng.normal(size=n) + 1j * rng.normal(size=n)
    a[np.arange(n), np.arange(n)] = 0.0 if n > 1 else 3.0 - 1.0j
    a *= (rng.random((n, n)) < 0.5) | (np.roll(np.eye(n), 1, axis=0) > 0.0)
    re, im = (np.array(part.T, order="C") for part in (a.real, a.imag))
    xr, xi, row = b.real.copy(), b.imag.copy(), np.zeros(n, dtype=np.int32)
    assert kernel.hb_factor_pair(n, at(re), at(im), at(row)) == 1
    kernel.hb_unfactor_pair(n, at(re), at(im), at(row), at(xr), at(xi))
    assert a @ (xr + 1j * xi) == pytest.approx(b, rel=1e-9, abs=1e-9)


def test_singular_systems_are_refused(kernel):
    row = np.zeros(2, dtype=np.int32)
    ones = np.ones((2, 2))
    assert kernel.hb_factor(2, at(ones.copy()), at(row)) == 0
    assert kernel.hb_factor_pair(2, at(ones.copy()), at(ones.copy()), at(row)) == 0
