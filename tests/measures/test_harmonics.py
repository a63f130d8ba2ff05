"""Harmonics and distortion against Fourier series of textbooks."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def test_the_distortion_of_a_square_wave(waves: hb.Result) -> None:
    square = waves["square"]
    wanted = math.sqrt(math.pi**2 / 8 - 1)
    assert float(square.thd("50 Hz", periods=5)) == pytest.approx(wanted, rel=1e-8)
    assert float(square.thd("20 ms")) == pytest.approx(wanted, rel=1e-8)
    odd = math.sqrt(sum(1 / k**2 for k in range(3, 16, 2)))
    assert float(square.thd(50, harmonics=15)) == pytest.approx(odd, rel=1e-8)
    found = square.spectrum(50, harmonics=9)
    wanted_lines = [4 / (math.pi * k) if k % 2 else 0.0 for k in range(1, 10)]
    assert found.amplitude == pytest.approx(wanted_lines, abs=1e-9)
    assert found.frequency == pytest.approx(50.0 * np.arange(1, 10))
    # sines: a phase of -90 degrees against cosines
    assert found.phase[::2] == pytest.approx(-math.pi / 2, abs=1e-8)


def test_a_half_wave_rectified_sine(waves: hb.Result) -> None:
    found = waves["half"].spectrum(50, harmonics=6, periods=2)
    even = {k: 2 / (math.pi * (k * k - 1)) for k in (2, 4, 6)}
    wanted = [0.5, even[2], 0.0, even[4], 0.0, even[6]]
    assert found.amplitude == pytest.approx(wanted, abs=1e-10)
    assert found.mean == pytest.approx(1 / math.pi, rel=1e-10)
    assert found.rms == pytest.approx(0.5, rel=1e-10)
    rest = math.sqrt(0.25 - 1 / math.pi**2 - 0.125)
    distortion = rest / (0.5 / math.sqrt(2))
    assert float(waves["half"].thd(50)) == pytest.approx(distortion, rel=1e-8)
    assert found.to_pandas().index[1] == pytest.approx(100.0)
    assert "0 Hz" in str(found) and found.to_dict()["how"] == ""


def test_impulses_are_in_the_spectrum() -> None:
    # a comb of equal impulses has lines of equal height, twice its mean
    m = hb.Model("hammer", domain="translational")
    steps = " + ".join(f"(if time >= {k}.5 then 1 [m/s] else 0)" for k in range(5))
    m.add(mass=hb.I("1 kg", f="0 m/s"), v=hb.One(), push=hb.Sf(steps))
    m.bond("v -> mass", "push -> v")
    run = hb.simulate(m, until="5 s")
    found = run["mass.e"].spectrum("1 Hz", harmonics=7, start="1 s", periods=3)
    assert found.mean == pytest.approx(1.0)
    assert found.amplitude == pytest.approx(np.full(7, 2.0))
    assert found.how == "3 impulses included" and math.isnan(found.rms)
    # at half a period: lines change sign
    assert np.cos(found.phase) == pytest.approx([-1, 1, -1, 1, -1, 1, -1])


def test_windows_must_be_whole_periods(waves: hb.Result) -> None:
    with pytest.raises(hb.UsageError) as refused:
        waves["half"].spectrum(50, start=0, end="50 ms")
    assert refused.value.code == "HB-R109"
    with pytest.raises(hb.UsageError) as refused:
        waves["square - square"].thd(50)
    assert refused.value.code == "HB-R110"
    with pytest.raises(hb.UsageError, match="HB-R101"):
        waves["half"].thd("50 V")
