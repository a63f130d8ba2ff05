"""A run written as a table: each number comes back with all its bits."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

import hybond as hb


def test_numbers_of_a_csv_file_are_those_of_the_run(tmp_path: Path) -> None:
    """Held ones, both zeros and those that come again included."""
    m = hb.Model("held")
    m.add(s=hb.Se(0.0), c=hb.C(1.0, e=-1.0), r=hb.R(1.0), node=hb.One())
    m.bond("s -> node", "node -> c", "node -> r")
    m.signal(zero="sin(2*time)*s.e")
    m.machine(
        "tick",
        states={"low": [], "high": []},
        start="low",
        rules=["low -> high when sin(2*time) > 0", "high -> low when sin(2*time) < 0"],
    )
    run = hb.simulate(m, 30.0)
    run.to_csv(tmp_path / "run.csv", ["c.e", "zero", "r.f"])
    with open(tmp_path / "run.csv", newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    table = run.table(["c.e", "zero", "r.f"])
    assert head == ["t", "side", "c.e", "zero", "r.f"]
    assert [row[1] for row in rows] == table["side"].tolist()
    for k, name in enumerate(head):
        if name != "side":
            read = np.array([float(row[k]) for row in rows])
            assert read.tobytes() == table[name].tobytes()
    assert np.signbit(table["zero"]).any() and not np.signbit(table["zero"]).all()
    alone = run.table("r.f")
    assert list(alone) == ["t", "side", "r.f"]
    assert alone["r.f"].tobytes() == table["r.f"].tobytes()
    assert run.sample(1.0, "c.e")["c.e"] == run.sample(1.0, ["c.e"])["c.e"]
