"""What the library leaves in the middle of a run is not begun anew with used functions."""

from __future__ import annotations

import pytest

import hybond as hb


class Counting:
    """A controller that remembers how often it was called."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, t: float, u: dict[str, float]) -> dict[str, float]:
        self.calls += 1
        return {"force": 0.5 + 0.01 * self.calls}


def slides_beside_a_diode(controller: Counting | None) -> hb.Model:
    """Return a relay that slides beside a rectifier, which the library does not do."""
    m = hb.Model("beside")
    push = "0.5" if controller is None else "k.force"
    m.add(body=hb.I(1.0, f=1.0), push=hb.Se(push), a=hb.Se(-1.0), b=hb.Se(1.0), v=hb.One())
    m.bond("push -> v -> body", "a -> v", "b -> v")
    m.add(V=hb.Se("sin(5*time/(1 [s]))"), r=hb.R(1.0), c=hb.C(1.0), d=hb.One(law="diode"))
    m.bond("V -> d -> r", "d -> c")
    if controller is not None:
        out = {"force": 0.5}
        m.block(k=hb.Block(controller, inputs={"speed": "v.f"}, outputs=out, every=0.1))
    rules = ["up -> down when v.f < 0", "down -> up when v.f > 0"]
    m.machine("M", states={"up": ["a"], "down": ["b"]}, start="up", rules=rules)
    return m


def test_functions_that_were_called_are_not_called_again_from_the_start() -> None:
    with pytest.raises(hb.UsageError, match="have been called") as refused:
        hb.simulate(slides_beside_a_diode(Counting()), until=5)
    assert refused.value.code == "HB-S119"
    controller = Counting()
    run = hb.simulate(slides_beside_a_diode(controller), until=5, engine="reference")
    assert controller.calls == 50
    assert run["k.force"].at(0.05) == pytest.approx(0.51)


def test_without_them_the_reference_begins_anew() -> None:
    run = hb.simulate(slides_beside_a_diode(None), until=5)
    assert run.status == "ok"
    assert run.kernel.startswith("the reference (sliding beside junction laws")
