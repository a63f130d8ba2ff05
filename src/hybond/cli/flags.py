"""Remedies of functions in the words of the command line: ``settle="10 s"`` is ``--settle '10 s'``.

A function says what to write in Python. Who gave a command has options for the same: what a remedy
names as an argument and the verb has as an option is said as one.
"""

from __future__ import annotations

import re
import shlex
from argparse import Namespace, _SubParsersAction
from collections.abc import Mapping

from hybond.errors import HybondError

VERBS = ("bifurcation", "fit", "linearise", "periodic", "sweep")
"""Verbs whose functions speak of their arguments."""
OTHERS = {"parameters": "--set", "executor": "--cluster", "values": "--along"}
"""Arguments whose options have another name."""

_VALUE = r"""\"[^\"]*\"|'[^']*'|\{[^{}]*\}|\[[^\[\]]*\]|\([^()]*\)|\.\.\.|[^\s,;)"'({\[]+"""
_GIVEN = re.compile(rf"(?<![\w.-])(?P<name>[a-z_]+)=(?P<value>{_VALUE})?(?![\w=])")
_CALL = re.compile(r"hb\.[a-z_]+\((?:model|run|\.\.\.)(?:, )?(?P<inside>[^()]*)\)")
_TICKED = re.compile(r"`(?P<name>[a-z_]+)`")
_PAIR = re.compile(r"\((?P<low>[^(),]*), (?P<high>[^(),]*)\)")
_QUOTES = "\"'"


def in_flags(refusal: HybondError, given: Namespace) -> HybondError:
    """Return a refusal whose place and remedy name options of a verb, where it has them."""
    verb = getattr(given, "verb", "")
    if verb not in VERBS:
        return refusal
    flags = flags_of(verb)
    if getattr(given, "along", None) is not None:
        flags["wrt"] = "--along"
    refusal.where = flags.get(refusal.where, refusal.where)
    refusal.hint = said(refusal.hint, flags)
    if refusal.where == "--along" and refusal.hint.startswith("("):
        refusal.hint = "--along 'D=0.3..0.7'"
    return refusal


def flags_of(verb: str) -> dict[str, str]:
    """Return the options of a verb by the arguments that they stand for."""
    from hybond.cli.arguments import parser_of_words

    actions = parser_of_words(verb)._actions
    own = next(a for a in actions if isinstance(a, _SubParsersAction)).choices[verb]
    known = [s for s in own._option_string_actions if s.startswith("--")]
    return {
        **{s[2:].replace("-", "_"): s for s in known},
        **{name: s for name, s in OTHERS.items() if s in known},
    }


def said(text: str, flags: Mapping[str, str]) -> str:
    """Return a text with arguments as options.

    Examples
    --------
    >>> flags = {"settle": "--settle", "bounds": "--bounds", "log": "--log", "period": "--period"}
    >>> said('let it settle (settle="100 s"), or hb.periodic(model, period="10us", tol=1)', flags)
    "let it settle (--settle '100 s'), or --period 10us, tol=1"
    >>> said("bounds={'pad.C': (0.5e-3, '2 mm/N')}, log=['pad.C']", flags)
    "--bounds 'pad.C=0.5e-3..2 mm/N', --log pad.C"
    >>> said("a longer `settle` tells it", flags)
    'a longer --settle tells it'
    """
    text = _TICKED.sub(lambda m: flags.get(m["name"], m[0]), text or "")
    text = _GIVEN.sub(lambda m: _option(m, flags), text)
    if "=" not in text or "--" in text:
        text = _CALL.sub(lambda m: m["inside"] or m[0], text)
    return text.replace("look at the run: error.partial", "look at the run: hybond run")


def _option(match: re.Match[str], flags: Mapping[str, str]) -> str:
    flag = flags.get(match["name"])
    if flag is None:
        return match[0]
    value = _plain(match["value"] or "", path=flag in ("--set", "--bounds"))
    return f"{flag} {value}".strip()


def _plain(value: str, *, path: bool) -> str:
    """Return a value of Python as it is written in a shell."""
    if value[:1] in _QUOTES:
        return shlex.quote(value[1:-1])
    if value[:1] == "{":
        inside = _PAIR.sub(r"\g<low>..\g<high>", re.sub("[\"']", "", value[1:-1]))
        return shlex.quote(inside.replace(": ", "=")) if ": " in inside else "PATH=VALUE"
    if value[:1] == "[":
        return re.sub(r"[\[\]\"'\s]", "", value)
    return "PATH=VALUE" if path and value == "..." else value
