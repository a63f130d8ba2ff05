"""Converted netlists against ngspice, which knows nothing of bond graphs."""

import sys
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))

from converters import CONVERTERS, see  # noqa: E402
from netlists import CASES, DECKS, compare  # noqa: E402
from ngspice import run  # noqa: E402

pytestmark = pytest.mark.ngspice


SWITCHED = [case for case in CASES if case.diodes]
SMOOTH = [case for case in CASES if not case.diodes]


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    return {}, tmp_path_factory.mktemp("ngspice")


def result(compared, case):
    """What both engines say about a deck, which is run once."""
    known, folder = compared
    if case.name not in known:
        known[case.name] = compare(case, folder)
    return known[case.name]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_means_agree_to_half_a_percent(compared, case):
    found = result(compared, case)
    assert found.means
    assert found.run.status == "ok"
    for ours, theirs in found.means.values():
        assert ours == pytest.approx(theirs, rel=5e-3)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", SWITCHED, ids=lambda case: case.name)
def test_diodes_switch_within_a_thousandth_of_a_period(compared, case):
    for diode, (ours, theirs) in result(compared, case).instants.items():
        assert len(ours) == len(theirs) > 0, diode
        assert np.abs(ours - theirs).max() < 1e-3 * case.period, diode


@pytest.mark.parametrize("case", SMOOTH, ids=lambda case: case.name)
def test_waves_without_diodes_agree_everywhere(compared, case):
    found = result(compared, case)
    t = np.linspace(0.0, found.run.t_end, 2001)[:-1]
    for signal, vectors in case.means.items():
        theirs = found.waves[vectors[0]]
        size = np.abs(theirs).max()
        ours = np.asarray(found.run[signal].at(t.tolist()))
        away = np.abs(ours - np.interp(t, found.waves.time, theirs)) / size
        # ngspice rounds corners off by a step
        assert np.median(away) < 1e-4
        assert away.max() < 1e-2


def test_a_hysteresis_switches_where_ngspice_switches(tmp_path):
    deck = DECKS / "switches.cir"
    found = hb.simulate(hb.read_circuit(deck).model)
    waves = run(deck, tmp_path)
    edges = [e.t for e in found.events[1:7]]
    slope = np.gradient(waves["c"], waves.time)
    turns = waves.crossings(np.sign(slope), 0.0, up=True)
    tops = waves.crossings(np.sign(slope), 0.0, up=False)
    theirs = np.sort(np.concatenate([turns, tops]))[:6]
    period = edges[2] - edges[0]
    # ngspice switches at the first of its time points that is past a threshold; this adds up
    assert np.abs(np.diff(edges) - np.diff(theirs)).max() < 1e-3 * period


@pytest.mark.parametrize("start", ["", " uic"])
def test_the_operating_point_is_that_of_ngspice(tmp_path, start):
    deck = tmp_path / "op.cir"
    deck.write_text(
        "Operating point\nV1 in 0 PULSE(10 4 0.2m 1u 1u 1 2)\nR1 in a 100\nL1 a b 10m\n"
        "R2 b 0 400\nC1 b c 1u\nR3 c 0 1k\nC2 b 0 2u IC=3\nD1 b d DI\nR4 d 0 1k\nI1 0 d 1m\n"
        f".model DI D(IS=1e-14 N=0.01)\n.tran 1u 1m 0 1u{start}\n.end\n"
    )
    found = hb.simulate(hb.read_circuit(deck, diode_current="10 mA").model)
    waves = run(deck, tmp_path)
    for signal, theirs in (("C2.e", waves["b"]), ("L1.f", waves["l1#branch"])):
        t = np.linspace(0.0, 1e-3, 501)[:-1]
        ours = np.asarray(found[signal].at(t.tolist()))
        size = np.abs(theirs).max()
        assert np.abs(ours - np.interp(t, waves.time, theirs)).max() < 2e-3 * size


QUICK = (
    "charge_pump",
    "doubler",
    "half_wave_freewheel",
    "six_pulse_rectifier",
    "twelve_pulse_rectifier",
    "dimmer",
    "thyristor_bridge",
    "h_bridge_inverter",
    "three_phase_inverter",
    "npc_leg",
    "chopper_motor",
    "flyback",
    "two_switch_forward",
)
"""All are in docs/circuits.md; these take ngspice less than a second each."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name",
    # twice six pulses are the same diodes, behind a transformer, and take four times as long
    [pytest.param(n, marks=[pytest.mark.slow] * (n == "twelve_pulse_rectifier")) for n in QUICK],
)
def test_converters_agree(tmp_path, name):
    """Means and root mean squares; the tables of the documentation have the others."""
    seen = see(next(c for c in CONVERTERS if c.name == name), tmp_path)
    assert seen.status == "ok"
    assert seen.worst < 1e-3
    assert all(abs(value) > 1e-3 for _, value, *_ in seen.values.values())
