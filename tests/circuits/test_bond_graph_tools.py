"""Files that BondGraphTools 0.4.6 wrote, against the state equations that it derives from them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb

FILES = Path(__file__).parent / "files"
HEAD = "version: '0.1'\nroot: x\nmodels:\n  /:\n    components:\n"


def solution(a, b, t):
    """x(t) from rest of x' = a x + b."""
    n = len(b)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = a, b
    return expm(whole * t)[:n, n]


def test_motor_with_gear_and_gyrator():
    run = hb.simulate(hb.read_bond_graph(FILES / "motor.bg").model, until=2)
    # dx_0 + 4*x_0 - 4*x_1 - 10, dx_1 + 4*x_0/5 + 3*x_1 + 5*x_2/3, dx_2 - 10*x_1/3 - 1/2
    a = [[-4, 4, 0], [-4 / 5, -3, -5 / 3], [0, 10 / 3, 0]]
    for t in (0.3, 1.0, 2.0):
        found = [run[s].at(t) for s in ("La.p", "rotor.p", "spring.q")]
        assert found == pytest.approx(solution(a, [10, 0, 0.5], t), rel=1e-6)


def test_submodels_and_exposed_ports():
    conversion = hb.read_bond_graph(FILES / "two.bg")
    run = hb.simulate(conversion.model, until=2)
    # dx_0 + 2*x_0 - x_1 - 1/2, dx_1 - x_0 + 5*x_1/3
    for t in (0.3, 2.0):
        found = [run["a_C.q"].at(t), run["b_C.q"].at(t)]
        assert found == pytest.approx(solution([[-2, 1], [1, -5 / 3]], [0.5, 0], t), rel=1e-6)
    kinds = [part.kind for part in conversion.model.elements.values()]
    assert kinds.count("0") == 2  # the exposed ports are bonds
    assert conversion.warnings == ()


def test_bonds_against_their_ports_and_a_gyrator_that_ties_storage():
    run = hb.simulate(hb.read_bond_graph(FILES / "odd.bg").model, until=1)
    # dx_0 + 2*x_0 + 7*x_2/2 - 2, dx_1 + 98*x_0/129 - (0.2713...)*x_2 - 49/430, x_1 + 7*x_2/8
    b, c = 67829457364341 / 250000000000000, 434108527131783 / 500000000000000
    a = [[-2, 0, -3.5], [-98 / 129, 0, b], [c, 0, -40 / 129]]
    for t in (0.2, 1.0):
        found = [run[s].at(t) for s in ("L.p", "C.q", "J.p")]
        assert found == pytest.approx(solution(a, [2, 49 / 430, -28 / 215], t), rel=1e-6)
        assert found[1] == pytest.approx(-7 / 8 * found[2])


def test_a_source_without_value_is_an_input(tmp_path):
    path = tmp_path / "x.bg"
    path.write_text(HEAD + "    - V base/Se\n    - R base/R\n    netlist:\n    - V R\n")
    conversion = hb.read_bond_graph(path)
    assert conversion.model.elements["V"].value in conversion.model.inputs
    assert conversion.model.elements["R"].value == 1000.0  # of the library
    assert len(conversion.warnings) == 1
    with pytest.raises(hb.FileError) as caught:
        hb.read_bond_graph(path, strict=True)
    assert caught.value.code == "HB-F145"


@pytest.mark.parametrize("tail", [True, False])
def test_a_flow_source_delivers_whichever_way_its_bond_points(tmp_path, tail):
    path = tmp_path / "x.bg"
    bond = "S R" if tail else "R S"
    path.write_text(HEAD + f"    - S base/Sf f=2\n    - R base/R r=3\n    netlist:\n    - {bond}\n")
    run = hb.simulate(hb.read_bond_graph(path).model, until=1)
    # f_0 of R is 2, e_0 = 6: power 12 goes into R
    power = run["R.e"].at(0.5) * run["R.f"].at(0.5) * (1 if tail else -1)
    assert power == pytest.approx(12.0)
    assert run["R.e"].at(0.5) == pytest.approx(6.0)


def test_a_diode_has_its_exponential_law(tmp_path):
    path = tmp_path / "x.bg"
    path.write_text(
        HEAD + "    - V base/Se e=0.5\n    - D elec/Di Is=1e-9\n    netlist:\n    - V D\n"
    )
    run = hb.simulate(hb.read_bond_graph(path).model, until=1)
    assert run["D.f"].at(0.5) == pytest.approx(1e-9 * (np.exp(0.5 / 0.0258563) - 1))


R = "    - R base/R\n    - V base/Se e=1\n"
WRONG = {
    "not yaml": ("{", "HB-F150"),
    "empty": ("", "HB-F150"),
    "a list": ("[1, 2]", "HB-F150"),
    "a version of the future": ("version: '2'\nroot: x\nmodels: {/: {components: []}}", "HB-F150"),
    "an alias": ("version: '0.1'\na: &a [1]\nmodels: *a\n", "HB-F150"),
    "a key twice": ("version: '0.1'\nversion: '0.1'\nmodels: {}\n", "HB-F150"),
    "a python object": ("!!python/object/apply:os.system ['true']", "HB-F150"),
    "no root": ("version: '0.1'\nmodels: {}\n", "HB-F150"),
    "deep": ("[" * 5000, "HB-F150"),
    "unknown kind": (HEAD + "    - X base/Q\n", "HB-F151"),
    "port-Hamiltonian": (HEAD + "    - X base/PH\n", "HB-F151"),
    "reaction": (HEAD + "    - X BioChem/Re\n", "HB-F151"),
    "no number": (HEAD + "    - R base/R r=big\n", "HB-F151"),
    "infinite": (HEAD + "    - R base/R r=inf\n", "HB-F151"),
    "no such parameter": (HEAD + "    - R base/R q=1\n", "HB-F151"),
    "one word": (HEAD + "    - R\n", "HB-F151"),
    "open source sensor": (HEAD + R + "    - S base/SS\n    netlist:\n    - V R\n", "HB-F151"),
    "name twice": (HEAD + "    - R base/R\n    - R base/R\n", "HB-F152"),
    "bond to nothing": (HEAD + R + "    netlist:\n    - V Q\n", "HB-F152"),
    "bond of three": (HEAD + R + "    netlist:\n    - V R V\n", "HB-F152"),
    "no such port": (HEAD + R + "    netlist:\n    - V R.4\n", "HB-F152"),
    "no bond": (HEAD + R, "HB-F152"),
    "no such model": (HEAD + "    - s /s\n", "HB-F152"),
    "itself": (HEAD + "    - s /\n", "HB-F152"),
    "numbers": (HEAD + "    - 5\n", "HB-F150"),
}


@pytest.mark.sampled(22)
@pytest.mark.parametrize("name", WRONG)
def test_what_has_no_meaning_is_refused(tmp_path, name):
    text, code = WRONG[name]
    path = tmp_path / "x.bg"
    path.write_text(text)
    with pytest.raises(hb.HybondError) as caught:
        hb.read_bond_graph(path)
    assert caught.value.code == code
    assert str(path) in caught.value.where
    assert caught.value.hint
