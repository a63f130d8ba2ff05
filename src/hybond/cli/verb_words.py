"""The options of verbs that have many, verb after verb; `arguments` has those of the others."""

from __future__ import annotations

from argparse import Action, ArgumentParser, Namespace
from typing import Any

from hybond.cli.shared_words import (
    Verb,
    file_word,
    input_word,
    json_word,
    option_word,
    picture_word,
    settings_words,
    solver_words,
    workers_word,
)
from hybond.cli.streams import say
from hybond.names import in_columns

PLOTS = ("bode", "nyquist", "step", "poles")
SWITCHES = ("collect", "sample", "estimate", "cluster", "runs")
NUMBERS = ("seed", "part")
"""Any of them makes a sweep one whose rows are collected in a folder."""


def linearise_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond linearise``."""
    parser = verb(
        verbs,
        "linearise",
        "hybond linearise motor.toml --input supply --output w.f --at equilibrium",
        "hybond linearise buck.toml --at '2 ms' --plot bode.png",
        "hybond linearise buck.toml --inject --input d --output out.e --frequencies 100..20kHz:9",
    )
    input_word(parser)
    parser.add_argument(
        "--input",
        metavar="NAME,...",
        action="append",
        help="sources, inputs, parameters (default: all inputs and sources with a value)",
    )
    parser.add_argument(
        "--output",
        metavar="SIGNAL,...",
        action="append",
        help="signals (default: what the experiment plots, else the states)",
    )
    parser.add_argument(
        "--at",
        metavar="WHERE",
        help="start (the default), equilibrium, times of a run as '2 ms, 5 ms', or states as "
        "c.q=1,ball.p='2 N*s'",
    )
    parser.add_argument(
        "--mode", metavar="MACHINE=STATE,...", help="the mode (default: the one that holds there)"
    )
    picture_word(parser)
    parser.add_argument(
        "--kind",
        metavar="WHAT",
        help="of --plot: bode (the default) or step, of all pairs; nyquist or poles, of the first",
    )
    parser.add_argument(
        "--frequencies",
        metavar="F,...",
        help="Hz: F,G,... or LOW..HIGH:NUMBER, evenly on a logarithmic scale",
    )
    parser.add_argument(
        "--inject",
        action="store_true",
        help="run the model with a small sine added to the input instead: for models that switch",
    )
    parser.add_argument("--amplitude", metavar="A", help="of --inject: the sine (default: 1 %%)")
    parser.add_argument("--period", metavar="T", help="of --inject: after which the model repeats")
    parser.add_argument(
        "--tolerance", metavar="R", type=float, help="of --inject: how well settled (default: 1e-3)"
    )
    parser.add_argument(
        "--windows", metavar="N", type=int, help="of --inject: after how many it gives up"
    )
    json_word(parser)
    return parser


def equations_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond equations``."""
    parser = verb(
        verbs,
        "equations",
        "hybond equations ball.toml",
        "hybond equations ball.toml --mode floor=touching --matrices",
        "hybond equations circuit.toml --outputs C1.e --transfer",
        "hybond equations rectifier.toml --complementarity",
    )
    file_word(parser)
    parser.add_argument(
        "--mode", metavar="MACHINE=STATE,...", help="one mode (default: all, with Booleans)"
    )
    parser.add_argument("--outputs", metavar="SIGNAL,...", help="signals to add as outputs y")
    parser.add_argument(
        "--complementarity",
        action="store_true",
        help="the linear complementarity system of the junctions with a law, machines staying in "
        "--mode (default: the start mode)",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--latex", action="store_true", help="write LaTeX")
    form.add_argument("--markdown", action="store_true", help="write Markdown")
    json_word(form)
    parser.add_argument("--matrices", action="store_true", help="also E, A, B, C, D")
    parser.add_argument(
        "--junctions", action="store_true", help="also the junction structure matrix"
    )
    parser.add_argument(
        "--transfer",
        action="store_true",
        help="also transfer functions and poles of the mode (default: the start mode)",
    )
    parser.add_argument(
        "--numbers", action="store_true", help="coefficients as numbers, not in parameters"
    )
    return parser


def analyse_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond analyse``."""
    parser = verb(
        verbs,
        "analyse",
        "hybond analyse clutch.toml --outputs load.f",
        "hybond analyse ball.toml --restitution contact --dt 1e-3 --write newton.toml",
        "hybond analyse circuit.toml --residuals --sensors Df,De1,De2",
        "hybond analyse ball.toml --coverage ball.p=-3..1 --at height=0",
    )
    file_word(parser)
    parser.add_argument(
        "--mode",
        metavar="MACHINE=STATE,...",
        action="append",
        default=[],
        help="analyse this mode (default: those that the machines can reach)",
    )
    parser.add_argument("--inputs", metavar="SOURCE,...", help="sources that can be steered")
    parser.add_argument("--outputs", metavar="SIGNAL,...", help="signals that are measured")
    parser.add_argument("--draw", metavar="FILE", help="draw the first mode with what was found")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--restitution",
        metavar="JUNCTION",
        help="the coefficient of restitution of the contact at this controlled junction",
    )
    what.add_argument(
        "--residuals", action="store_true", help="residuals for diagnosis, valid in all modes"
    )
    what.add_argument(
        "--coverage",
        metavar="QUANTITY=LOW..HIGH",
        help="for which values of a stored quantity some mode holds, and why none does",
    )
    parser.add_argument(
        "--at",
        metavar="NAME=VALUE,...",
        action="append",
        help="what else is stored, for --coverage (default: the start)",
    )
    parser.add_argument("--dt", metavar="T", help="the step of Margetts and Ngwompo's formula")
    parser.add_argument("--speed", metavar="V", help="impact speed, for a contact under load")
    parser.add_argument(
        "--write", metavar="FILE", help="write the model with Newton's law of restitution"
    )
    parser.add_argument(
        "--eps",
        metavar="E",
        help="restitution for --write (default: the formula's if --dt is given, else the one "
        "from integrating the contact phase)",
    )
    parser.add_argument("--force", action="store_true", help="let --write replace a file")
    parser.add_argument("--sensors", metavar="SIGNAL,...", help="what is measured, for --residuals")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--markdown", action="store_true", help="write Markdown")
    json_word(form)
    return parser


class _Functions(Action):
    """Lists what can be measured, as ``--help`` helps: no model is needed."""

    def __call__(self, parser: ArgumentParser, *_: object) -> None:
        """Print the list."""
        from hybond.measures.asked import FUNCTIONS

        lines = in_columns((name, line) for name, (_, _, line) in FUNCTIONS.items())
        say("\n".join(lines))
        parser.exit()


def measure_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond measure``."""
    parser = verb(
        verbs,
        "measure",
        "hybond measure buck.toml 'mean(L.f)' 'rms(C.e, period=20 us, periods=5)'",
        "hybond measure buck.toml 'thd(source.f, 50 Hz)' --json",
        "hybond measure buck.toml --losses --period '20 us' --power",
        "hybond measure buck.toml --losses --sankey losses.svg",
    )
    input_word(parser)
    parser.add_argument(
        "measures",
        metavar="MEASURE",
        nargs="*",
        help="a function of a signal (default: [experiment] measure)",
    )
    parser.add_argument(
        "--losses", action="store_true", help="where the energy came from and where it went"
    )
    parser.add_argument("--power", action="store_true", help="of --losses: the mean power, in W")
    parser.add_argument(
        "--depth", metavar="N", type=int, help="of --losses: add up parts below N levels"
    )
    parser.add_argument("--start", metavar="T", help="of --losses: where its window begins")
    parser.add_argument("--end", metavar="T", help="of --losses: where its window ends")
    parser.add_argument(
        "--period", metavar="T", help="of --losses: its window is the last period ('20 us')"
    )
    parser.add_argument("--periods", metavar="N", type=int, help="of --losses: or so many of them")
    parser.add_argument("--plot", metavar="FILE", help="of --losses: plot them over time")
    parser.add_argument("--sankey", metavar="FILE", help="of --losses: draw who gave and who took")
    parser.add_argument("--list", action=_Functions, nargs=0, help="list the functions")
    json_word(parser)
    return parser


def sweep_words(verb: Verb, verbs: Any) -> None:
    """Add the verb."""
    sweep = verb(
        verbs,
        "sweep",
        "hybond sweep ball.toml --vary m=1..2kg:11 --out masses.csv",
        "hybond sweep ball.toml --vary m=1kg,2kg --vary h0=1..3:5 --signals height",
        "hybond sweep ball.toml --vary 'm=normal(1 kg, 50 g)' --sample lhs:1000 --seed 7 "
        "--collect 'final(ball.p), count(events)' --out masses",
    )
    file_word(sweep)
    sweep.add_argument(
        "--vary",
        metavar="PATH=VALUES",
        action="append",
        default=[],
        help="PATH and values: LOW..HIGH:NUMBER, LOW:HIGH:STEP, log(LOW,HIGH,NUMBER), V,W,... "
        "or with --sample a distribution; several options: all combinations",
    )
    sweep.add_argument(
        "--together", action="store_true", help="the first values of all, the second, ...: no grid"
    )
    plan_words(sweep)
    settings_words(sweep)
    solver_words(sweep)
    sweep.add_argument(
        "--signals", metavar="NAME,...", action="append", help="what is read at the end"
    )
    workers_word(sweep)
    sweep.add_argument(
        "--out",
        metavar="FILE",
        help="write the table as .csv, .npz or .json; of --collect: a folder",
    )
    json_word(sweep)


def plan_words(parser: ArgumentParser) -> None:
    """Add those of a plan."""
    parser.add_argument(
        "--collect",
        metavar="WHAT,...",
        action="append",
        default=[],
        help="what is collected of each run: 'final(x), max(x), count(events), first(M.s)'; "
        "--out is a folder then, and the same command goes on where it was",
    )
    parser.add_argument(
        "--sample",
        metavar="WAY:N",
        help="draw N members: random, lhs, sobol, saltelli; or ends, for a tornado",
    )
    parser.add_argument("--seed", metavar="N", type=int, help="of --sample (default: 0)")
    parser.add_argument(
        "--runs", metavar="FORM", help="of --collect: keep full runs too, as netcdf or zarr"
    )
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help="of --collect: a scheduler of Dask, tcp://HOST:PORT"
    )
    parser.add_argument(
        "--part",
        metavar="N",
        type=int,
        help="of --collect: members written at once (default: as many as run in two seconds)",
    )
    parser.add_argument(
        "--estimate", action="store_true", help="of --collect: say what it takes, and run nothing"
    )


