"""Tables and pulses with a unit that does not belong there: times in kg were taken for seconds."""

from __future__ import annotations

from typing import Any

import pytest

import hybond as hb


def circuit(u: hb.Input, r: hb.R) -> hb.Model:
    """Return a source that an input drives, and a resistor."""
    m = hb.Model("units", domain="electrical")
    m.add(V=hb.Se("u"), r=r, i=hb.One())
    m.bond("V -> i -> r")
    m.input(u=u)
    return m


@pytest.mark.parametrize(
    ("given", "place", "says"),
    [
        ({"table": [["0 kg", "1 V"], ["1 kg", "2 V"]]}, "table[0][0]", "in kg; this place wants s"),
        ({"table": [[0, "1 V"], ["1 s", "2 A"]]}, "table[1][1]", "in A; this place wants V"),
        (
            {"table": [[0, "1 V"], [1, "2 V"]], "period": "3 V"},
            "period",
            "in V; this place wants s",
        ),
        ({"pwm": {"period": "1 kg", "duty": 0.5}}, "pwm.period", "in kg; this place wants s"),
        ({"pwm": {"period": 1, "duty": "0.5 s"}}, "pwm.duty", "in s; this place wants a plain"),
        (
            {"pwm": {"period": 1, "duty": 0.5, "phase": "1 V"}},
            "pwm.phase",
            "in V; this place wants s",
        ),
        ({"pwm": {"period": 1, "duty": 0.5, "high": "1 V", "low": "1 A"}}, "pwm.low", "wants V"),
    ],
)
def test_inputs_in_units_that_do_not_fit(given: dict[str, Any], place: str, says: str) -> None:
    with pytest.raises(hb.HybondError) as refused:
        circuit(hb.Input(**given), hb.R(1)).flatten()
    error = refused.value
    assert error.code == "HB-U103" and f"inputs.u.{place}" in f"{error}" and says in f"{error}"
    assert error.hint


@pytest.mark.parametrize(
    ("law", "says"),
    [
        ({"e": {"table": [["0 A", "1 A"], ["0 V", "1 A"]]}}, "in A; this place wants V"),
        ({"e": {"table": [["0 V", "1 V"], ["0 V", "1 V"]]}}, "in V; this place wants A"),
        ({"f": {"table": [[0, "1 A"], [0, "1 A"]]}}, "in A; this place wants V"),
    ],
)
def test_table_laws_in_units_that_do_not_fit(law: dict[str, Any], says: str) -> None:
    with pytest.raises(hb.HybondError, match="HB-U103") as refused:
        circuit(hb.Input(constant="1 V"), hb.R(law)).flatten()
    assert says in f"{refused.value}"


def test_tables_with_units_that_fit() -> None:
    u = hb.Input(table=[[0, "0 V"], ["1 ms", "2 V"], [2e-3, 2]], linear=True, period="2 ms")
    m = circuit(u, hb.R({"f": {"table": [["-10 V", 0, "10 V"], ["-5 A", 0, 5]]}}))
    m.input(p=hb.Input(pwm={"period": "1 ms", "duty": "40 %", "high": "1 V", "low": 0}))
    assert float(hb.simulate(m, "1 ms")["i.f"].at(0.5e-3)) == pytest.approx(0.5)
