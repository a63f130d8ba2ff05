"""The words of the command line: verbs, options, help.

This is `argparse` and not `typer`: a command that runs a small model takes about as long as it
takes to import what it needs, and typer with rich adds 0.15 s to every command where argparse
adds 0.01 s.
"""

from __future__ import annotations

from argparse import (
    Action,
    ArgumentParser,
    BooleanOptionalAction,
    Namespace,
    RawDescriptionHelpFormatter,
)
from collections.abc import Callable
from typing import Any, NoReturn

from hybond._version import __version__
from hybond.cli.misfits import VERBS_ELSEWHERE, in_words, unknown_option
from hybond.cli.shared_words import (
    diode_word,
    file_word,
    input_word,
    json_word,
    limits_words,
    option_word,
    picture_word,
    script_word,
    settings_words,
    solver_words,
)
from hybond.cli.streams import say
from hybond.cli.verb_words import (
    analyse_words,
    bifurcation_words,
    equations_words,
    fit_words,
    linearise_words,
    measure_words,
    periodic_words,
    sweep_words,
)
from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.options import MADE

MANY = {"measure": "measures", "fit": "data"}
"""The words of a verb of which there may be many."""
VERBS = {
    "demo": "draw and run an example, or a folder of them",
    "new": "write a small model to start from",
    "check": "say what is wrong with a model, and what to try",
    "draw": "draw the bond graph with its causal strokes",
    "causality": "say which strokes depend on the mode, and why",
    "equations": "print the equations of all modes, or of one",
    "analyse": "analyse the structure of each mode, a contact, what sensors can tell",
    "linearise": "linearise a model near a point; Bode, steps, poles; or inject a sine",
    "run": "simulate a model",
    "sweep": "simulate a model with many values of its parameters",
    "bifurcation": "say what a model comes to, value after value, and draw it",
    "measure": "simulate, and say what is measured of it: means, extremes, harmonics, losses",
    "fit": "find values of a model with which its runs are nearest to data",
    "periodic": "find a motion that repeats, its multipliers, and follow it along a parameter",
    "explain": "simulate, and say when and why each switch happened",
    "convert": "write a model file in the other format, or from a SPICE netlist",
    "library": "list the ready parts, look for some, or show one",
    "export": "write a model as a program, or for another tool",
    "studio": "draw, run and look at models in the browser",
    "completion": "print what a shell needs to complete verbs and options",
}

CODES = "Exit codes: 0 fine, 1 usage, 2 the model, 3 the numerics, 130 interrupted."


class _Version(Action):
    """Says what this is, and what makes runs: without its library hybond is many times slower."""

    def __call__(self, parser: ArgumentParser, *given: object) -> NoReturn:
        # imported here: no verb needs it before it has read its words
        from hybond.engine.outcome.engines import choose_engine

        say(f"hybond {__version__}\nruns are made by {choose_engine().said}")
        parser.exit()


class Parser(ArgumentParser):
    """A parser that refuses as everything in hybond does."""

    def error(self, message: str) -> NoReturn:
        """Raise the refusal of a command line (argparse would leave the program)."""
        why, hint = in_words(message, self)
        raise UsageError(why, code="HB-X101", where=self.prog, hint=hint)


def parse(argv: list[str]) -> Namespace:
    """Return the options of a command line.

    Raises
    ------
    UsageError
        HB-X101.

    Examples
    --------
    >>> parse(["draw", "ball.toml", "--numbers"]).numbers
    True
    >>> parse(["rnu", "ball.toml"])
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-X101 at hybond: there is no verb 'rnu'
      try: did you mean 'run'?
    """
    parser = parser_of_words(argv[0] if argv else "")
    if not argv:
        raise UsageError("no verb is given", code="HB-X101", where="hybond", hint="hybond --help")
    if not argv[0].startswith("-") and argv[0] not in VERBS:
        same = VERBS_ELSEWHERE.get(argv[0].lower(), "")
        raise UsageError(
            f"there is no verb {argv[0]!r}",
            code="HB-X101",
            where="hybond",
            hint=f"write hybond {same}" if same else did_you_mean(argv[0], VERBS),
        )
    given, rest = parser.parse_known_args(argv)
    if argv[0] in MANY and not any(word.startswith("-") for word in rest):
        # the parser fills a list from the words that stand together; options may stand between
        getattr(given, MANY[argv[0]]).extend(rest)
        rest = []
    if rest:
        raise unknown_option(parser, argv[0], rest)
    return given


