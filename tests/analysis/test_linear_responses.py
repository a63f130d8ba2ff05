"""Steps, Bode, margins, zeros of a linearisation: SciPy and closed forms say what is right."""

import math
from pathlib import Path

import numpy as np
import pytest
import scipy

import hybond as hb
from hybond.analysis.linear.linearisation import Linearisation
from hybond.analysis.linear.margins import margins_of
from hybond.errors import HybondError


def filtered(drag: float = 0.3) -> Linearisation:
    m = hb.Model("filter", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R(drag), l=hb.I("0.5 mH"), n=hb.Zero())
    m.add(c=hb.C("10 uF"), esr=hb.R("0.2 ohm"), j=hb.One(), load=hb.R("50 ohm"))
    m.bond("V -> i -> r", "i -> l", "i -> n -> j -> c", "j -> esr", "n -> load")
    return hb.linearise(m, inputs=["V"], outputs=["n.e", "i.f"])


def test_steps_as_scipy_has_them_bode_and_zeros_in_closed_form() -> None:
    lin = filtered()
    system = scipy.signal.StateSpace(lin.A, lin.B, lin.C, lin.D)
    step = lin.step("2 ms", points=400)
    _, y = scipy.signal.step(system, T=step.t)
    # an exponential from point to point, against the interpolation of SciPy: both exact
    np.testing.assert_allclose(step.y[:, :, 0], y, rtol=1e-8, atol=1e-9)
    bode = lin.bode(np.logspace(1, 6, 40), output="n.e")
    w = 2j * np.pi * bode.frequencies
    node = 1 / (1 / (0.2 + 1 / (w * 10e-6)) + 1 / 50.0)
    current = 1 / (0.3 + w * 0.5e-3 + node)
    np.testing.assert_allclose(bode.response, node * current, rtol=1e-10)
    phase = np.degrees(np.unwrap(np.angle(node * current)))
    np.testing.assert_allclose(bode.phase, phase, rtol=1e-9)
    np.testing.assert_allclose(
        bode.decibels, 20 * np.log10(np.abs(node * current)), rtol=1e-9, atol=1e-9
    )
    # the resistor in series with the capacitor makes the zero, and only that
    assert lin.zeros(output="n.e") == pytest.approx([-1 / (0.2 * 10e-6)], rel=1e-9)
    assert lin.zeros(output="i.f") == pytest.approx([-1 / (50.2 * 10e-6)], rel=1e-9)
    assert lin.to_scipy().A.shape == (2, 2)


def test_zeros_of_as_many_inputs_as_outputs() -> None:
    m = hb.Model("two")
    m.add(
        a=hb.Se(1.0), b=hb.Sf(1.0), j=hb.One(), l=hb.I(2.0), n=hb.Zero(), c=hb.C(3.0), r=hb.R(5.0)
    )
    m.bond("a -> j -> l", "j -> n -> c", "b -> n", "n -> r")
    lin = hb.linearise(m, inputs=["a", "b"], outputs=["l.f", "c.e"])
    # the determinant of the transfer matrix is 1/(L C s^2 + ...): no zero at all
    assert len(lin.zeros()) == 0
    with pytest.raises(HybondError, match="no zeros in common") as refused:
        hb.linearise(m, inputs=["a"], outputs=["l.f", "c.e"]).zeros()
    assert refused.value.code == "HB-A508"


def test_margins_of_a_loop_in_closed_form() -> None:
    # 400/(s (1 + s/1000)^2): turned by half a turn at 1000 rad/s, where it is 0.2
    def loop(f: np.ndarray) -> np.ndarray:
        s = 2j * np.pi * f
        return 400 / (s * (1 + s / 1000) ** 2)

    found = margins_of(loop, np.logspace(-1, 5, 301))
    assert found.gain == pytest.approx(5.0, rel=1e-12)
    assert found.gain_at == pytest.approx(1000 / (2 * np.pi), rel=1e-9)
    # |L| = 1 where w (1 + w^2) = 0.4 in units of 1000 rad/s; a cubic
    (w,) = (x.real for x in np.roots([1.0, 0.0, 1.0, -0.4]) if abs(x.imag) < 1e-12)
    assert found.phase == pytest.approx(90.0 - 2 * np.degrees(np.arctan(w)), rel=1e-10)
    assert found.phase_at == pytest.approx(1000 * w / (2 * np.pi), rel=1e-10)
    # twice the margin: the loop has grown past it, and the margin is a reduction
    grown = margins_of(lambda f: 10.0 * loop(f), np.logspace(-1, 5, 301))
    assert grown.gain == pytest.approx(0.5, rel=1e-12) and grown.phase < 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_pole_on_the_axis_is_no_crossing(sign: float) -> None:
    """A gain margin of nan was told, or one of nothing, at the frequency of an undamped swing."""

    def loop(f: np.ndarray) -> np.ndarray:
        s = 2j * np.pi * f
        with np.errstate(all="ignore"):
            return sign * s / (s * s + 100.0) - 1e-3

    # never real but at the pole, where its sign turns
    found = margins_of(loop, np.logspace(-3, 3, 301))
    assert found.gain is None and found.gain_at is None
    at = 2 * np.pi * found.phase_at
    assert abs(at * at - 100.0) == pytest.approx(at / math.sqrt(1 - 1e-6), rel=1e-9)


