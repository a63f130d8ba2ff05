"""Frequency responses by injection, against closed forms."""

from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.linear.injection import injected
from hybond.analysis.linear.periods import period_of, window_of
from hybond.analysis.linear.windows import left_over
from hybond.errors import HybondError


def test_a_linear_circuit_in_closed_form() -> None:
    m = hb.Model("rlc", domain="electrical")
    m.add(V=hb.Se("5 V"), i=hb.One(), r=hb.R("10 ohm"), l=hb.I("1 mH"), c=hb.C("10 uF"))
    m.bond("V -> i -> r", "i -> l", "i -> c")
    found = hb.frequency_response(
        m, input="V.e", output="c.e", frequencies=["100 Hz", 1600.0, "10 kHz"], tolerance=1e-6
    )
    s = 2j * np.pi * found.frequencies
    expected = 1 / (1 + s * 10 * 1e-5 + s * s * 1e-3 * 1e-5)
    assert found.ok and found.period is None and found.amplitude == pytest.approx(0.05)
    np.testing.assert_allclose(found.response, expected, rtol=1e-6)
    assert found.distortion.max() < 1e-6
    lin = hb.linearise(m, inputs=["V"], outputs=["c.e"])
    np.testing.assert_allclose(lin.bode(found.frequencies).response, expected, rtol=1e-11)


def buck() -> hb.Model:
    """In open loop at 100 kHz, its duty compared with a sawtooth; always conducting."""
    m = hb.Model("buck", domain="electrical", parameters={"T": "10 us"})
    m.add(V=hb.Se("12 V"), high=hb.One(), sw=hb.Zero(), low=hb.One(), zero=hb.Se("0 V"))
    m.add(coil=hb.One(), L=hb.I("100 uH"), out=hb.Zero(), C=hb.C("100 uF"), load=hb.R("2 ohm"))
    m.bond("V -> high -> sw", "zero -> low -> sw", "sw -> coil -> L", "coil -> out -> C")
    m.bond("out -> load")
    m.input(d=hb.Input(constant=0.4))
    m.machine(
        "leg",
        states={"up": ["high"], "down": ["low"]},
        start="up",
        rules=["up -> down when mod(time, T)/T >= d", "down -> up when mod(time, T)/T < d"],
    )
    return m


@pytest.mark.slow
def test_a_buck_converter_as_its_average() -> None:
    """A sawtooth against a duty that is sampled where both cross has no delay: the part of the
    pulses at the frequency of the duty is that of the duty, and the filter is linear. So the
    averaged model holds but for the sidebands, which a sine of 1 % makes smaller than 1e-4."""
    found = hb.frequency_response(
        buck(), input="d", output="out.e", frequencies=["1 kHz", "2 kHz", "9 kHz"], amplitude=0.004
    )
    s = 2j * np.pi * found.frequencies
    averaged = 12.0 / (1 + s * 100e-6 / 2 + s * s * 1e-8)
    assert found.ok and found.period == pytest.approx(1e-5)
    np.testing.assert_allclose(found.response, averaged, rtol=1e-3)
    # 9 kHz has no window with 100 kHz of one period: it is taken in nine
    assert found.turns.tolist() == [1, 1, 9] and found.asked.tolist() == [1e3, 2e3, 9e3]
    # from the source it is the filter times the duty
    line = hb.frequency_response(buck(), input="V", output="out.e", frequencies=["2 kHz"])
    np.testing.assert_allclose(line.response, averaged[1:2] * 0.4 / 12.0, rtol=1e-3)


def test_pulses_into_a_lowpass() -> None:
    """A source that a pulse train multiplies: the sine comes through with the duty, 0.25."""
    m = hb.Model("chopped", domain="electrical")
    m.add(V=hb.Se("gate*u"), j=hb.One(), r=hb.R("1 kohm"), c=hb.C("1 uF"))
    m.bond("V -> j -> r", "j -> c")
    m.input(gate=hb.Input(pwm={"period": "50 us", "duty": 0.25}), u="2 V")
    found = hb.frequency_response(m, input="u", output="c.e", frequencies=[160.0, 1000.0])
    s = 2j * np.pi * found.frequencies
    assert found.ok
    np.testing.assert_allclose(found.response, 0.25 / (1 + s * 1e-3), rtol=1e-3)
    # 160 Hz: 125 periods of 50 us are one of it
    assert found.frequencies[0] == pytest.approx(160.0, rel=1e-12)