def parser_of_words(verb: str = "") -> Parser:
    """Return the parser of all verbs and options; or of one verb, which takes less time."""
    parser = Parser(
        prog="hybond",
        description="Model, analyse and simulate physical systems as hybrid bond graphs.",
        epilog=f"Begin with: hybond demo\n{CODES}",
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, help="what this is, and what runs it"
    )
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    for words in [_WORDS[verb]] if verb in _WORDS else _WORDS.values():
        words(verbs)
    return parser


def _demo(verbs: Any) -> None:
    demo = _verb(verbs, "demo", "hybond demo", "hybond demo --examples examples --out out")
    demo.add_argument("--examples", metavar="DIR", help="run every model in this folder")
    demo.add_argument("--out", metavar="DIR", help="where files go (default: hybond-demo)")


def _new(verbs: Any) -> None:
    new = _verb(verbs, "new", "hybond new pump.toml", "hybond new ball.toml --from bouncing_ball")
    new.add_argument("file", metavar="FILE", help="the file to write")
    new.add_argument("--from", dest="example", metavar="EXAMPLE", help="start from this example")
    new.add_argument("--force", action="store_true", help="replace a file that is there")


def _check(verbs: Any) -> None:
    check = _verb(
        verbs,
        "check",
        "hybond check ball.toml",
        "hybond check --cross rectifier.toml --step '10 us'",
        "hybond check --modes relay.toml --out modes.svg",
    )
    file_word(check)
    check.add_argument(
        "--modes",
        action="store_true",
        help="say which modes can follow each other, and whether time always goes on",
    )
    check.add_argument("--out", metavar="FILE", help="of --modes: draw them, .svg, .png, ...")
    check.add_argument(
        "--where",
        action="append",
        default=[],
        metavar="CONDITION",
        help="of --modes: what is known of states, as 'pad.q >= 0'; as often as needed",
    )
    check.add_argument(
        "--limit", type=int, metavar="N", help="of --modes: modes that are looked at (200)"
    )
    check.add_argument(
        "--cross", action="store_true", help="run it with two engines and compare what they say"
    )
    check.add_argument(
        "--until", metavar="T", help="of --cross and --modes: end time, as 3 or '50 ms'"
    )
    check.add_argument(
        "--step", metavar="H", help="of --cross: the longest step; it is halved twice or more"
    )
    check.add_argument(
        "--engines",
        metavar="A,B",
        help="of --cross: two solvers (default: the model's own, and moreau-jean or radau)",
    )
    check.add_argument(
        "--json",
        action="store_true",
        help="print one JSON object with places",
    )
    settings_words(check)


def _draw(verbs: Any) -> None:
    draw = _verb(
        verbs,
        "draw",
        "hybond draw ball.toml",
        "hybond draw ball.toml --mode floor=touching",
        "hybond draw ball.toml --panels --out ball.tex",
        "hybond draw boost.toml --schematic",
    )
    file_word(draw)
    draw.add_argument(
        "--out", metavar="FILE", help="a .svg, .png, .pdf or .tex (default: an .svg here)"
    )
    draw.add_argument(
        "--mode",
        metavar="MACHINE=STATE,...",
        action="append",
        default=[],
        help="draw this mode; machines not named are in their start state",
    )
    kinds = draw.add_mutually_exclusive_group()
    kinds.add_argument(
        "--hybrid",
        action="store_true",
        help="all modes in one picture, with dashed strokes (default if there are machines); "
        "--mode is its reference mode",
    )
    kinds.add_argument(
        "--panels",
        action="store_true",
        help="modes side by side: all, or those given by several --mode",
    )
    kinds.add_argument(
        "--schematic",
        action="store_true",
        help="parts as symbols and wires between them",
    )
    draw.add_argument("--columns", metavar="N", type=int, help="panels in a row")
    draw.add_argument(
        "--legend",
        action=BooleanOptionalAction,
        default=True,
        help="explain the signs that occur (default: yes)",
    )
    draw.add_argument("--numbers", action="store_true", help="number the bonds")
    detail = draw.add_mutually_exclusive_group()
    detail.add_argument(
        "--simplify",
        action="store_true",
        help="leave out junctions between two bonds, grounds, and losses of zero "
        "(default if the model is made of parts)",
    )
    detail.add_argument("--full", action="store_true", help="draw all there is")
    draw.add_argument("--closed", action="store_true", help="draw each part as a box")
    draw.add_argument(
        "--open",
        metavar="PART",
        action="append",
        default=[],
        help="draw each part as a box but this one, with a frame around what is in it",
    )
    settings_words(draw)


