"""The bouncing ball of Margetts & Ngwompo: equations (5), (6) and Table 1, symbolically.

The printed matrices, with the mode variable kappa:
(5) [p'; q'; v_R] = [[0, -k, -k, 1], [k, 0, 0, 0], [k, 0, 0, 0]] [v; e_C; e_R; -m g]
(6) p' = -m g - k (q/C + p/(R m)),  q' = k p/m
"""

from pathlib import Path

import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
sympy = pytest.importorskip("sympy")
KAPPA, M, G, C, R = sympy.symbols("κ m g C R", real=True)


@pytest.fixture
def model() -> hb.Model:
    return hb.load(EXAMPLES / "bouncing_ball_margetts.toml")


def test_junction_structure_matrix(model) -> None:
    jsm = hb.junction_matrix(model)
    assert jsm.outputs == ("ball.p'", "pad.q'", "damper.f")
    # a ground that stands still is no input
    assert jsm.inputs == ("ball.f", "pad.e", "damper.e", "weight")
    assert jsm.S.sympy() == sympy.Matrix(
        [
            [0, -KAPPA, -KAPPA, 1],
            [KAPPA, 0, 0, 0],
            [KAPPA, 0, 0, 0],
        ]
    )
    assert jsm.Q.sympy() == sympy.eye(3)
    # the diagonal Boolean matrix: the damper's force is heard in contact only
    assert jsm.active == {"damper.e": (((0, True),),)}


def test_state_equation(model) -> None:
    eq = hb.state_equations(model)
    assert eq.states == ("ball.p", "pad.q")
    found = eq.sympy()
    assert found["E"] == sympy.eye(2)
    want = sympy.Matrix([[-KAPPA / (R * M), -KAPPA / C], [KAPPA / M, 0]])
    assert sympy.simplify(found["A"] - want) == sympy.zeros(2, 2)
    assert found["B"] == sympy.Matrix([1, 0])
    assert eq.text().splitlines()[:2] == [
        "ball.p' = -m*g - κ*(ball.p/(m*R) + pad.q/C)",
        "pad.q' = κ*ball.p/m",
    ]


def test_table_1(model) -> None:
    eq = hb.state_equations(model)
    graph = eq.graph
    away, touching = graph.mode_of({"floor": "away"}), graph.mode_of({"floor": "touching"})
    assert eq.text(away).splitlines()[:2] == ["ball.p' = -m*g", "pad.q' = 0"]
    assert eq.text(touching).splitlines()[:2] == [
        "ball.p' = -ball.p/(m*R) - pad.q/C - m*g",
        "pad.q' = ball.p/m",
    ]
    assert eq.at(away).A.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert eq.at(touching).A.tolist() == [[-0.1, -1000.0], [1.0, 0.0]]


def test_pad_that_relaxes_when_only_the_contact_is_switched() -> None:
    """With one controlled junction the damper relaxes the free pad; for q = 0 it is Table 1."""
    eq = hb.state_equations(hb.load(EXAMPLES / "bouncing_ball.toml"))
    assert eq.text().splitlines()[:2] == [
        "ball.p' = -m*g + κ*(pad.q/pad.C - ball.p/(m*damper.G))",
        "pad.q' = -(1 - κ)*damper.G*pad.q/pad.C - κ*ball.p/m",
    ]