def test_a_pole_at_the_origin_has_no_gain_at_rest() -> None:
    m = hb.Model("free", domain="translational")
    m.add(F=hb.Se("1 N"), v=hb.One(), m=hb.I("2 kg"))
    m.bond("F -> v -> m")
    m.signal(x=hb.Integral("v.f"))
    lin = hb.linearise(m, inputs=["F"], outputs=["x"])
    assert lin.poles().tolist() == [0.0, 0.0] and np.isinf(lin.gain()).all()
    assert lin.transfer(2.0j)[0, 0] == pytest.approx(1 / (2.0 * (2.0j) ** 2), rel=1e-12)
    assert lin.margins().phase == pytest.approx(0.0, abs=1e-9)
    # x = t^2/(2 m), exactly
    step = lin.step(3.0, points=4)
    assert step.y[:, 0, 0] == pytest.approx(step.t**2 / 4.0, rel=1e-12)


@pytest.mark.slow
def test_plots_show_what_was_computed(tmp_path: Path) -> None:
    lin = filtered()
    bode = lin.plot_bode(tmp_path / "bode.svg", output="n.e")
    upper, lower = bode.axes
    shown = upper.lines[0].get_xydata()
    own = lin.bode()
    np.testing.assert_allclose(shown[:, 1], own.decibels)
    assert any("phase margin" in t.get_text() for t in upper.texts)
    assert lower.get_xlabel() == "frequency [kHz]" and "dB" in upper.get_ylabel()
    both = lin.plot_bode().axes[0]
    assert [t.get_text() for t in both.get_legend().get_texts()] == ["n.e / V", "i.f / V [A/V]"]
    for line, name in zip(both.lines, ("n.e", "i.f"), strict=True):
        x, y = line.get_xydata().T
        np.testing.assert_allclose(y, lin.bode(x * 1e3, output=name).decibels)
    poles = lin.plot_poles(tmp_path / "poles.png", output="n.e")
    crosses = poles.axes[0].lines[2].get_xydata()
    assert sorted(crosses[:, 0] + 1j * crosses[:, 1], key=abs) == pytest.approx(
        sorted(lin.poles(), key=abs)
    )
    step = lin.plot_step(tmp_path / "step.pdf")
    assert [ax.get_ylabel() for ax in step.axes] == ["n.e [V]", "i.f [A]"]
    lin.plot_nyquist(tmp_path / "nyquist.png")
    assert {p.name for p in tmp_path.iterdir()} == {
        "bode.svg",
        "poles.png",
        "step.pdf",
        "nyquist.png",
    }


def test_words_and_data() -> None:
    lin = filtered()
    text = str(lin)
    assert "linear in this mode" in text and "V (1 V)" in text and "pole" in text
    assert "<table>" in lin._repr_html_() and "l.p" in lin._repr_html_()
    data = lin.to_data()
    assert data["A"] == lin.A.tolist() and data["poles"][0][0] == lin.poles()[0].real


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda lin: lin.bode(input="W"), "HB-A501"),
        (lambda lin: lin.bode([0.0]), "HB-A509"),
        (lambda lin: lin.bode(["3 m"]), "HB-A509"),
        (lambda lin: lin.step(-1.0), "HB-A509"),
    ],
)
def test_refusals(call: object, code: str) -> None:
    with pytest.raises(HybondError) as refused:
        call(filtered())  # type: ignore[operator]
    assert refused.value.code == code


def test_control_has_the_same_response() -> None:
    control = pytest.importorskip("control", reason="python-control is not installed")
    lin = filtered()
    other = lin.to_control()
    assert isinstance(other, control.StateSpace)
    at = 2j * np.pi * 3e3
    np.testing.assert_allclose(np.atleast_2d(other(at)), lin.transfer(at), rtol=1e-10)
