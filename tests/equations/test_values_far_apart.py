"""Sums of values that lie many powers of ten apart lose digits: the run says so."""

import math

import pytest

import hybond as hb


def leak(r, leakage):
    """Two capacitors tied together, a resistor beside the tie, and a leak to ground."""
    m = hb.Model("leak", domain="electrical")
    m.add(C1=hb.C("1 nF", e="1 V"), C2=hb.C("1 nF", e="1 V"), n1=hb.Zero(), n2=hb.Zero())
    m.add(b=hb.One(), x=hb.One(), r=hb.R(r), R=hb.R(leakage))
    m.bond("n1 -> C1", "n2 -> C2", "n1 -> b -> n2", "n1 -> x -> n2", "x -> r", "n1 -> R")
    return hb.simulate(m, leakage * 2e-9)


def far_apart(run):
    return [w for w in run.warnings if "powers of ten" in w]


@pytest.mark.parametrize("leakage", [1e3, 1e5])
def test_no_word_while_digits_are_enough(leakage):
    run = leak(1e-3, leakage)
    assert run.final["C1.e"] == pytest.approx(math.exp(-1.0), rel=1e-7)
    assert far_apart(run) == []


@pytest.mark.parametrize("leakage", [1e6, 1e9, 1e12, 1e15])
def test_a_leak_keeps_its_current_and_that_others_have_few_digits_is_said_once(leakage):
    """What the tie takes is a difference of two voltages that are equal, in units of 1 milliohm."""
    run = leak(1e-3, leakage)
    (warning,) = far_apart(run)
    assert "few digits" in warning and "the only mode" in warning
    assert run.final["C1.e"] == pytest.approx(math.exp(-1.0), rel=1e-12)


@pytest.mark.parametrize("r", [1.5173e-3, 0.7e-3, 3.3e-3])
def test_no_word_where_halves_are_equal_and_differences_are_zero(r):
    """A bridge behind a coil, all four diodes in turn; 2 U/pi less the commutation, 2 w L I/pi.

    Source: Mohan, Undeland, Robbins, Power Electronics, chapter on line-frequency rectifiers.
    """
    m = hb.Model("bridge", domain="electrical")
    m.add(V=hb.Se("170 V*sin(2*pi*60 Hz*time)"), Ls=hb.I("1 mH"), Ld=hb.I("1 H", f="10 A"))
    m.add(Rd=hb.R("10 ohm"), s=hb.One(), d=hb.One(), a=hb.Zero(), p=hb.Zero(), n=hb.Zero())
    for k, ends in enumerate(("a -> D0 -> p", "D1 -> p", "n -> D2 -> a", "n -> D3")):
        m.add(**{f"D{k}": hb.One(law="diode"), f"r{k}": hb.R(r), f"u{k}": hb.Se("13.776 mV")})
        m.bond(ends, f"D{k} -> r{k}", f"D{k} -> u{k}")
    m.bond("V -> s -> a", "s -> Ls", "p -> d -> n", "d -> Ld", "d -> Rd")
    run = hb.simulate(m, "1 s")
    assert far_apart(run) == []
    current = run["Ld.f"].mean(period="60 Hz", periods=6)
    drops = 2 * (0.013776 + r * current)
    wanted = 2 * 170 / math.pi - 2 * 2 * math.pi * 60 * 1e-3 * current / math.pi - drops
    assert 10 * current + run["Ld.e"].mean(period="60 Hz", periods=6) == pytest.approx(
        wanted, rel=1e-4
    )


WINDINGS = """Windings coupled closely
V1 ct 0 24
{primary}
Lc s1 0 {secondary}
Ld 0 s2 {secondary}
S1 d1 0 g 0 S
D1 s1 r D
D2 s2 r D
Lo r o 100u IC=1
Ro o 0 5
Vg g 0 PULSE(0 1 1u 20n 20n 8u 20u)
Vh h 0 PULSE(0 1 11u 20n 20n 8u 20u)
.model S SW(VT=0.5 RON=20m)
.model D D(IS=1e-14 N=0.01 RS=10m)
.tran 200n 20u uic
.end
"""
PUSH_PULL = "La ct d1 200u\nLb d2 ct 200u\nS2 d2 0 h 0 S\nK1 La Lb Lc Ld {k}"
FORWARD = "La ct d1 200u\nRa ct d1 1k\nK1 La Lc Ld {k}"


@pytest.mark.parametrize("k", [0.99, 0.999, 0.9999])
@pytest.mark.parametrize(("primary", "secondary"), [(PUSH_PULL, 200e-6), (FORWARD, 15.625e-6)])
def test_no_word_of_coils_that_are_coupled_closely(tmp_path, k, primary, secondary):
    """Windings that are alike stay alike; what leads a current has the flux of its inductances."""
    path = tmp_path / "windings.cir"
    path.write_text(WINDINGS.format(primary=primary.format(k=k), secondary=secondary))
    run = hb.simulate(hb.read_circuit(path).model)
    assert run.status == "ok" and far_apart(run) == []
    many = 4 if primary == PUSH_PULL else 3
    own = [200e-6] * (many - 2) + [secondary] * 2
    flux, current = (
        [float(run[f"K1.{j}.{x}"].at(run.t_end)) for j in range(1, many + 1)] for x in "pf"
    )
    for i, p in enumerate(flux):
        row = (
            a * (1.0 if i == j else k) * math.sqrt(own[i] * own[j]) for j, a in enumerate(current)
        )
        assert p == pytest.approx(math.fsum(row), rel=1e-9, abs=1e-15)
