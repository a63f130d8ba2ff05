"""Circuits whose rest is that of the resistances of open switches, as a sample and hold has it."""

import pytest

import hybond as hb


@pytest.fixture
def read(tmp_path):
    def one(*rows):
        deck = tmp_path / "test.cir"
        deck.write_text("\n".join(["Leaks", *rows, ".end", ""]))
        return hb.read_circuit(deck)

    return one


CLOCK = "Vck ck 0 PULSE(0 5 1m 1u 1u 0.5m 2m)"


@pytest.mark.parametrize(
    ("rows", "start"),
    [
        (("S1 in h ck 0 a", "C1 h 0 1n"), 3.0),
        (("S1 in h ck 0 a", "S2 h 0 ck 0 b", "C1 h 0 1n"), 2.0),  # 1 Gohm and 2 Gohm
        (("S1 in h ck 0 a", "C1 h 0 1n", "E2 k 0 h 0 2", "S2 k m ck 0 a", "C2 m 0 1n"), 3.0),
    ],
)
def test_a_capacitor_behind_open_switches_starts_from_what_leaks_to_it(read, rows, start):
    """It was refused (HB-F143); ngspice starts from there, too."""
    models = (".model a SW(VT=2.5 RON=100 ROFF=1g)", ".model b SW(VT=2.5 RON=100 ROFF=2g)")
    conversion = read("V1 in 0 3", CLOCK, *rows, *models, ".tran 10u 3m")
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    assert float(run["C1.e"].at(0.5e-3)) == pytest.approx(start, rel=1e-6)
    if "C2 m 0 1n" in rows:
        assert float(run["C2.e"].at(0.5e-3)) == pytest.approx(2 * start, rel=1e-6)
    told = [str(w) for w in conversion.warnings if "it starts from that" in str(w)]
    assert len(told) == 1
    assert "test.cir:" in told[0]
    assert "C1 may hold anything but for ROFF" in told[0]


def test_what_no_switch_leads_to_is_refused_as_ever(read):
    with pytest.raises(hb.FileError, match="C2 may hold anything") as told:
        read(
            "V1 in 0 3", CLOCK, "S1 in h ck 0 a", "C1 h 0 1n", "C2 h k 1n", "C3 k 0 1n",
            ".model a SW(VT=2.5 RON=100 ROFF=1g)", ".tran 10u 3m",
        )  # fmt: skip
    assert told.value.code == "HB-F143"
