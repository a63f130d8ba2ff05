"""``hybond demo``: pictures of an example, or of every model in a folder."""

from __future__ import annotations

import time
from argparse import Namespace
from pathlib import Path

from hybond.cli.explain import explanation
from hybond.cli.lists import run_until
from hybond.cli.outputs import write_plot
from hybond.cli.refusal import refusal_of
from hybond.cli.running import exit_code, read_graph, simulate_with
from hybond.cli.streams import complain, say
from hybond.errors import UsageError
from hybond.files.examples import examples_folder, models_in
from hybond.files.whole import write_whole
from hybond.result import Result

EXPECTED = {
    "bouncing_ball_no_mode": "HB-N401",
    "diode_inductor_no_mode": "HB-N401",
    "falling_rod_threshold": "HB-N401",
}
"""Examples whose run ends in a report, because that is what they show."""
SHOWN = 8
"""Lines of the event table that the demo shows."""


def demo(given: Namespace) -> int:
    """Draw, run and plot; print where the files are."""
    out = Path(given.out or "hybond-demo")
    if given.examples is None:
        files = [examples_folder() / "bouncing_ball.toml"]
    else:
        folder = Path(given.examples)
        files = models_in(folder)
        if not files:
            raise UsageError(
                f"there are no models in {str(folder)!r}",
                code="HB-X107",
                where="--examples",
                hint="name a folder with .toml files",
            )
    out.mkdir(parents=True, exist_ok=True)
    if given.examples is None:
        return _one(files[0], out)
    return _all(files, out)


def _one(file: Path, out: Path) -> int:
    run = _run(file, out)
    say(run.title)
    say(f"  model       {file}")
    say(f"  bond graph  {out / file.stem}.svg")
    say(f"  plot        {out / file.stem}.png")
    say(f"  events      {out / file.stem}.txt")
    say()
    lines = str(run.events).splitlines()
    say("\n".join(lines[:SHOWN]))
    if len(lines) > SHOWN:
        say("...")
    say()
    say("Your turn:  hybond studio my_model.toml  to draw one, with pip install 'hybond[studio]'")
    say("            hybond new my_model.toml  to write one")
    if run.error is not None:
        complain(str(run.error))
    return exit_code(run)


def _all(files: list[Path], out: Path) -> int:
    width = max(len(f.stem) for f in files)
    worst = 0
    for file in files:
        began = time.perf_counter()
        expected = EXPECTED.get(file.stem)
        try:
            run = _run(file, out)
        except Exception as error:
            refusal = refusal_of(error)
            worst = worst or refusal.exit_code
            say(f"{file.stem:{width}}  FAILED")
            complain(str(refusal))
            continue
        took = time.perf_counter() - began
        code = run.error.code if run.error is not None else None
        word: str = run.status
        if code is not None and code == expected:
            word = f"{code} as expected"
        elif code != expected:
            word = f"FAILED: {code or 'no error'}, expected {expected or 'none'}"
            worst = worst or exit_code(run) or 3
        say(
            f"{file.stem:{width}}  {word:20}  t = {run.t_end:<8.6g} s  {len(run.events):4} events"
            f"  {took:6.2f} s"
        )
        if run.status == "interrupted":
            return exit_code(run)
        if run.error is not None and code != expected:
            complain(str(run.error))
    say(f"drawings (.svg), plots (.png) and event tables (.txt) are in {out}")
    return worst


def _run(file: Path, out: Path) -> Result:
    """Write the drawing, the plot and the events of one model."""
    from hybond.draw import draw_mode

    graph = read_graph(str(file))
    draw_mode(graph).save(out / f"{file.stem}.svg")
    until, end = run_until(graph, None)
    run = simulate_with(graph, until, end=end)
    write_whole(out / f"{file.stem}.txt", explanation(run) + "\n")
    write_plot(run, out / f"{file.stem}.png", ())
    return run
