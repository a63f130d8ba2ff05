"""Which loops of limited amplifiers are known to have one solution, and which never are.

Each stage gives ``12 V*tanh(gain*u)``, u being a sum of what all of them give, whose factors are
divisions of voltages. The loop has one solution whatever the gains are if all principal minors of
the factors, taken off themselves, are at least zero, and may have three if one of them is below
(Sandberg and Willson 1969).
"""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.engine.engine import OK, make_engine
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.nonlinear.several import is_followed, is_single
from hybond.engine.tables import answered, tables_of


def is_known_as_single(m: hb.Model) -> bool:
    """Whether laws that could be followed are known to have one solution."""
    e = make_engine(answered(tables_of(m.flatten(), until=1.0)))
    assert mode_of(e, [0] * e.model.machines) == OK and is_followed(e, e.mode)
    return is_single(e, e.mode)


class Net:
    """Nodes that are held, or fed by resistors."""

    def __init__(self, *, turned: bool) -> None:
        self.m = hb.Model("net", domain="electrical")
        self.turned = turned
        self.many = 0

    def held(self, node: str, law: str) -> None:
        self.m.add(**{node: hb.Zero(), f"V{node}": hb.Se(law)})
        self.m.bond(f"V{node} -> {node}")

    def free(self, *nodes: str) -> None:
        for node in nodes:
            self.m.add(**{node: hb.Zero()})

    def resistor(self, a: str, b: str, ohm: float) -> None:
        self.many += 1
        j, r = f"j{self.many}", f"r{self.many}"
        self.m.add(**{j: hb.One(), r: hb.R(ohm)})
        one, other = (b, a) if self.turned else (a, b)
        self.m.bond(f"{one} -> {j} -> {other}", f"{j} -> {r}")

    def stage(self, node: str, read: str, gain: float) -> None:
        self.held(node, f"12 [V]*tanh({gain}*({read})/(1 [V]))")


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("gain", [3.0, 1e5, -1e5])
def test_one_stage_by_the_sign_of_its_gain(gain: float, *, turned: bool) -> None:
    """What it reads is a sixteenth of what it gives, and what it is driven by."""
    n = Net(turned=turned)
    n.held("i", "1 [V]*sin(time/(1 [s]))")
    n.free("x")
    n.stage("o", "x.e", gain)
    n.resistor("i", "x", 1e3)
    n.resistor("x", "o", 15e3)
    assert is_known_as_single(n.m) == (gain < 0.0)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("plus", "minus"), [(1e3, 2e3), (2e3, 1e3), (1.5e3, 1.4e3), (1.4e3, 1.5e3)]
)
def test_fed_back_both_ways_by_which_is_more(plus: float, minus: float, *, turned: bool) -> None:
    n = Net(turned=turned)
    n.held("i", "1 [V]*sin(time/(1 [s]))")
    n.free("p", "m")
    n.stage("o", "p.e - m.e", 1e5)
    for node, ohm in (("p", plus), ("m", minus)):
        n.resistor("i", node, ohm)
        n.resistor(node, "o", 1e3)
    # of what it gives each has ohm/(ohm + 1 kohm)
    assert is_known_as_single(n.m) == (plus < minus)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("stages", "odd"), [(2, False), (3, True), (4, False)])
def test_stages_in_a_row_and_all_about(stages: int, odd: bool, *, turned: bool) -> None:
    """Each inverts and is fed back alone; about all of them feedback is by the sign of all."""
    for about in (False, True):
        n = Net(turned=turned)
        n.held("o0", "1 [V]*sin(time/(1 [s]))")
        for k in range(1, stages + 1):
            n.free(f"x{k}")
            n.stage(f"o{k}", f"x{k}.e", -1e5)
            n.resistor(f"o{k - 1}", f"x{k}", 1e4)
            n.resistor(f"x{k}", f"o{k}", 2e4)
        if about:
            n.resistor(f"o{stages}", "x1", 5e3)
        assert is_known_as_single(n.m) == (odd or not about)


@pytest.mark.parametrize("gain", [1e3, 0.07, 0.0833])
def test_a_stage_that_reads_its_own_value_is_known_by_more_than_its_sign(gain: float) -> None:
    """``o = 12 tanh(gain (o + x))`` alone turns from where 12 gain is 1."""
    n = Net(turned=False)
    n.held("i", "1 [V]*sin(time/(1 [s]))")
    n.stage("o", "o.e + i.e", gain)
    n.free("z")
    n.resistor("o", "z", 1e3)
    n.resistor("z", "i", 1e3)
    assert is_known_as_single(n.m) == (12.0 * gain < 1.0)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("reads", ["x.e - o.e", "i.e - o.e", "x.e - o.e + 0.25*i.e"])
def test_a_follower_that_is_loaded_is_single_and_a_latch_of_two_is_not(
    reads: str, *, turned: bool
) -> None:
    for latch in (False, True):
        n = Net(turned=turned)
        n.held("i", "1 [V]*sin(time/(1 [s]))")
        n.free("x")
        n.stage("o", reads, 1e3)
        n.resistor("i", "x", 1e3)
        n.resistor("x", "o", 2e3)
        if latch:
            n.free("y")
            n.stage("a", "-y.e", 1e3)
            n.stage("b", "-a.e", 1e3)
            n.resistor("b", "y", 1e3)
            n.resistor("y", "o", 1e3)
        assert is_known_as_single(n.m) == (not latch)
