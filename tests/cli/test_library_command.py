"""``hybond library``."""

from typing import Any

import pytest

import hybond as hb


@pytest.mark.slow
def test_it_lists_every_part_under_its_domain(shell: Any) -> None:
    done = shell("library")
    assert done.code == 0
    assert {line.split()[0] for line in done.out.splitlines() if line.startswith("  ")} == set(
        hb.library.names()
    )
    assert done.out.startswith(hb.library.names()[0].partition(".")[0] + "\n")


def test_a_domain_is_listed_alone(shell: Any) -> None:
    lines = shell("library", "electrical").out.splitlines()
    assert lines[0] == "electrical"
    assert all(line.startswith("  electrical.") for line in lines[1:])


def test_one_part_says_all_a_user_has_to_know(shell: Any) -> None:
    out = shell("library", "electrical.switch").out
    for word in ("electrical.switch", "Ideal switch.", "plus", "gate", "closed above 0.5", "R_on"):
        assert word in out
    assert "ports\n  plus" in out and "signals\n  voltage" in out


def test_a_file_can_be_kept_and_is_the_same_model(shell: Any) -> None:
    shell.file("mine.toml", shell("library", "electrical.diode", "--file").out)
    mine = hb.load(shell.folder / "mine.toml")
    assert mine.elements == hb.library.part("electrical.diode").elements


def test_an_unknown_part_and_a_file_of_no_part_are_refused(shell: Any) -> None:
    done = shell("library", "electrical.diod")
    assert done.code == 1 and "HB-X110" in done.err and "'electrical.diode'" in done.err
    assert shell("library", "--file").code == 1


@pytest.mark.slow
def test_a_word_finds_parts_by_name_and_title(shell: Any) -> None:
    lines = shell("library", "Diode").out.splitlines()
    found = [line.split()[0] for line in lines]
    assert {"electrical.diode", "electrical.diode_bridge", "electrical.igbt"} <= set(found)
    assert all("diode" in line.lower() for line in lines)
    done = shell("library", "flux_capacitor")
    assert done.code == 1 and "did you mean 'capacitor'" in done.err
    done = shell("library", "qqqq")
    assert done.code == 1 and "hybond library lists them all" in done.err


def test_the_line_that_a_part_shows_is_one_of_a_model_file(shell: Any) -> None:
    for part in ("electrical.diode", "electrical.ground", "electrical.resistor"):
        line = shell("library", part).out.splitlines()[-1]
        model = hb.loads(f"hybond = 1\n[elements]\n{line}")
        assert model.flatten().nodes
