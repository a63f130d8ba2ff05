"""What a start is given by name is what the run has for that name, whichever way bonds point.

Oracle: the value that was given; momentum is that of mass and speed.
"""

from __future__ import annotations

import pytest

import hybond as hb


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["I", "C", "field"])
def test_a_start_by_name_reads_back(kind: str, turned: bool) -> None:
    m = hb.Model("starts", domain="translational")
    if kind == "C":
        m.add(s=hb.C("2 m/N"), n=hb.Zero(), r=hb.R("1 N*s/m"))
        ends, names, factor = ["s"], ["s.e"], 2.0
    elif kind == "I":
        m.add(s=hb.I("2 kg"), n=hb.One(), r=hb.R("1 N*s/m"))
        ends, names, factor = ["s"], ["s.f"], 2.0
    else:
        m.add(s=hb.I([["2 kg", "0 kg"], ["0 kg", "2 kg"]]), n=hb.One(), r=hb.R("1 N*s/m"))
        m.add(w=hb.One(), q=hb.R("1 N*s/m"))
        m.bond("s.2 -> w" if turned else "w -> s.2", "w -> q")
        ends, names, factor = ["s.1"], ["s.1.f", "s.2.f"], 2.0
    m.bond(*(f"{end} -> n" if turned else f"n -> {end}" for end in ends), "n -> r")
    given = {name: 3.0 - 5.0 * k for k, name in enumerate(names)}
    run = hb.simulate(m, "1 s", start=given)
    for name, value in given.items():
        assert float(run[name].at(0.0)) == pytest.approx(value, rel=1e-12)
        stored = name.removesuffix(".e").removesuffix(".f") + (".q" if kind == "C" else ".p")
        sign = -1.0 if turned and kind != "C" else 1.0
        assert float(run[stored].at(0.0)) == pytest.approx(sign * factor * value, rel=1e-12)
    whole = {name: float(run[name].at(0.5)) for name in names}
    again = hb.simulate(m, "1.5 s", start={**whole, "time": 0.5})
    for name in names:
        assert float(again[name].at(1.0)) == pytest.approx(float(run[name].at(1.0)), rel=1e-8)
