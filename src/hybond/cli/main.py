"""`main`: from the words of a command line to an exit code; no traceback leaves it."""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import sys
import warnings
from argparse import Namespace
from collections.abc import Sequence

from hybond.cli.arguments import parse
from hybond.cli.streams import complain, prepare

INTERRUPTED = 130
"""The exit code of what Ctrl-C ended, as shells have it: 128 + SIGINT."""
MANY = 100_000
"""New objects after which the garbage collector looks at them."""
LARGE = ("analyse", "equations", "linearise", "fit", "studio")
"""Verbs with matrices of the size of a model."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; return its exit code.

    Parameters
    ----------
    argv : sequence of str
        Default ``sys.argv[1:]``.

    Returns
    -------
    int
        0 fine, 1 usage, 2 the model, 3 the numerics, 130 interrupted.

    Examples
    --------
    >>> main(["run"])
    1
    """
    prepare()
    if argv is None:
        _begin()
    given = Namespace()
    try:
        given = parse(list(sys.argv[1:] if argv is None else argv))
        with warnings.catch_warnings():
            if not debugging():
                # Python's own warnings speak of our source, not of the user's model.
                warnings.simplefilter("ignore")
            code = verb(given)
        sys.stdout.flush()
        return code
    except SystemExit as end:  # argparse has shown a help page or the version
        return int(end.code or 0)
    except BrokenPipeError:
        # The reader (head, less) has seen enough; Python must not complain when it flushes.
        with contextlib.suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (Exception, KeyboardInterrupt) as error:
        if debugging():
            import traceback

            traceback.print_exc()
        return refused(given, error)


def _begin() -> None:
    """Have this process, which is the command's alone, begin and end in less time.

    What is imported stays: the collector looks at so many objects again only when there are many
    more, and at none of them at the end. NumPy's threads wait by computing, and what a model's
    size makes large (`LARGE`) alone has work for them; one says how many with the variable.
    """
    gc.set_threshold(MANY, 10, 10)
    atexit.register(gc.freeze)
    if len(sys.argv) > 1 and sys.argv[1] not in LARGE:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def debugging() -> bool:
    """Whether tracebacks are wanted: HYBOND_DEBUG is set, and not to 0."""
    return os.environ.get("HYBOND_DEBUG", "0") not in ("", "0")


def verb(given: Namespace) -> int:
    """Run the verb of a parsed command line; each is imported where it is used."""
    match given.verb:
        case "run":
            from hybond.cli.run import run

            return run(given)
        case "check":
            from hybond.cli.check import check

            return check(given)
        case "draw":
            from hybond.cli.draw import draw

            return draw(given)
        case "causality":
            from hybond.cli.causality import show_causality

            return show_causality(given)
        case "equations":
            from hybond.cli.equations import show_equations

            return show_equations(given)
        case "analyse":
            from hybond.cli.analyse import analyse

            return analyse(given)
        case "linearise":
            from hybond.cli.linearise import linearise

            return linearise(given)
        case "sweep":
            from hybond.cli.verb_words import is_plan

            if is_plan(given):
                from hybond.cli.plans import plan_sweep

                return plan_sweep(given)
            from hybond.cli.sweep import sweep

            return sweep(given)
        case "bifurcation":
            from hybond.cli.bifurcation import bifurcation

            return bifurcation(given)
        case "measure":
            from hybond.cli.measure import measure

            return measure(given)
        case "fit":
            from hybond.cli.fit import fit

            return fit(given)
        case "periodic":
            from hybond.cli.periodic import periodic

            return periodic(given)
        case "explain":
            from hybond.cli.explain import explain

            return explain(given)
        case "new":
            from hybond.cli.new import new

            return new(given)
        case "convert":
            from hybond.cli.convert import convert

            return convert(given)
        case "library":
            from hybond.cli.library import library

            return library(given)
        case "studio":
            from hybond.cli.studio import studio

            return studio(given)
        case "completion":
            from hybond.cli.arguments import parser_of_words
            from hybond.cli.completion import completion

            return completion(given, parser_of_words())
        case "export":
            from hybond.cli.export import export_model

            return export_model(given)
        case _:
            from hybond.cli.demo import demo

            return demo(given)


def refused(given: Namespace, error: BaseException) -> int:
    """Say what stopped a command, also as the object that ``--json`` promised."""
    from hybond.cli.flags import in_flags
    from hybond.cli.refusal import placed, refusal_of

    interrupted = isinstance(error, KeyboardInterrupt)
    refusal = None if interrupted else placed(refusal_of(error), given)
    if refusal is not None:
        refusal = in_flags(refusal, given)
    if getattr(given, "json", False):
        from hybond.cli.record import failure_record, to_json

        with contextlib.suppress(OSError):
            sys.stdout.write(to_json(failure_record(given.file, refusal)))
            sys.stdout.flush()
    if refusal is None:
        complain("interrupted")
        return INTERRUPTED
    complain(str(refusal))
    return refusal.exit_code
