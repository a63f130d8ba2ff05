"""Two comparators of one slow voltage, `V(x) < 2.5` and `V(x) > 2.5`, each with a switch of a leg.

At 2.5 V neither holds. The voltage takes longer through what is rounding there than an instant
lasts, and the current of the coil was cut off in between, without a word.
"""

import math

import numpy as np
import pytest

import hybond as hb

CROSSED = 0.51e-3
"""The ramp is at 2.5 V in the middle of its millisecond, 10 us before what follows it is."""


@pytest.mark.parametrize("half", [0.01, 1e-5])
@pytest.mark.parametrize("down", [False, True])
@pytest.mark.parametrize("beside", ["", "clamp", "kink"])
def test_the_current_of_a_coil_goes_on(tmp_path, half, down, beside):
    """Whatever else there is: a law with a kink in another circuit made it stop as well."""
    clamped = beside == "clamp"
    bent = ["Vk k 0 SIN(0 1 1k)", "B9 k2 0 V = abs(V(k))", "R9 k2 k3 1k", "C9 k3 0 1u"]
    way = -1.0 if down else 1.0
    first, last, lag = (2.5 + way * half * k for k in (-1.0, 1.0, -1.02))
    rows = [
        f"Vx x0 0 PWL(0 {first} 1m {last})",
        "Rx x0 x 1k",
        f"Cx x 0 10n IC={lag}",
        "B1 g1 0 V = V(x) < 2.5 ? 5 : 0",
        "B2 g2 0 V = V(x) > 2.5 ? 5 : 0",
        "V1 in 0 10",
        "S1 in a g1 0 SW",
        "S2 a 0 g2 0 SW",
        "L1 a b 1m IC=1",
        "R1 b 0 1",
        *(["D1 0 d DI", "R2 a d 1k", ".model DI D(RON=1 ROFF=1e9 VFWD=0)"] if clamped else []),
        *(bent if beside == "kink" else []),
        ".model SW SW(VT=2.5 RON=0.05 ROFF=1e8)",
        ".tran 10u 1m uic",
    ]
    deck = tmp_path / "slow.cir"
    deck.write_text("\n".join(["Slow", *rows, ".end", ""]))
    conversion = hb.read_circuit(deck)
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    assert len(run.events) == 2
    times = np.asarray([0.4e-3, 0.52e-3, 0.9e-3])
    ends = (0.0, 10.0 / 1.05) if down else (10.0 / 1.05, 0.0)
    pace = 1.05e3
    there = ends[0] + (1.0 - ends[0]) * math.exp(-pace * CROSSED)
    before = ends[0] + (1.0 - ends[0]) * np.exp(-pace * times)
    after = ends[1] + (there - ends[1]) * np.exp(-pace * (times - CROSSED))
    wanted = np.where(times < CROSSED, before, after)
    found = np.asarray(run[conversion.signal("i(L1)")].at(times.tolist()))
    assert found == pytest.approx(wanted, rel=2e-3 if clamped else 1e-5)
