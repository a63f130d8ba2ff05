"""equations, analyse."""

import json
from pathlib import Path
from typing import Any

import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def circuit(shell: Any) -> Any:
    for name in ("diagnosis_circuit", "bouncing_ball", "bouncing_ball_no_mode"):
        shell.file(f"{name}.toml", (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))
    return shell


def test_equations_of_all_modes_and_of_one(circuit: Any) -> None:
    done = circuit("equations", "bouncing_ball.toml")
    assert done.code == 0
    assert "ball.p' = -m*g + κ*(pad.q/pad.C - ball.p/(m*damper.G))\n" in done.out
    assert "# κ = 1 when floor is touching" in done.out
    done = circuit("equations", "bouncing_ball.toml", "--mode", "floor=away", "--numbers")
    assert "pad.q' = -10000*pad.q\n" in done.out and "κ" not in done.out


def test_matrices_junctions_transfer(circuit: Any) -> None:
    words = ("--matrices", "--junctions", "--transfer", "--outputs", "contact.e")
    done = circuit("equations", "bouncing_ball.toml", "--mode", "floor=touching", *words)
    assert done.code == 0
    assert "ball.p  -1/(m*damper.G)  1/pad.C" in done.out and "κ" not in done.out
    assert "junction structure" in done.out
    # poles of m s^2 + s/G + 1/C: -0.05 +- 31.62j
    assert "poles -0.05-31.6227j, -0.05+31.6227j 1/s" in done.out


def test_other_forms(circuit: Any) -> None:
    done = circuit("equations", "bouncing_ball.toml", "--latex")
    assert r"\dot{p}_{\mathrm{ball}} &= -m \, g + \kappa" in done.out
    assert done.out.count("{") == done.out.count("}")
    done = circuit("equations", "bouncing_ball.toml", "--markdown")
    assert done.out.startswith("$$\n")
    done = circuit("equations", "bouncing_ball.toml", "--json", "--mode", "floor=touching")
    record = json.loads(done.out)
    assert record["states"] == ["ball.p", "pad.q"]
    assert [0, 1, "κ/pad.C"] in record["A"]
    assert record["numbers"]["A"] == [[-0.1, 1000.0], [-1.0, 0.0]]


def test_structure_of_each_mode(circuit: Any) -> None:
    done = circuit("analyse", "diagnosis_circuit.toml", "--outputs", "De1", "--json")
    assert done.code == 0
    record = json.loads(done.out)
    assert len(record["modes"]) == 4
    assert all(mode["order"] == 2 for mode in record["modes"])
    assert "Per-mode results imply nothing" in circuit("analyse", "diagnosis_circuit.toml").out


def test_restitution_and_the_simplified_model(circuit: Any) -> None:
    words = ("--restitution", "contact", "--dt", "1e-3")
    done = circuit("analyse", "bouncing_ball.toml", *words, "--write", "newton.toml")
    assert done.code == 0
    assert "0.909091" in done.out
    run = hb.simulate(hb.load(circuit.folder / "newton.toml"), until="2.3 s")
    hits = [e.t for e in run.events if e.cause == "guard"]
    assert hits == pytest.approx([0.782062, 2.203993], abs=1e-6)  # published, for e = 1/1.1
    assert circuit("analyse", "bouncing_ball.toml", *words, "--write", "newton.toml").code == 1


@pytest.mark.slow
def test_coverage_names_what_no_mode_covers(circuit: Any) -> None:
    words = ("--coverage", "ball.p=-3..1", "--at", "height=0 mm")
    done = circuit("analyse", "bouncing_ball_no_mode.toml", *words)
    assert done.code == 0
    assert "ball.p from -1 to -0.5: no mode holds" in done.out
    record = json.loads(circuit("analyse", "bouncing_ball_no_mode.toml", *words, "--json").out)
    assert [r["holds"] for r in record["ranges"]] == ["off, off", None, "off, on", "off, off"]
    for wrong in ("ball.p", "ball.p=1", "ball.p=1..x", "=0..1"):
        done = circuit("analyse", "bouncing_ball_no_mode.toml", "--coverage", wrong)
        assert done.code == 1 and done.err.startswith("HB-X101")


def test_options_of_another_analysis_are_refused(circuit: Any) -> None:
    done = circuit("analyse", "bouncing_ball.toml", "--dt", "1e-3")
    assert done.code == 1
    assert done.err.startswith("HB-X101") and "--restitution" in done.err


def test_an_unknown_output_is_refused(circuit: Any) -> None:
    done = circuit("equations", "bouncing_ball.toml", "--outputs", "contct.e")
    assert done.code == 2
    assert "did you mean" in done.err