def test_what_does_not_settle_is_said() -> None:
    m = hb.Model("slow")
    m.add(V=hb.Se(1.0), j=hb.One(), r=hb.R(1.0), c=hb.C(1000.0, q=5.0))
    m.bond("V -> j -> r", "j -> c")
    found = hb.frequency_response(m, input="V", output="c.e", frequencies=[1.0], windows=16)
    # the start decays with 1000 s; 16 s say that it is not over
    assert not found.ok and found.left[0] > 1e-2 and "NOT SETTLED" in str(found)
    assert found.windows.tolist() == [16]


def test_what_is_left_over_is_no_less_than_it_is() -> None:
    for ratio in (0.3, 0.9, 0.97, 0.9 * np.exp(0.4j), 0.95 * np.exp(2.0j)):
        for many in (16, 32, 64):
            series = 1.0 + 0.2 * ratio ** np.arange(many)
            off = abs(series[-1] - 1.0) / abs(series[-1])
            assert left_over(series + 0j) >= 0.5 * off


def test_windows_hold_whole_periods_of_both() -> None:
    for f in (37.0, 160.0, 1234.0, 9999.0, 33e3, 61e3):
        w = window_of(f, 1e-5)
        assert w.length == pytest.approx(w.cycles * 1e-5, rel=1e-12)
        assert w.length == pytest.approx(w.turns / w.frequency, rel=1e-12)
        assert w.frequency == pytest.approx(f, rel=3e-2)
    with pytest.raises(HybondError, match="cannot be told from") as refused:
        window_of(1e5, 1e-5)
    assert refused.value.code == "HB-A509"


def test_periods_are_found_or_asked_for() -> None:
    assert period_of(buck().flatten()) == pytest.approx(1e-5)
    m = hb.Model("ramp")
    m.add(V=hb.Se("exp(-time/(1 s)) + u"), j=hb.One(), r=hb.R(1.0), c=hb.C(1.0))
    m.bond("V -> j -> r", "j -> c")
    m.input(u=1.0)
    with pytest.raises(HybondError, match="need not repeat") as refused:
        hb.frequency_response(m, input="u", output="c.e", frequencies=[1.0])
    assert refused.value.code == "HB-A511"
    found = hb.frequency_response(m, input="u", output="c.e", frequencies=[0.5], period=0.5)
    np.testing.assert_allclose(found.response, 1 / (1 + 1j * np.pi), rtol=1e-3)


def test_an_input_is_replaced_wherever_it_is_read() -> None:
    graph = injected(buck().flatten(), "d", 0.1, 50.0)
    texts = [rule.guard for rule in graph.machines[0].rules]
    assert all("sin" in str(e) for e in texts)
    with pytest.raises(HybondError) as refused:
        injected(graph, "T", 0.1, 50.0)
    assert refused.value.code == "HB-A501" and "input of the model" in refused.value.hint


def test_an_amplitude_is_wanted_where_there_is_none() -> None:
    m = buck()
    m.elements["zero"] = hb.Se("0 V")
    with pytest.raises(HybondError, match="zero is zero at the start") as refused:
        hb.frequency_response(m, input="zero", output="out.e", frequencies=[1e3])
    assert refused.value.code == "HB-A509"


def test_the_plot_has_open_circles_where_it_has_not_settled(tmp_path: Path) -> None:
    m = hb.Model("rc")
    m.add(V=hb.Se(1.0), j=hb.One(), r=hb.R(1.0), c=hb.C(1.0))
    m.bond("V -> j -> r", "j -> c")
    found = hb.frequency_response(m, input="V", output="c.e", frequencies=[0.05, 5.0], windows=8)
    assert found.settled.tolist() == [True, False]
    lin = hb.linearise(m, inputs=["V"], outputs=["c.e"])
    figure = found.plot(tmp_path / "r.png", beside=lin.bode())
    circles = [line for line in figure.axes[0].lines if line.get_marker() == "o"]
    assert [len(line.get_xdata()) for line in circles] == [1, 1]
    assert circles[1].get_markerfacecolor() == "white"


def test_a_duty_that_is_sampled_comes_late() -> None:
    """Pulses that end at the duty of the period's begin: each moves its edge at ``n T + D T``, so
    that to small sines the modulator is a delay of D T (D. M. Van de Sype et al., *Small-signal
    Laplace-domain analysis of uniformly-sampled pulse-width modulators*, PESC 2004)."""
    m = buck()
    m.signal(held=hb.Sampled("d", every="T", start=0.4))
    m.machines.clear()
    m.machine(
        "leg",
        states={"up": ["high"], "down": ["low"]},
        start="up",
        rules=["up -> down when mod(time, T)/T >= held", "down -> up when mod(time, T)/T < held"],
    )
    found = hb.frequency_response(
        m, input="d", output="out.e", frequencies=["4 kHz", "20 kHz"], amplitude=0.002
    )
    s = 2j * np.pi * found.frequencies
    late = 12.0 / (1 + s * 100e-6 / 2 + s * s * 1e-8) * np.exp(-s * 0.4 * 1e-5)
    assert found.ok
    np.testing.assert_allclose(found.response, late, rtol=1e-3)


