"""What a printed program prints: its functions in Python, where a run by itself would log."""

from __future__ import annotations

import pytest

import hybond as hb
from hybond.engine.engine import make_engine
from hybond.engine.run import motion, noted, report
from hybond.engine.run.run import run_program
from hybond.engine.tables import answered, tables_of


def test_the_table_has_both_limits_of_an_event(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("keep_left", "report_end", "report_event", "report_slide", "report_step"):
        monkeypatch.setattr(motion, name, getattr(report, name))
    monkeypatch.setattr(noted, "report_step", report.report_step)
    graph = hb.load("examples/capacitors_joined.toml").flatten()
    engine = make_engine(answered(tables_of(graph)))
    assert run_program(engine, report.make_report(engine)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "time,C1.e,C2.e,join.f"
    rows = [[float(a) for a in line.split(",")] for line in lines[1:]]
    left, right = [r for r in rows if r[0] == 1.0]
    # 10 C and 8 C on 3 F: 6 V, from charge alone
    assert left[1:3] == [10.0, 4.0]
    assert right[1:3] == pytest.approx([6.0, 6.0], rel=1e-15)
    assert rows[0][0] == 0.0
    assert rows[-1][0] == 2.0
    assert len(rows) == 502
