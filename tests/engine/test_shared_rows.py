"""States of large models are logged once where they stand twice: nobody may tell."""

import itertools

import numpy as np
import pytest

import hybond as hb
from hybond.engine.compiled.kept_rows import WIDE, KeptRows, SharedRows


@pytest.mark.parametrize("seed", range(4))
def test_shared_rows_are_the_rows_that_were_put_there(seed: int) -> None:
    draw = np.random.default_rng(seed)
    kept, parts, plain = KeptRows(), [], []
    last = draw.normal(size=3)
    for many in draw.integers(1, 60, size=30).tolist():
        rows = draw.normal(size=(many, 3, 3))
        for row in rows:
            row[0] = last if draw.random() < 0.8 else row[0]
            row[1] = row[0] if draw.random() < 0.2 else row[1]
            row[2] = row[1] if draw.random() < 0.6 else row[2]
            last = row[2]
        # zero and minus zero are two numbers
        rows[0, 1, 0], rows[0, 2] = -0.0, rows[0, 1]
        rows[0, 2, 0] = 0.0
        parts.append(SharedRows.of(rows, kept, "y"))
        plain.append(rows)
    for found, rows in zip(parts, plain, strict=True):
        assert found[:].tobytes() == rows.tobytes()
    assert sum(len(p.rows) for p in parts) < 0.6 * sum(p.at.size for p in parts)
    for first, last_one in itertools.pairwise(sorted(draw.integers(0, 31, size=6).tolist())):
        if first < last_one:
            whole, rows = SharedRows.joined(parts[first:last_one]), np.vstack(plain[first:last_one])
            assert whole[:].tobytes() == rows.tobytes()
            cut = len(rows) // 3
            assert whole.part(cut, len(rows))[:].tobytes() == rows[cut:].tobytes()
            pieces = [whole.part(0, cut), whole.part(cut, len(rows))]
            assert SharedRows.joined(pieces)[:].tobytes() == rows.tobytes()
            begun = whole.begun_at(np.ones(3))
            assert begun[0, 0].tolist() == [1.0] * 3
            assert begun[1:].tobytes() == rows[1:].tobytes()


def cells(many: int) -> hb.Model:
    """Capacitors behind resistors on one source, each with a switch that opens at a voltage."""
    lines = ["hybond = 1", 'domain = "electrical"', "[elements]", 'V = { Se = "10 V" }']
    lines.append("bus = { junction = 0 }")
    bonds = ["V -> bus"]
    for k in range(many):
        lines += [f"s{k} = {{ junction = 1 }}", f'R{k} = {{ R = "{100 + k} ohm" }}']
        lines.append(f'C{k} = {{ C = "{1 + k % 5} uF" }}')
        bonds += [f"bus -> s{k} -> C{k}", f"s{k} -> R{k}"]
    lines += ["[graph]", f"bonds = {bonds}"]
    for k in range(0, many, 32):
        lines += [f"[machines.m{k}]", f'states = {{ on = ["s{k}"], off = [] }}', 'start = "on"']
        lines.append(f'rules = ["on -> off when C{k}.e > {2 + k / 100} V"]')
    return hb.loads("\n".join(lines))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "auto"])
def test_states_of_a_large_model_are_those_of_its_small_parts(solver: str) -> None:
    """The parts have no more in common than a source; one part is a small model."""
    many = WIDE + 2
    whole = hb.simulate(cells(many), until="1 ms", solver=solver)
    assert len(whole.events) == 4
    times = np.linspace(0.0, 1e-3, 50)
    for k in (1, 32, many - 1):
        r, c = 100.0 + k, (1 + k % 5) * 1e-6
        found = whole[f"C{k}.e"].at(times)
        off = 2.0 + k / 100 if k % 32 == 0 else np.inf
        assert found == pytest.approx(np.minimum(10 - 10 * np.exp(-times / (r * c)), off), rel=1e-6)
    # the log says the same at its own points, and a run that goes on as the uncut one
    for segment in whole.segments:
        for t, y in zip(segment.t, segment.y, strict=True):
            assert segment.at(float(t)).tolist() == y.tolist()
    half = hb.simulate(cells(many), until="0.4 ms", solver=solver)
    rest = hb.simulate(cells(many), until="1 ms", solver=solver, start=half)
    assert rest.segments[-1].y[-1] == pytest.approx(whole.segments[-1].y[-1], rel=1e-7)
    for a, b in itertools.pairwise(whole.segments):
        assert a.y[-1].tolist() == b.y[0].tolist()
