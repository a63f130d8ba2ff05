"""Forty decks in the words of ngspice, KiCad and LTspice, none of them edited for hybond."""

import sys
from pathlib import Path

import pytest

import hybond as hb

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

from decks import compare, decks  # noqa: E402

SLOW = {
    *("boost_func", "buck_pwm_bsource", "flyback_k1", "forward", "h_bridge", "kicad_half_bridge"),
    *("ltspice_buck", "ltspice_comparator", "ltspice_ideal_boost", "relaxation", "schematic_buck"),
}
"""These take ngspice longer; the table of docs/circuits.md has them."""


@pytest.mark.parametrize("deck", decks(), ids=lambda path: path.name)
def test_a_deck_is_taken_as_it_is(deck):
    conversion = hb.read_circuit(deck)
    assert conversion.measures
    assert "left out: its form" not in "".join(map(str, conversion.warnings))


def test_there_are_forty():
    assert len(decks()) == 40


@pytest.mark.sampled(3)
@pytest.mark.ngspice
@pytest.mark.parametrize(
    "deck", [d for d in decks() if d.stem not in SLOW], ids=lambda path: path.name
)
def test_measurements_agree_with_ngspice(deck, tmp_path):
    seen = compare(deck, tmp_path)
    assert seen.status == "ok"
    for name, (ours, theirs) in seen.values.items():
        assert ours == pytest.approx(theirs, rel=5e-3), name
