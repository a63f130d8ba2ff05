"""Words of the command line: options, what stands behind them, and files, changed."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import random
import warnings
from functools import cache
from pathlib import Path
from typing import Any

from fuzzing import corpus
from fuzzing.judging import WrongError
from fuzzing.mutations import NUMBERS, changed_bytes, changed_text, name
from hybond.cli.arguments import parse, parser_of_words
from hybond.cli.main import verb
from hybond.errors import HybondError

VALUES: dict[str, tuple[str, ...]] = {
    "--set": ("e=0.4", "ball.I=2 kg", "height.start=3 m", "g=9.81 m/s^2", "push=1 N", "ball.f=0"),
    "--until": ("1 s", "0.5", "height < 1 m", "v.f > 0, 1 s"),
    "--solver": ("auto", "rk45", "radau", "exact", "moreau-jean", "qss2", "liqss2", "euler", "rk4"),
    "--rtol": ("1e-6", "1e-3"),
    "--atol": ("1e-9",),
    "--step": ("1 ms", "1e-2", "10 us"),
    "--theta": ("0.5", "1"),
    "--max-step": ("10 ms",),
    "--impact": ("newton", "poisson"),
    "--sliding": ("exact", "hysteresis"),
    "--hysteresis": ("1 mm",),
    "--start": ("s.json", "0.2 s"),
    "--save-state": ("out/s.json",),
    "--max-events": ("100",),
    "--max-steps": ("5000",),
    "--keep": ("10", "3"),
    "--journal": ("out/j.csv",),
    "--at": ("0.5", "0:1:0.1", "0.1,0.2,0.3", "height=1 m", "impact.hits", "1 s"),
    "--signals": ("height", "height,v.f"),
    "--out": (
        "out/x.csv",
        "out/x.json",
        "out/x.npz",
        "out/x.svg",
        "out/x.tex",
        "out/sweep",
        "out/x.c",
    ),
    "--plot": ("out/p.svg", "out/p.png"),
    "--vary": ("e=0.1..0.9:3", "ball.I=1 kg,2 kg", "e=0.1:0.5:0.2", "g=log(1,10,3)"),
    "--collect": ("final(height)", "count(events), max(v.f)", "mode"),
    "--sample": ("lhs:4", "random:3", "sobol:4"),
    "--seed": ("1",),
    "--runs": ("netcdf",),
    "--part": ("2",),
    "--workers": ("1",),
    "--of": ("height", "v.f"),
    "--period": ("0.1 s", "0.5"),
    "--settle": ("3", "1 s"),
    "--direction": ("up", "down", "both"),
    "--windows": ("auto", "3"),
    "--limit": ("1 s", "8"),
    "--mode": ("impact=hits", "impact=away"),
    "--where": ("height >= 0",),
    "--engines": ("radau,moreau-jean", "rk45,radau"),
    "--why": ("weight -> v", "1"),
    "--sensors": ("v", "v.f"),
    "--outputs": ("v.f", "height"),
    "--output": ("v.f", "height"),
    "--inputs": ("weight", "push"),
    "--input": ("weight", "push"),
    "--restitution": ("contact",),
    "--coverage": ("height=-1..1",),
    "--dt": ("1 ms",),
    "--speed": ("1 m/s",),
    "--write": ("out/w.toml",),
    "--draw": ("out/d.svg",),
    "--eps": ("1e-3",),
    "--kind": ("bode", "poles", "step"),
    "--frequencies": ("1 Hz,10 Hz", "log(1,100,3)"),
    "--amplitude": ("0.01", "1 mN"),
    "--tolerance": ("1e-3",),
    "--free": ("e", "ball.I,e"),
    "--log": ("e",),
    "--bounds": ("e=0..1",),
    "--loss": ("linear", "huber"),
    "--starts": ("2",),
    "--multiple": ("1", "2"),
    "--wrt": ("e",),
    "--along": ("e=0.4..0.5",),
    "--doublings": ("1",),
    "--points": ("5", "50"),
    "--depth": ("2",),
    "--end": ("1 s",),
    "--periods": ("2",),
    "--sankey": ("out/k.svg",),
    "--columns": ("2",),
    "--open": ("part",),
    "--diode-current": ("1", "10 mA"),
    "--to": ("c", "java", "modelica", "python", "latex"),
    "--fmi": ("2.0", "3.0"),
    "--from": ("bouncing_ball", "buck"),
}
MEASURES = ("mean(v.f)", "max(height, from=0.1 s)", "rms(v.f)", "final(height)", "count(events)")
VERBS = (
    *("run", "run", "run", "sweep", "sweep", "check", "draw", "causality", "equations", "analyse"),
    *("linearise", "bifurcation", "measure", "measure", "fit", "periodic", "explain", "convert"),
    *("export", "new", "library", "completion"),
)
ALWAYS = {"run", "sweep", "measure", "explain", "bifurcation"}
PATIENT = ("--until", "1 s", "--max-step", "0.1")


@cache
def options() -> dict[str, list[argparse.Action]]:
    """Return the options of each verb."""
    found = {}
    for action in parser_of_words()._actions:
        if isinstance(action, argparse._SubParsersAction):
            for word, parser in action.choices.items():
                found[word] = [a for a in parser._actions if a.option_strings and a.dest != "help"]
    return found


def command(draw: random.Random, folder: Path) -> None:
    """A command line with changed words, in a folder with good files or changed ones.

    It stands one folder further in: who writes to ``../up`` as he is told to writes nowhere else.
    """
    folder = folder / "here"
    folder.mkdir()
    text = corpus.SMALL
    if draw.random() < 0.15:
        text = changed_text(draw, text)
    (folder / "m.toml").write_bytes(text.encode("utf-8", "surrogatepass"))
    (folder / "n.cir").write_text(draw.choice(list(corpus.netlists().values())))
    state = corpus.STATE if draw.random() < 0.5 else changed_text(draw, corpus.STATE)
    (folder / "s.json").write_bytes(state.encode("utf-8", "surrogatepass"))
    data = corpus.DATA.encode()
    (folder / "d.csv").write_bytes(data if draw.random() < 0.7 else changed_bytes(draw, data))
    (folder / "out").mkdir()
    words = [w.replace("\0", "") for w in _words(draw)]
    said, complained = io.StringIO(), io.StringIO()
    before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    (folder / "words.json").write_text(json.dumps(words))
    here = os.getcwd()
    os.chdir(folder)
    try:
        with (
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(complained),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            verb(parse(words))
    except SystemExit:
        return
    except HybondError as error:
        error.where = error.where or "-"  # a word of the command line that argparse has not taken
        _untouched(before, words)
        raise
    except OSError as error:
        if error.filename is None:
            raise
        return  # HB-X002 of the command line
    finally:
        os.chdir(here)
    if "--json" in words and words[0] not in ("library", "new") and "NaN" in said.getvalue():
        json.loads(said.getvalue(), parse_constant=_none)


def _none(word: str) -> Any:
    raise WrongError(f"{word} in JSON")


def _untouched(before: dict[Path, bytes], words: list[str]) -> None:
    """What is refused changes no file that was there."""
    for path, content in before.items():
        if not path.exists() or path.read_bytes() != content:
            raise WrongError(f"{path.name} was changed by {words}")


def _words(draw: random.Random) -> list[str]:
    which = draw.choice(VERBS)
    words = [which]
    match which:
        case "convert":
            words += [
                draw.choice(("n.cir", "m.toml")),
                draw.choice(("out/x.toml", "out/x.json", "out/x")),
            ]
        case "new":
            words += [draw.choice(("out/new.toml", "m.toml", name(draw)))]
        case "library" | "completion":
            words += [draw.choice(("electrical", "electrical.diode", "bash", "zsh", name(draw)))]
        case "fit":
            words += ["m.toml", "d.csv", "--free", "e"]
        case "measure":
            asked = draw.choice(MEASURES)
            words += ["m.toml", changed_text(draw, asked) if draw.random() < 0.5 else asked]
        case "sweep":
            words += ["m.toml", "--vary", draw.choice(VALUES["--vary"]), "--workers", "1"]
        case "bifurcation":
            words += [
                "m.toml",
                "--vary",
                "e=0.1..0.5:3",
                "--of",
                "v.f",
                "--period",
                "0.1",
                "--workers",
                "1",
            ]
            words += ["--settle", "2", "--keep", "2"]
        case "export":
            words += ["m.toml", "--to", draw.choice(VALUES["--to"]), "--out", "out/x"]
        case _:
            words += ["m.toml"]
    if which in ALWAYS:
        words += PATIENT
    for action in draw.sample(
        options()[which], min(len(options()[which]), draw.choice((0, 1, 1, 2, 3)))
    ):
        words.append(action.option_strings[-1])
        if action.nargs == 0:
            continue
        known = VALUES.get(action.option_strings[-1], ("1", "x"))
        value = draw.choice(known)
        if draw.random() < 0.6:
            value = changed_text(draw, value, draw.choice(list(VALUES.values())))
        elif draw.random() < 0.2:
            value = draw.choice(NUMBERS)
        words.append(value if len(value) < 120_000 else value[:120_000])
    if draw.random() < 0.1:
        words.insert(draw.randrange(len(words) + 1), name(draw))
    # no processes and no addresses, and no places that are not its own: it may say what to write
    return [w.lstrip("/") or "x" for w in words if w not in ("--cluster", "--fmus")]
