"""Two controlled sources that are an ideal transformer become one, which conserves power."""

from pathlib import Path

import pytest

import hybond as hb


def read(tmp_path: Path, *rows: str) -> hb.Model:
    path = tmp_path / "test.cir"
    path.write_text("\n".join(["title", *rows, ".end"]) + "\n")
    return hb.read_circuit(path).model


# the meter ahead of the source of voltage or behind it, each way round, and the primary each way
PAIRS = {
    "behind": (["E1 s x q 0 {n}", "Vm 0 x 0"], "F1 q 0 Vm {n}", 1),
    "behind, turned": (["E1 s x q 0 {n}", "Vm x 0 0"], "F1 0 q Vm {n}", 1),
    "ahead": (["E1 x 0 q 0 {n}", "Vm x s 0"], "F1 q 0 Vm {n}", 1),
    "ahead, turned": (["E1 x 0 q 0 {n}", "Vm s x 0"], "F1 0 q Vm {n}", 1),
    "opposite": (["E1 x 0 0 q {n}", "Vm x s 0"], "F1 0 q Vm {n}", -1),
    "parameter": (["E1 x 0 q 0 {k*n}", "Vm x s 0"], "F1 q 0 Vm {k*n}", 1),
}


@pytest.mark.parametrize("pair", list(PAIRS))
def test_charge_is_shared_through_the_turns(tmp_path: Path, pair: str) -> None:
    """Volts by n, charge by 1/n: U C1/(C1 + n^2 C2) at the primary, whoever closes the switch."""
    secondary, primary, sign = PAIRS[pair]
    model = read(
        tmp_path, ".param n=2 k=1", "C1 p 0 1u IC=10", "S1 p q g 0 SW", *secondary, primary,
        "C2 s 0 1u", "R1 s 0 1g", "Vg g 0 PULSE(0 1 1m 1n 1n 1 2)",
        ".model SW SW(VT=0.5 RON=0 ROFF=1e12)", ".tran 1u 1.1m uic", ".print tran v(s) v(p)",
    )  # fmt: skip
    assert sum(part.kind == "TF" for part in model.elements.values()) == 1
    run = hb.simulate(model)
    before, behind = 0.5 * 1e-6 * 10**2, 0.5 * 1e-6 * (2**2 + 4**2)
    (event,) = [e for e in run.events if e.t > 0]
    assert event.steps[-1].energy is not None
    assert event.steps[-1].energy.lost == pytest.approx(before - behind, rel=1e-9)
    shown = [run[name].at(1.05e-3) for name in model.experiment["plot"]]
    assert shown == pytest.approx([sign * 4.0, 2.0], rel=1e-4)


def test_an_ideal_transformer_passes_direct_current(tmp_path: Path) -> None:
    model = read(
        tmp_path, "V1 p 0 12", "R1 p q 1", "L1 s t 1m", "E1 s x q 0 0.5", "Vm 0 x 0",
        "F1 q 0 Vm 0.5", "R2 t 0 2", ".tran 1u 1m", ".print tran v(t) i(V1)",
    )  # fmt: skip
    run = hb.simulate(model)
    # 2 ohm are 8 at the primary
    for t in (0.0, 1e-3):
        shown = [run[name].at(t) for name in model.experiment["plot"]]
        assert shown == pytest.approx([12 * 8 / 9 * 0.5, -12 / 9], rel=1e-9)


@pytest.mark.parametrize("primary", ["F1 q 0 Vm 0.4", "F1 0 q Vm 0.5", "F1 q p Vm 0.5"])
def test_sources_that_are_no_transformer_stay(tmp_path: Path, primary: str) -> None:
    model = read(
        tmp_path, "V1 p 0 12", "R1 p q 1", "E1 s x q 0 0.5", "Vm 0 x 0", primary, "R2 s 0 2",
        ".tran 1u 1m uic",
    )  # fmt: skip
    assert not any(part.kind == "TF" for part in model.elements.values())


@pytest.mark.slow
def test_the_clamp_of_a_forward_converter_takes_the_leakage(tmp_path: Path) -> None:
    """What both diodes let go of at one instant is one current, by the turns."""
    model = read(
        tmp_path, "Vin in 0 100", "Lm in a 500u", "Lk a sw 10u", "E1 s 0 in a 0.1",
        "F1 in a Vs 0.1", "Vs s t 0", "S1 sw 0 g 0 SW", "Vg g 0 PULSE(0 1 0 1n 1n 4u 10u)",
        "Dc sw cl DI", "Rc cl in 5k", "Cc cl in 47n ic=150", "Do t out DI", "Co out 0 220u",
        "Ro out 0 2", ".model SW SW(VT=0.5 RON=0.05 ROFF=1e8)",
        ".model DI D(IS=1e-12 N=0.02 RS=5m)", ".tran 0.1u 1m uic",
    )  # fmt: skip
    run = hb.simulate(model)
    assert run.status == "ok" and run.audit().holds()
    assert run.losses().holds()
    # nothing but diodes and the switch at the instants of the period lets go of energy
    switched = ("Dc", "Do", "S1")
    assert all(row.name in switched for row in run.losses().rows if row.lost)