def is_plan(given: Namespace) -> bool:
    """Whether the options of a sweep make a plan of it."""
    numbers = any(getattr(given, name) is not None for name in NUMBERS)
    return numbers or any(getattr(given, name) for name in SWITCHES)


def fit_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond fit``."""
    parser = verb(
        verbs,
        "fit",
        "hybond fit ball.toml drop.csv --free pad.C,damper.G",
        "hybond fit ball.toml one.csv two.csv --free pad.C --log pad.C --plot fit.png",
        "hybond fit ball.toml drop.csv --free m --bounds 'm=0.5..2 kg' --loss soft_l1",
        "hybond fit ball.toml drop.csv --free eps --bounds eps=0.3..0.95 --starts 20",
    )
    input_word(parser)
    parser.add_argument(
        "data",
        metavar="DATA",
        nargs="+",
        help="CSV files: a column time, and one for each signal that was measured",
    )
    parser.add_argument(
        "--free",
        metavar="PATH,...",
        action="append",
        required=True,
        help="what is looked for: parameters, values of elements, starts",
    )
    parser.add_argument(
        "--log", metavar="PATH,...", action="append", help="what is looked for by its logarithm"
    )
    parser.add_argument(
        "--bounds",
        metavar="PATH=LOW..HIGH",
        action="append",
        default=[],
        help="between which values; either may be left out",
    )
    parser.add_argument(
        "--loss",
        metavar="LOSS",
        default="linear",
        help="what a residual counts: linear (squares), soft_l1, huber, cauchy, arctan",
    )
    parser.add_argument(
        "--starts",
        metavar="N",
        type=int,
        default=1,
        help="begin N times: with the model's values, then spread within --bounds; keep the best",
    )
    parser.add_argument("--seed", metavar="N", type=int, help="of --starts (default: 0)")
    option_word(parser, "rtol")
    parser.add_argument("--plot", metavar="FILE", help="plot data and runs")
    json_word(parser)
    return parser


def periodic_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond periodic``."""
    parser = verb(
        verbs,
        "periodic",
        "hybond periodic buck.toml --plot steady.png",
        "hybond periodic stick_slip.toml --settle '10 s'",
        "hybond periodic boost.toml --along 'D=0.3..0.7' --doublings 1 --plot branch.png",
    )
    input_word(parser)
    parser.add_argument(
        "--period",
        metavar="T",
        help="after which it repeats (default: what sources and inputs repeat with); where nothing "
        "drives the model a first guess",
    )
    parser.add_argument(
        "--multiple", metavar="N", type=int, default=1, help="how many of these periods it needs"
    )
    parser.add_argument(
        "--settle", metavar="T", help="how long it runs before the first step of Newton's method"
    )
    parser.add_argument(
        "--wrt", metavar="PATH,...", action="append", help="derivatives of the beginning by these"
    )
    parser.add_argument(
        "--along",
        metavar="PATH=FROM..TO",
        help="follow the orbit along a parameter, and name what it passes",
    )
    parser.add_argument(
        "--doublings",
        metavar="N",
        type=int,
        help="of --along: how many times branches of twice the period are followed",
    )
    parser.add_argument("--points", metavar="N", type=int, help="of --along: orbits at the least")
    parser.add_argument("--signals", metavar="NAME,...", action="append", help="what --plot shows")
    parser.add_argument("--solver", metavar="NAME", help="as for hybond run")
    parser.add_argument("--rtol", metavar="R", type=float, help="of the runs (default: 1e-10)")
    parser.add_argument("--max-step", metavar="H", help="longest step")
    picture_word(parser)
    json_word(parser)
    return parser


