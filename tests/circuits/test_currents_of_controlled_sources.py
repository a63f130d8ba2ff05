"""F, H and W follow the current of an E or H, too: SPICE has one for each source of a voltage."""

import pytest

import hybond as hb


@pytest.fixture
def read(tmp_path):
    def one(*rows):
        deck = tmp_path / "test.cir"
        deck.write_text("\n".join(["Currents", *rows, ".end", ""]))
        return hb.read_circuit(deck)

    return one


@pytest.mark.parametrize(
    ("rows", "value"),
    [
        (("F1 0 d E1 2", "R2 d 0 1k"), 8.0),
        (("H1 d 0 E1 3k", "R2 d 0 1k"), 12.0),
        (("H1 k 0 E1 3k", "R3 k 0 1k", "F1 0 d H1 0.5", "R2 d 0 1k"), -6.0),
        (("W1 a d E1 above", "R2 d 0 999", ".model above CSW(IT=3m RON=1 ROFF=1g)"), 9.99),
        (("W1 a d E1 above", "R2 d 0 999", ".model above CSW(IT=5m RON=1 ROFF=1g)"), 0.0),
    ],
)
def test_what_follows_the_current_of_a_source_that_follows(read, rows, value):
    """Of 10 V in 1 kohm, against 1.5 times what drops there: 4 mA; it was refused (HB-F134)."""
    conversion = read(
        "V1 a 0 10", "R1 a b 1k", "E1 b 0 a b 1.5", *rows, "C1 d 0 1n", ".tran 1u 1m uic"
    )
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    assert float(run[conversion.signal("v(d)")].at(1e-3)) == pytest.approx(value, abs=1e-6)


def test_what_has_no_current_of_its_own_is_told_an_ammeter(read):
    with pytest.raises(hb.FileError, match="'r1' is no voltage source") as told:
        read("V1 a 0 10", "R1 a b 1k", "C1 b 0 1u", "F1 0 d R1 2", "R2 d 0 1k", ".tran 1u 1m uic")
    assert "0 V makes an ammeter" in told.value.hint