def _causality(verbs: Any) -> None:
    causality = _verb(
        verbs,
        "causality",
        "hybond causality ball.toml --mode floor=touching",
        "hybond causality circuit.toml --diagnostic --sensors n1,n2 --advice",
    )
    file_word(causality)
    causality.add_argument(
        "--mode", metavar="MACHINE=STATE,...", help="the mode (default: the reference mode)"
    )
    causality.add_argument("--all", action="store_true", help="list all bonds of a big model")
    causality.add_argument(
        "--why",
        metavar="BOND",
        action="append",
        default=[],
        help="only why this bond ('contact -> v') has its stroke",
    )
    causality.add_argument(
        "--advice", action="store_true", help="where a resistor makes strokes the same in all modes"
    )
    causality.add_argument(
        "--diagnostic", action="store_true", help="look for one causality for all modes"
    )
    causality.add_argument(
        "--sensors", metavar="JUNCTION,...", help="for --diagnostic: what is measured"
    )
    json_word(causality)
    settings_words(causality)


def _equations(verbs: Any) -> None:
    settings_words(equations_words(_verb, verbs))


def _analyse(verbs: Any) -> None:
    settings_words(analyse_words(_verb, verbs))


def _linearise(verbs: Any) -> None:
    settings_words(linearise_words(_verb, verbs))


def _run(verbs: Any) -> None:
    run = _verb(
        verbs,
        "run",
        "hybond run ball.toml --set m=2kg --plot ball.png",
        "hybond run ball.toml --json --at '0.5, 800 ms' --signals height,ball.p",
    )
    input_word(run)
    settings_words(run)
    solver_words(run)
    run.add_argument(
        "--start", metavar="FILE", help="begin with a state that --save-state has written"
    )
    run.add_argument(
        "--save-state", metavar="FILE", help="write the state at the end, a .json to start from"
    )
    script_word(run)
    limits_words(run)
    run.add_argument("--at", metavar="T,...", action="append", help="sample times, as 0.5,'50 ms'")
    run.add_argument(
        "--signals",
        metavar="NAME,...",
        action="append",
        help="what is sampled, written by --out and plotted by --plot",
    )
    run.add_argument("--out", metavar="FILE", help="write the run as .csv, .npz or .json")
    diode_word(run)
    picture_word(run, "plot the run")
    json_word(run)


def _sweep(verbs: Any) -> None:
    sweep_words(_verb, verbs)


def _bifurcation(verbs: Any) -> None:
    diagram = bifurcation_words(_verb, verbs)
    settings_words(diagram)
    solver_words(diagram)


def _measure(verbs: Any) -> None:
    measure = measure_words(_verb, verbs)
    settings_words(measure)
    solver_words(measure)
    script_word(measure)


def _fit(verbs: Any) -> None:
    settings_words(fit_words(_verb, verbs))


def _periodic(verbs: Any) -> None:
    settings_words(periodic_words(_verb, verbs))


