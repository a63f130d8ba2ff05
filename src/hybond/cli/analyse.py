"""``hybond analyse``: structure by mode, restitution of a contact, residuals, coverage."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING, Any

from hybond.cli.lists import mode_of, setting, split, sweep
from hybond.cli.record import to_json
from hybond.cli.running import read_graph
from hybond.cli.streams import say
from hybond.cli.targets import check_new, check_target
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Mode

if TYPE_CHECKING:
    from hybond.analysis.restitution.restitution import Restitution

VERSION = 1
"""Version of the object of ``--json``."""


def analyse(given: Namespace) -> int:
    """Do one analysis; the options say which."""
    _check(given)
    graph = read_graph(given.file, given.settings)
    record: dict[str, Any] = {"hybond": VERSION, "file": given.file}
    if given.restitution:
        _restitution(given, graph, record)
    elif given.residuals:
        _residuals(given, graph, record)
    elif given.coverage:
        _coverage(given, graph, record)
    else:
        _structure(given, graph, record)
    if given.json:
        say(to_json(record).rstrip("\n"))
    return 0


def _check(given: Namespace) -> None:
    """Refuse options that belong to another analysis."""
    for option, value, needs in (
        ("--dt", given.dt, "restitution"),
        ("--speed", given.speed, "restitution"),
        ("--write", given.write, "restitution"),
        ("--eps", given.eps, "restitution"),
        ("--sensors", given.sensors, "residuals"),
        ("--at", given.at, "coverage"),
    ):
        if value is not None and not getattr(given, needs):
            raise UsageError(
                f"{option} belongs to --{needs}",
                code="HB-X101",
                where="hybond analyse",
                hint="hybond analyse --help",
            )
    other = next((w for w in ("restitution", "residuals", "coverage") if getattr(given, w)), "")
    for option in ("inputs", "outputs", "draw", "mode"):
        if other and getattr(given, option) and not (option == "mode" and other != "restitution"):
            raise UsageError(
                f"--{option} does not go with --{other}",
                code="HB-X101",
                where="hybond analyse",
                hint="hybond analyse --help",
            )


def _structure(given: Namespace, graph: FlatGraph, record: dict[str, Any]) -> None:
    from hybond.analysis.structure.structure import structure

    modes = [mode_of(graph, text) for text in given.mode]
    report = structure(
        graph,
        modes=modes or "reachable",
        inputs=split([given.inputs]) if given.inputs else None,
        outputs=split([given.outputs or ""]),
    )
    record |= report.record()
    if given.draw:
        target = check_target(given.draw, (".svg", ".png", ".pdf", ".tex"), "--draw")
        from hybond.draw import draw_mode

        mode = report.rows[0].mode
        draw_mode(graph, mode, marks=report.marks(mode)).save(target or given.draw)
    if given.json:
        return
    say(graph.title or graph.name)
    say()
    say(report.to_markdown() if given.markdown else str(report))
    if given.draw:
        say(given.draw)


def _restitution(given: Namespace, graph: FlatGraph, record: dict[str, Any]) -> None:
    from hybond.analysis.restitution.restitution import restitution

    found = restitution(
        graph,
        given.restitution,
        dt=given.dt if given.dt is not None else "1 ms",
        speed=given.speed,
    )
    record |= found.record()
    epsilon = source = None
    if given.write:
        epsilon, source = _epsilon(given, found)
        record |= {"written": given.write, "epsilon": epsilon, "epsilon_is": source}
        _write_newton(given, epsilon)
    if given.json:
        return
    say(graph.title or graph.name)
    say()
    say(found.markdown() if given.markdown else found.text())
    if given.write:
        say(f"\n{given.write}: Newton's law with ε = {epsilon}, {source}")


def _epsilon(given: Namespace, found: Restitution) -> tuple[float | str, str]:
    """Return the restitution to write, and what it is.

    A value that is given; else the formula's if its step was named; else the one that depends on
    no step.
    """
    if given.eps is not None:
        return given.eps, "as given"
    if given.dt is not None and found.value is not None:
        return found.value, f"by the formula at Δt = {given.dt}"
    rebound = found.rebound(sources=given.speed is not None) or found.rebound()
    if rebound is None:
        raise UsageError(
            "the contact phase gives no restitution, so there is nothing to write",
            code="HB-X101",
            where="--write",
            hint="give a value: --eps 0.9",
        )
    return rebound.value, "from integrating the contact phase"


def _write_newton(given: Namespace, value: float | str) -> None:
    """Write the simplified model with Newton's law of restitution."""
    from pathlib import Path

    from hybond.analysis.restitution.newton_law import newton_law_model
    from hybond.cli.settings import model_with
    from hybond.files import load, save

    target = check_target(given.write, (".toml", ".json"), "--write")
    assert target is not None
    check_new(target, force=given.force)
    model = model_with(load(Path(given.file)), given.settings)
    save(newton_law_model(model, given.restitution, value), target)


def _residuals(given: Namespace, graph: FlatGraph, record: dict[str, Any]) -> None:
    from hybond.analysis.residuals.residuals import residuals

    mode = _one_mode(given, graph, "--residuals are of all modes, or of one")
    found = residuals(graph, sensors=split([given.sensors or ""]), mode=mode)
    record |= found.record()
    if given.json:
        return
    say(graph.title or graph.name)
    say()
    say(found.to_markdown() if given.markdown else str(found))


def _coverage(given: Namespace, graph: FlatGraph, record: dict[str, Any]) -> None:
    from hybond.analysis.coverage import coverage

    quantity, low, high = sweep(given.coverage, "--coverage")
    mode = _one_mode(given, graph, "--coverage enters the instant from one mode")
    at = dict(setting(text, "--at") for text in split(given.at or []))
    found = coverage(graph, quantity, low, high, at=at, mode=mode)
    record |= found.record()
    if given.json:
        return
    say(graph.title or graph.name)
    say()
    say(str(found))


def _one_mode(given: Namespace, graph: FlatGraph, why: str) -> Mode | None:
    """Return the mode of ``--mode``, None without it; refuse more than one."""
    if len(given.mode) > 1:
        raise UsageError(why, code="HB-X101", where="--mode", hint="give one --mode, or none")
    return mode_of(graph, given.mode[0]) if given.mode else None