def test_a_nonlinear_model_around_its_rest_as_its_linearisation() -> None:
    """Two ways that share nothing: derivatives of laws, and a run. They differ by the square of
    the amplitude, a hundredth of the flow."""
    m = hb.Model("tank", domain="hydraulic")
    m.add(Q=hb.Sf("1 l/s"), tank=hb.C("5 l/bar", q="1.25 l"), n=hb.Zero())
    m.add(out=hb.R({"f": "1 [l/s]*sqrt(e/(25 kPa))"}))
    m.bond("Q -> n -> tank", "n -> out")
    lin = hb.linearise(m, inputs=["Q"], outputs=["out.f"], at="equilibrium")
    for part, close in ((1e-2, 1e-4), (1e-3, 2e-6)):
        found = hb.frequency_response(
            m,
            input="Q",
            output="out.f",
            frequencies=[0.05],
            amplitude=part * 1e-3,
            tolerance=1e-7,
            rtol=1e-11,
        )
        off = abs(found.response[0] / lin.bode([0.05]).response[0] - 1)
        assert found.ok and off < close
        # twice the frequency comes with the amplitude, and is what makes it nonlinear
        assert 0.01 * part < found.distortion[0] < part


def test_the_limit_of_friction_while_it_slips() -> None:
    """An input that a law of a junction reads: the mass moves by ``m v' = F - d v - limit``."""
    m = hb.Model("brake", domain="translational")
    m.add(F=hb.Se("20 N"), v=hb.One(law="coulomb", limit="L"), m=hb.I("1 kg"), d=hb.R("2 N*s/m"))
    m.bond("F -> v -> m", "v -> d")
    m.input(L="5 N")
    found = hb.frequency_response(m, input="L", output="v.f", frequencies=[0.5])
    s = 2j * np.pi * 0.5
    assert found.ok and found.response[0] == pytest.approx(-1 / (s + 2), rel=1e-6)
    lin = hb.linearise(hb.simulate(m, until="10 s"), inputs=["L"], outputs=["v.f"])
    assert lin.mode == {"v": "forward"}
    assert lin.transfer(s)[0, 0] == pytest.approx(-1 / (s + 2), rel=1e-12)


def driven(value: str, *, turned: bool) -> hb.Model:
    """Return a capacitor behind a resistor, and a source that reads the input u, of 5 V."""
    m = hb.Model("rc", domain="electrical")
    m.add(V=hb.Se(value), j=hb.One(), r=hb.R(10.0), c=hb.C(1e-4))
    m.bond("j -> V" if turned else "V -> j", "j -> r", "j -> c")
    m.input(u=5.0)
    return m


# the amplitude is a hundredth of what the input has at the start
@pytest.mark.parametrize("value", ["u", "2*u + 1", "u + 3*cos(2*pi*150*time)"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_source_that_reads_an_input_is_asked(value: str, turned: bool) -> None:
    m = driven(value, turned=turned)
    found = hb.frequency_response(m, input="V", output="c.e", frequencies=[100.0])
    s = 2j * np.pi * found.frequencies[0]
    way = -1.0 if turned else 1.0
    assert found.ok
    assert abs(found.response[0] - way / (1 + s * 10.0 * 1e-4)) < 1e-3


@pytest.mark.parametrize("turned", [False, True])
def test_a_source_in_its_own_loop_is_asked_with_an_amplitude(turned: bool) -> None:
    """At 5 V the source is half an ohm in the loop, of the sign of its bond."""
    m = driven("u*(1 - r.f/(10 A))", turned=turned)
    found = hb.frequency_response(m, input="V", output="c.e", frequencies=[100.0], amplitude=0.01)
    s = 2j * np.pi * found.frequencies[0]
    way = -1.0 if turned else 1.0
    assert found.ok
    assert abs(found.response[0] - way / (1 + s * (10.0 + way * 0.5) * 1e-4)) < 1e-3
    with pytest.raises(hb.UsageError, match="HB-A509"):
        hb.frequency_response(m, input="V", output="c.e", frequencies=[100.0])