def bifurcation_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond bifurcation``."""
    parser = verb(
        verbs,
        "bifurcation",
        "hybond bifurcation buck.toml --vary Iref=0.5..1.9:500 --period T --of L.f --plot buck.png",
        "hybond bifurcation stop.toml --vary w=2.4..3.6:300 --period '2*pi/w' --of v.f "
        "--direction both",
        "hybond bifurcation stop.toml --vary w=2.4..3.6:300 --at stop.impact --before --of v.f",
    )
    input_word(parser)
    parser.add_argument(
        "--vary",
        metavar="PATH=VALUES",
        action="append",
        required=True,
        help="what varies, and its values: LOW..HIGH:NUMBER, LOW:HIGH:STEP, V,W,...",
    )
    parser.add_argument(
        "--of",
        metavar="NAME,...",
        action="append",
        required=True,
        help="signals that are looked at",
    )
    parser.add_argument(
        "--period", metavar="T", help="look once in this time: '20 us', T, '2*pi/w'"
    )
    parser.add_argument(
        "--at", metavar="M.s", help="instead: look each time machine M enters its state s"
    )
    parser.add_argument(
        "--before", action="store_true", help="look before what happens there, not after it"
    )
    parser.add_argument(
        "--settle", metavar="N", type=int, default=300, help="periods passed over (default: 300)"
    )
    parser.add_argument(
        "--keep", metavar="N", type=int, default=64, help="samples of each value (default: 64)"
    )
    parser.add_argument(
        "--direction",
        metavar="WAY",
        default="fresh",
        help="where each value begins: fresh (as the model does), or where the one before has "
        "come: up, down, both",
    )
    parser.add_argument(
        "--windows", metavar="X", help="follow each orbit to where it ends, to within X"
    )
    parser.add_argument("--limit", metavar="T", help="of --at: how long a value may take")
    workers_word(parser)
    parser.add_argument("--plot", metavar="FILE", help="draw the diagram")
    parser.add_argument("--out", metavar="FILE", help="write all samples as .csv or .json")
    json_word(parser)
    return parser
