"""Models that still mean something after a change: run for a while, drawn, written as equations."""

from __future__ import annotations

import contextlib
import random
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import hybond as hb
from fuzzing import corpus
from fuzzing.judging import WrongError
from fuzzing.mutations import NUMBER, changed_text, changed_tree

LIMITS = hb.Limits(events=300, steps=3000)
LONG = 4.0
"""Seconds of CPU after which a run is stopped."""
ENDED = ("ok", "accumulation", "unsound", "error")
SOLVERS = ("", "", "", "radau", "rk45", "exact", "moreau-jean", "liqss2")


class LongError(Exception):
    """A run is stopped, as by a page that is closed."""


def run(draw: random.Random, folder: Path) -> None:
    """A changed model for some hundredths of its time, or of a second."""
    model, until = _model(draw)
    options: dict[str, Any] = {}
    if solver := draw.choice(SOLVERS):
        options["solver"] = solver
        if solver == "moreau-jean":
            options["step"] = until / 50
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # a run that goes on and can be stopped is no hang, however much it was asked for
        begun = time.process_time()

        def told(*_: float) -> None:
            if time.process_time() - begun > LONG:
                raise LongError

        options["progress"] = told
        with contextlib.suppress(LongError):
            finite(hb.simulate(model, until, on_error="return", limits=LIMITS, **options))


def shown(draw: random.Random, folder: Path) -> None:
    """A changed model as a drawing, as equations, as a program."""
    model, _ = _model(draw)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        match draw.randrange(6):
            case 0:
                hb.draw(model).save(folder / "x.svg")
            case 1:
                str(hb.state_equations(model))
            case 2:
                str(hb.causality(model))
            case 3:
                from hybond.hints.look import hints_of

                hints_of(model, model.flatten())
            case 4:
                str(hb.structure(model))
            case _:
                from hybond.cli.export import export_model  # noqa: F401
                from hybond.cli.main import main

                hb.save(model, folder / "m.json")
                target = draw.choice(("c", "java", "modelica", "python", "latex"))
                main(["export", str(folder / "m.json"), "--to", target, "--out", str(folder / "x")])


def _model(draw: random.Random) -> tuple[hb.Model, float]:
    name = draw.choice(list(corpus.trees()))
    tree = corpus.trees()[name]
    others = draw.sample(list(corpus.trees().values()), 2)
    kind = draw.random()
    if kind < 0.4:
        model = hb.loads(_numbers(draw, corpus.models()[name]), base=corpus.ROOT / "examples")
    elif kind < 0.7:
        text = corpus.json_of(changed_tree(draw, tree, others))
        model = hb.loads(text, format="json", base=corpus.ROOT / "examples")
    else:
        text = changed_text(draw, corpus.models()[name])
        model = hb.loads(text, base=corpus.ROOT / "examples")
    given = tree.get("experiment", {}).get("until", 1.0)
    try:
        until = float(str(given).split()[0]) * 0.05
        until *= {"ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}.get(str(given).split()[-1], 1.0)
    except ValueError:
        until = 0.05
    return model, until


def _numbers(draw: random.Random, text: str) -> str:
    """Return a model in which only numbers are others: most mean something."""
    for _ in range(draw.choice((1, 1, 2, 4, 10))):
        at = draw.choice(list(NUMBER.finditer(text)))
        factor = draw.choice((0.0, -1.0, 0.5, 2.0, 1e3, 1e-3, 1e9, 1e-9, 1e30, 1e-30, 1e150))
        text = f"{text[: at.start()]}{float(at[0]) * factor:.6g}{text[at.end() :]}"
    return text


def finite(run: hb.Result) -> None:
    """Refuse a run that ended in no known way, or with values that are none."""
    if run.status not in ENDED:
        raise WrongError(f"status {run.status!r}")
    if run.status == "error" and run.error is not None:
        raise run.error
    if not run.segments:
        return
    names = run.names[:60]
    times = np.linspace(run.t_begin, run.t_end, 5)
    for name, values in run.sample(times.tolist(), names).items():
        said = any(f"signal {name} has no value" in w for w in run.warnings)
        if not said and not np.all(np.isfinite(np.asarray(values, dtype=float))):
            raise WrongError(f"{run.status} with {name} = {values}")