def _explain(verbs: Any) -> None:
    explain = _verb(verbs, "explain", "hybond explain ball.toml --at '0.8 s'")
    file_word(explain)
    explain.add_argument("--at", metavar="T", help="only the event nearest to this time")
    settings_words(explain)
    solver_words(explain)
    script_word(explain)
    limits_words(explain)


def _convert(verbs: Any) -> None:
    convert = _verb(
        verbs,
        "convert",
        "hybond convert ball.toml ball.json",
        "hybond convert rectifier.cir rectifier.toml --diode-current '10 mA'",
    )
    convert.add_argument(
        "source",
        metavar="IN",
        help="a model file (.toml, .json), a SPICE netlist (.cir, .net, .sp, .spi, .ckt, .spice), "
        "a schematic of LTspice (.asc), or a "
        "file of BondGraphTools (.bg)",
    )
    convert.add_argument("target", metavar="OUT", help="the file to write, .toml or .json")
    convert.add_argument("--force", action="store_true", help="write into a model that is there")
    convert.add_argument(
        "--strict", action="store_true", help="of other tools: refuse what would be a warning"
    )
    diode_word(convert)


def _library(verbs: Any) -> None:
    library = _verb(
        verbs,
        "library",
        "hybond library",
        "hybond library electrical.diode",
        "hybond library transformer",
        "hybond library electrical.diode --file > my_diode.toml",
    )
    library.add_argument(
        "part", metavar="PART", nargs="?", help="a part, a domain, or a word to look for"
    )
    library.add_argument("--file", action="store_true", help="print its model file")


def _studio(verbs: Any) -> None:
    page = _verb(verbs, "studio", "hybond studio ball.toml", "hybond studio")
    page.add_argument("file", metavar="FILE", nargs="?", help="a model file, new or there already")
    page.add_argument(
        "--port", type=int, default=0, metavar="N", help="listen on this port (default: a free one)"
    )
    page.add_argument("--no-browser", action="store_true", help="print the address, open nothing")


def _completion(verbs: Any) -> None:
    shell = _verb(verbs, "completion", 'eval "$(hybond completion bash)"')
    shell.add_argument("shell", metavar="SHELL", help="bash, zsh or fish")


def _export(verbs: Any) -> None:
    export = _verb(
        verbs,
        "export",
        "hybond export ball.toml --to c",
        "hybond export ball.toml --to java --out -",
        "hybond export ball.toml --to fmu --fmi 2.0 --set m=2kg",
    )
    file_word(export)
    export.add_argument(
        "--to", metavar="TARGET", required=True, help="c, java, fmu, python, latex or modelica"
    )
    export.add_argument("--out", metavar="FILE", help="the file to write; - prints it")
    export.add_argument("--force", action="store_true", help="replace a file that is there")
    settings_words(export)
    export.add_argument("--until", metavar="T", help="end time, as 3 or '50 ms'")
    for name in MADE:
        option_word(export, name)
    export.add_argument("--points", metavar="N", type=int, help="rows of the table")
    export.add_argument("--fmi", metavar="V", help="of fmu: version 3.0 (the default) or 2.0")


_WORDS: dict[str, Callable[[Any], None]] = {
    "demo": _demo,
    "new": _new,
    "check": _check,
    "draw": _draw,
    "causality": _causality,
    "equations": _equations,
    "analyse": _analyse,
    "linearise": _linearise,
    "run": _run,
    "sweep": _sweep,
    "bifurcation": _bifurcation,
    "measure": _measure,
    "fit": _fit,
    "periodic": _periodic,
    "explain": _explain,
    "convert": _convert,
    "library": _library,
    "studio": _studio,
    "completion": _completion,
    "export": _export,
}
"""What adds the options of each verb, in the order of the help."""


def _verb(verbs: Any, name: str, *examples: str) -> ArgumentParser:
    text = VERBS[name]
    lines = "\n".join(f"  {e}" for e in examples)
    plural = "s" if len(examples) > 1 else ""
    parser: ArgumentParser = verbs.add_parser(
        name,
        help=text,
        description=text[0].upper() + text[1:] + ".",
        epilog=f"example{plural}:\n{lines}",
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    return parser
