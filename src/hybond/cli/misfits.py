"""What is wrong with a command line, in words, and what may be meant."""

from __future__ import annotations

import re
from argparse import ArgumentParser, _SubParsersAction
from collections.abc import Sequence

from hybond.errors import UsageError
from hybond.names import did_you_mean

_VALUE = re.compile(r"argument (?P<option>\S+): invalid (?P<kind>\w+) value: '(?P<value>.*)'")
_MISSING = re.compile(r"the following arguments are required: (?P<names>.+)")
_NO_VALUE = re.compile(r"argument (?P<option>\S+): expected one argument")
_TWO = re.compile(r"argument (?P<one>\S+): not allowed with argument (?P<other>\S+)")
_KINDS = {"float": ("a number", "1e-6"), "int": ("a whole number", "10")}

_ELSEWHERE = {
    **dict.fromkeys(("--measure", "--measures", "--outputs"), ("--collect", "--signals")),
    **dict.fromkeys(("-o", "--output", "--save", "--csv"), ("--out",)),
    **dict.fromkeys(("--param", "--params", "--parameter", "-p", "-D"), ("--set",)),
    **dict.fromkeys(("-t", "--time", "--t-end", "--tend", "--stop-time", "--end"), ("--until",)),
    **dict.fromkeys(("--method", "--integrator"), ("--solver",)),
    **dict.fromkeys(("--tol", "--tolerance"), ("--rtol",)),
    **dict.fromkeys(("--dt", "--step-size"), ("--step", "--max-step")),
    **dict.fromkeys(("-j", "--jobs", "--cores"), ("--workers",)),
    **dict.fromkeys(("--format",), ("--to",)),
}
"""What options of other programs, and of other verbs, are named here."""


_SUCH = {
    "--plot": "run.png",
    "--until": "1s",
    "--at": "0.1,0.2",
    "--set": "m=2kg",
    "--signals": "ball.f,height",
    "--vary": "m=1..2kg:11",
    "--solver": "radau",
}
"""Options that are met first, each with a value."""

VERBS_ELSEWHERE = {
    **dict.fromkeys(("simulate", "sim", "start", "execute"), "run FILE"),
    **dict.fromkeys(("plot", "graph"), "run FILE --plot run.png"),
    **dict.fromkeys(("view", "render", "picture", "show"), "draw FILE"),
    **dict.fromkeys(("open", "edit", "gui", "editor"), "studio FILE"),
    **dict.fromkeys(("validate", "lint", "test", "verify"), "check FILE"),
    **dict.fromkeys(("init", "create"), "new FILE"),
    **dict.fromkeys(("events", "why"), "explain FILE"),
    **dict.fromkeys(("linearize", "bode", "poles", "eigenvalues"), "linearise FILE"),
    **dict.fromkeys(("analyze", "analysis", "structure"), "analyse FILE"),
    **dict.fromkeys(("import", "spice"), "convert circuit.cir circuit.toml"),
    **dict.fromkeys(("parts", "components"), "library"),
    **dict.fromkeys(("losses", "energy"), "measure FILE --losses"),
    **dict.fromkeys(("optimise", "optimize", "estimate"), "fit FILE DATA --free PATH"),
    **dict.fromkeys(("example", "examples"), "demo"),
}
"""What verbs of other programs are here."""
_FILES = re.compile(r"[^=]+\.(svg|png|pdf|tex|jpg|csv|npz|json|toml|xlsx|c|java|fmu|mo|py)\Z")


def in_words(message: str, parser: ArgumentParser) -> tuple[str, str]:
    """Return the reason and the remedy of what the parser of options says.

    Examples
    --------
    >>> in_words("argument --rtol: invalid float value: 'x'", ArgumentParser(prog="hybond run"))
    ("--rtol 'x' is not a number", 'write --rtol 1e-6; hybond run --help')
    """
    help = f"{parser.prog} --help"
    if match := _VALUE.match(message):
        what, such = _KINDS.get(match["kind"], ("what is needed", "..."))
        option = match["option"]
        return f"{option} {match['value']!r} is not {what}", f"write {option} {such}; {help}"
    if match := _MISSING.match(message):
        example = (parser.epilog or "").split("\n")
        such = example[1].strip() if len(example) > 1 else help
        return f"{match['names']} is missing", f"{such}; {help}"
    if match := _NO_VALUE.match(message):
        option = match["option"].partition("/")[0]
        such = f"write {option} {_SUCH[option]}; " if option in _SUCH else ""
        return f"{match['option']} needs a value", f"{such}{help}"
    if match := _TWO.match(message):
        return f"{match['one']} is not allowed with {match['other']}", f"leave one out; {help}"
    return message, help


def unknown_option(parser: ArgumentParser, verb: str, rest: Sequence[str]) -> UsageError:
    """Return the refusal of words that a verb does not take: HB-X101."""
    verbs = next(a for a in parser._actions if isinstance(a, _SubParsersAction))
    own = verbs.choices.get(verb)
    word = rest[0]
    help = f"hybond {verb} --help"
    if own is None or not word.startswith("-"):
        why = f"{word!r} is one word more than {verb} takes"
        hint = f"put a value with spaces in quotes; {help}"
        if own is not None and "--out" in own._option_string_actions and _FILES.match(word):
            hint = f"write --out {word} for the file that is to be made; {help}"
        return UsageError(why, code="HB-X101", where=f"hybond {verb}", hint=hint)
    name = word.split("=", 1)[0]
    there = own._option_string_actions
    meant = next((n for n in _ELSEWHERE.get(name, ()) if n in there), "")
    near = f"did you mean {meant!r}?" if meant else did_you_mean(name, there)
    return UsageError(
        f"{verb} has no option {name}",
        code="HB-X101",
        where=f"hybond {verb}",
        hint=f"{near if near.startswith('did') else ''} {help}".strip(),
    )
