"""``hybond linearise``: a model near a point, or asked by an injected sine."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

import numpy as np

from hybond.cli.lists import mode_of, setting, split
from hybond.cli.netlists import read_model
from hybond.cli.record import to_json
from hybond.cli.running import simulate_with, tell_no_script
from hybond.cli.settings import flatten_with, model_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.cli.verb_words import PLOTS
from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.units import try_quantity

VERSION = 1
"""Version of the object of ``--json``."""
OF_INJECT = ("amplitude", "period", "tolerance", "windows")
NUMERICS = 3


def linearise(given: Namespace) -> int:
    """Linearise, or inject; return 3 if a frequency did not settle."""
    _check(given)
    model: Model | FlatGraph = read_model(given.file)[0]
    assert isinstance(model, Model)
    tell_no_script(model, "what is linearised is a run")
    inputs = split(given.input) if given.input else None
    outputs = split(given.output) if given.output else None
    target = check_target(given.plot, (".png", ".svg", ".pdf"), "--plot")
    if given.inject:
        return _inject(given, flatten_with(model, given.settings), inputs, outputs, target)
    if given.settings:
        model = model_with(model, given.settings)
    found = _linearised(given, model, inputs, outputs)
    if target is not None:
        _plot(given, found[0], str(target))
    if given.json:
        record = {"hybond": VERSION, "file": given.file, "points": [_point(f) for f in found]}
        say(to_json(record).rstrip("\n"))
        return 0
    for k, lin in enumerate(found):
        say(("\n" if k else "") + str(lin))
        if lin.inputs and lin.outputs:
            say(f"margins of {lin.outputs[0]} / {lin.inputs[0]} as a loop: {lin.margins()}")
    if target is not None:
        say(str(target))
    return 0


def _check(given: Namespace) -> None:
    """Refuse options that belong to another way, and kinds that there are not."""
    for option in OF_INJECT:
        if getattr(given, option) is not None and not given.inject:
            raise _refusal(f"--{option} belongs to --inject", f"--{option}")
    for option in ("at", "mode", "kind"):
        if getattr(given, option) and given.inject:
            raise _refusal(f"--{option} does not go with --inject", f"--{option}")
    if given.kind is not None:
        if given.kind not in PLOTS:
            raise _refusal(
                f"there is no plot {given.kind!r}", "--kind", did_you_mean(given.kind, PLOTS)
            )
        if given.plot is None:
            raise _refusal("--kind belongs to --plot", "--kind")


def _refusal(why: str, where: str, hint: str = "hybond linearise --help") -> UsageError:
    return UsageError(why, code="HB-X101", where=where, hint=hint)


def _linearised(
    given: Namespace, model: Model, inputs: list[str] | None, outputs: list[str] | None
) -> tuple[Any, ...]:
    from hybond.analysis.linear.linearise import linearise as linearised

    at = given.at or "start"
    mode = None if given.mode is None else mode_of(model.flatten(), given.mode)
    if at in ("start", "equilibrium"):
        lin = linearised(model, inputs=inputs, outputs=outputs, at=at, mode=mode)
        return (lin,)
    if "=" in at:
        states = dict(setting(text, "--at") for text in split([at]))
        return (linearised(model, inputs=inputs, outputs=outputs, at=states, mode=mode),)
    if mode is not None:
        raise _refusal("a run says itself in which mode it is", "--mode", "leave --mode out")
    times = [seconds(text, "--at") for text in split([at])]
    if not times or min(times) < 0.0:
        raise UsageError(
            f"{at!r} is no time of a run", code="HB-S110", where="--at", hint="such as '2 ms'"
        )
    if not any(times):
        return (linearised(model, inputs=inputs, outputs=outputs, at="start"),) * len(times)
    run = simulate_with(model.flatten(), max(times))
    if run.status == "interrupted":
        raise KeyboardInterrupt
    if run.error is not None and run.t_end < max(times):
        raise run.error
    return tuple(linearised(run, inputs=inputs, outputs=outputs, at=times))


def _plot(given: Namespace, lin: Any, target: str) -> None:
    kind = given.kind or "bode"
    options: dict[str, Any] = {}
    if kind in ("bode", "nyquist") and given.frequencies:
        options["frequencies"] = _frequencies(given.frequencies)
    getattr(lin, f"plot_{kind}")(target, **options)


def _point(lin: Any) -> dict[str, Any]:
    record: dict[str, Any] = lin.to_data()
    if lin.inputs and lin.outputs:
        found = lin.margins()
        record["margins"] = {
            "gain": found.gain,
            "gain_at": found.gain_at,
            "phase": found.phase,
            "phase_at": found.phase_at,
        }
    return record


def _inject(
    given: Namespace,
    graph: FlatGraph,
    inputs: list[str] | None,
    outputs: list[str] | None,
    target: Any,
) -> int:
    from hybond.analysis.linear.frequency import frequency_response

    for option, names in (("--input", inputs), ("--output", outputs)):
        if names is None or len(names) != 1:
            raise _refusal("--inject takes one input and one output", option)
    if not given.frequencies:
        raise _refusal("--inject needs frequencies", "--frequencies", "--frequencies 100..10kHz:9")
    assert inputs is not None and outputs is not None
    options = {name: getattr(given, name) for name in OF_INJECT if getattr(given, name) is not None}
    if "amplitude" in options:
        quantity = try_quantity(options["amplitude"])
        options["amplitude"] = options["amplitude"] if quantity is None else quantity.value
    found = frequency_response(
        graph,
        input=inputs[0],
        output=outputs[0],
        frequencies=_frequencies(given.frequencies),
        **options,
    )
    if target is not None:
        found.plot(str(target))
    if given.json:
        say(to_json({"hybond": VERSION, "file": given.file, **found.to_data()}).rstrip("\n"))
    else:
        say(str(found))
        if target is not None:
            say(str(target))
    if found.ok:
        return 0
    if not given.json:
        complain(f"{int((~found.settled).sum())} of {len(found.settled)} have not settled")
    return NUMERICS


def _frequencies(text: str) -> list[float]:
    """Return frequencies as they are written, Hz.

    Examples
    --------
    >>> [round(f) for f in _frequencies("100..10 kHz:3")], _frequencies("50, 1 kHz")
    ([100, 1000, 10000], [50.0, 1000.0])
    """
    from hybond.analysis.linear.responses import frequencies_of

    nothing = np.zeros(0)
    if ".." not in text:
        return list(frequencies_of(split([text]), nothing).tolist())
    span, _, count = (word.strip() for word in text.rpartition(":"))
    low, _, high = (word.strip() for word in span.partition(".."))
    if not count.isdigit() or int(count) < 2:
        raise _refusal(f"{text!r} is not LOW..HIGH:NUMBER", "--frequencies", "100..10kHz:9")
    ends = frequencies_of([low, high], nothing)
    return list(np.geomspace(ends[0], ends[1], int(count)).tolist())
