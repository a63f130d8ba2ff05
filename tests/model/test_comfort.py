"""What Python and notebooks show of models and runs, progress, parts by path, completion."""

from __future__ import annotations

import math
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.cli.arguments import VERBS, parser_of_words
from hybond.cli.completion import SHELLS, script


def discharge() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c", "node -> r1")
    return m


@pytest.mark.parametrize(
    ("given", "tau", "start"),
    [
        ({"c.C": "2 mF"}, 2.0, 10.0),
        ({"c.e": 5}, 1.0, 5.0),
        ({"r1.R": np.float64(500.0)}, 0.5, 10.0),
        ({"r1.R": np.int64(500)}, 0.5, 10.0),
        ({"r1.R": "2*r", "r": "2 kohm"}, 4.0, 10.0),
    ],
)
def test_elements_are_set_by_path(given: dict[str, Any], tau: float, start: float) -> None:
    m = discharge()
    run = hb.simulate(m, "1 s", parameters=given)
    assert run["c.e"].at(1.0) == pytest.approx(start * math.exp(-1.0 / tau), rel=1e-7)
    # the model is as it was, whatever was kept of it
    assert hb.simulate(m, "1 s")["c.e"].at(1.0) == pytest.approx(10.0 * math.exp(-1.0), rel=1e-7)


def test_ensembles_set_elements_by_path_too() -> None:
    sizes = [0.5e-3, 1e-3, 2e-3]
    many = hb.ensemble(discharge(), "1 s", sets={"c.C": sizes}, outputs=["c.e"])
    expected = [10.0 * math.exp(-1.0 / (1e3 * c)) for c in sizes]
    np.testing.assert_allclose(many.final["c.e"], expected, rtol=1e-7)


def test_what_is_shown_is_short_and_safe_in_a_page() -> None:
    m = discharge()
    m.title = "<b>R & C</b>"
    run = hb.simulate(m, "1 s")
    many = hb.ensemble(m, "1 s", sets={"r": [1e3, 2e3]})
    assert repr(m) == "<Model 'rc': 3 elements, 2 chains of bonds>"
    assert repr(m.flatten()) == "<FlatGraph 'rc': 3 nodes, 2 bonds, 0 machines>"
    assert repr(hb.state_equations(m)) == "<StateEquations 'rc': 1 states, 0 inputs, 0 outputs>"
    for shown in (m, run, many, run.events, m.check()):
        page = shown._repr_html_()
        assert "<b>R" not in page and len(repr(shown)) < 300
    assert "3.67879 V" in run._repr_html_() and "<svg" in m._repr_html_()
    broken = hb.Model("half")
    broken.add(r=hb.R(1))
    assert "HB-M130" in broken._repr_html_()


class Moved:
    """As a bar of tqdm, as far as it matters."""

    def __init__(self) -> None:
        self.n: float = 0.0
        self.total: float | None = None
        self.shown: list[float] = []

    def refresh(self) -> None:
        self.shown.append(self.n)


def test_a_bar_is_moved_to_the_end() -> None:
    bar = Moved()
    hb.simulate(discharge(), "1 s", progress=bar)
    assert bar.total == 1.0 and bar.n == 1.0 and bar.shown == sorted(bar.shown)
    bar = Moved()
    hb.ensemble(discharge(), "1 s", sets={"r": [1e3, 2e3, 3e3]}, progress=bar)
    assert (bar.n, bar.total) == (3, 3)


def test_true_shows_a_bar(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    monkeypatch.setattr("hybond.progress.PATIENCE", -1.0)
    monkeypatch.setattr("hybond.progress.REDRAW", -1.0)
    hb.simulate(discharge(), "1 s", progress=True)
    assert "100 %" in capsys.readouterr().err


def test_a_notebook_shows_a_plot_once(monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib import pyplot

    run = hb.simulate(discharge(), "1 s")
    monkeypatch.setattr(
        "matplotlib.get_backend", lambda: "module://matplotlib_inline.backend_inline"
    )
    before = pyplot.get_fignums()
    figure = run.plot("c.e")
    assert figure.axes and pyplot.get_fignums() == before


@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_reads_its_completion(shell: str, tmp_path: Path) -> None:
    text = script(shell, parser_of_words())
    for verb in VERBS:
        assert verb in text
    assert "until" in text and "journal" in text
    if shutil.which(shell) is None:
        return
    path = tmp_path / "completion"
    path.write_text(text)
    subprocess.run([shell, "-n", str(path)], check=True, timeout=20)


def test_bash_completes_verbs_and_options(tmp_path: Path) -> None:
    if shutil.which("bash") is None:
        pytest.skip("no bash")
    path = tmp_path / "completion"
    path.write_text(script("bash", parser_of_words()))
    words = "COMP_WORDS=({}); COMP_CWORD={}; _hybond; echo ${{COMPREPLY[@]}}"
    for line, number, expected in (
        ("hybond ex", 1, "explain export"),
        ("hybond run a.toml --unt", 3, "--until"),
        ("hybond export a.toml --fm", 3, "--fmi"),
    ):
        done = subprocess.run(
            ["bash", "-c", f". {path}; " + words.format(line, number)],
            capture_output=True,
            text=True,
            timeout=20,
        )
        assert sorted(done.stdout.split()) == expected.split(), done.stderr
