"""Gates of thyristors that read a comparison inside a signal hold at their own located instant."""

import math

import pytest

import hybond as hb


def star(begin: float, gate: str, load: float) -> hb.Model:
    """Three phases of 10 V at 1 rad/s on thyristors that are fired `begin` rad after zero."""
    m = hb.Model("star", domain="electrical")
    m.add(o=hb.Zero(), i=hb.One(), r=hb.R(2))
    m.bond("o -> i -> r")
    if load:
        m.add(l=hb.I(load))
        m.bond("i -> l")
    m.signal(th=hb.Integral("1", start=0), sum=hb.Integral("o.e"), charge=hb.Integral("i.f"))
    for k in range(3):
        turn = f"(th - {begin} - {k}*2*pi/3)"
        m.signal(**{f"x{k}": f"sin{turn}", f"y{k}": f"cos{turn} - 1", f"g{k}": gate.format(k=k)})
        m.add(**{f"u{k}": hb.Se(f"10*sin(th - {k}*2*pi/3)"), f"n{k}": hb.Zero()})
        m.add(**{f"t{k}": hb.Submodel("electrical.thyristor", inputs={"gate": f"g{k}"})})
        m.bond(f"u{k} -> n{k} -> t{k}.plus", f"t{k}.minus -> o")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "gate",
    [
        "if x{k} >= y{k} then 1 else 0",
        "if x{k} > y{k} then 1 else 0",
        "if y{k} - x{k} <= 0 and th > 0 then 1 else 0",
    ],
)
@pytest.mark.parametrize("begin", [0.8, 0.93])
def test_one_thyristor_takes_over_from_another_where_a_signal_compares(gate, begin) -> None:
    # sin(a) >= cos(a) - 1 from a = 0 on; between two firings the voltage is 10*sin(angle)
    run = hb.simulate(star(begin, gate, 0.0), until=begin + 2 * math.pi, rtol=1e-9)
    third = 2 * math.pi / 3
    volts = 10 * (math.cos(begin) - math.cos(begin + third))
    first = run["sum"].at(begin)
    for k in (1, 2, 3):
        assert run["sum"].at(begin + k * third) - first == pytest.approx(k * volts, rel=1e-6)


def test_the_current_of_a_coil_goes_over_from_one_thyristor_to_another() -> None:
    # a steady mean is that of the voltage, since the coil takes none
    begin, third = 1.2, 2 * math.pi / 3
    run = hb.simulate(star(begin, "if x{k} >= y{k} then 1 else 0", 4.0), until=60, rtol=1e-8)
    mean = 10 * (math.cos(begin) - math.cos(begin + third)) / third / 2.0
    start = 50.0
    charge = run["charge"].at(start + third) - run["charge"].at(start)
    assert charge / third == pytest.approx(mean, rel=1e-5)


@pytest.mark.parametrize("gate", ["if n.e >= 0 then 1 else 0", "if n.e >= o.e then 1 else 0"])
@pytest.mark.parametrize("phase", [5.952356618732714, 3.3, 4.9])
def test_a_coil_begins_at_the_zero_of_a_sine_of_an_integrated_angle(gate, phase) -> None:
    # the rate is rounding there: 10*sin(w*t), R = 2, L = 1, from the zero of the sine on
    w = 8.692239903224745
    m = hb.Model("half wave", domain="electrical")
    m.add(u=hb.Se(f"10*sin({w}*th + {phase})"), n=hb.Zero(), o=hb.Zero(), i=hb.One())
    m.add(t=hb.Submodel("electrical.thyristor", inputs={"gate": "g"}), r=hb.R(2), l=hb.I(1))
    m.signal(th=hb.Integral("1", start=0), g=gate)
    m.bond("u -> n -> t.plus", "t.minus -> o -> i -> r", "i -> l")
    run = hb.simulate(m, until=1)
    zero = (2 * math.pi - phase) / w
    angle = math.atan2(w, 2)
    for t in (0.05, 0.2, 0.35):
        now = math.sin(w * t - angle) + math.sin(angle) * math.exp(-2 * t)
        assert run["l.f"].at(zero + t) == pytest.approx(10 / math.hypot(2, w) * now, rel=1e-5)
