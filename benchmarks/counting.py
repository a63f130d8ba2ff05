"""A count of random models that can be gone on with: a line for each seed in a file.

All seeds run in one process, whose processor time for a seed is limited by the system: what hangs
within the engine ends it, as does what crashes it. Then that seed gets its line from outside, and
another process goes on behind it. Lines are JSON; the last may be cut off and is written again.
"""

from __future__ import annotations

import json
import multiprocessing
import resource
import signal
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from hybond.testing import WAYS, Finding, check_recipe, random_recipe

HANG = 300.0
"""Seconds of processor time after which a seed, all its ways together, counts as hung."""
MEMORY = 4 << 30
"""Bytes that the process may ask for."""
SLOW = 10.0
"""Seconds of processor time that a run may take."""


@dataclass(frozen=True)
class Line:
    """What came of a seed: the outcome of its run, what was found, seconds of processor time."""

    seed: int
    outcome: str
    seconds: float = 0.0
    findings: tuple[Finding, ...] = ()

    @property
    def text(self) -> str:
        """A line of JSON."""
        return json.dumps(asdict(self)) + "\n"


def ways_of(seed: int, count: int, of: Sequence[str] = WAYS) -> list[str]:
    """Return so many ways to run a seed once more; the next seed begins with the next."""
    return [of[(seed + k) % len(of)] for k in range(min(count, len(of)))]


def count(
    seeds: Iterable[int],
    path: Path,
    *,
    ways: int = len(WAYS),
    controlled: bool = False,
    of: Sequence[str] = WAYS,
) -> None:
    """Check the seeds of which the file has no line yet, and write one for each."""
    known = {line.seed for line in read(path)}
    left = [seed for seed in seeds if seed not in known]
    path.touch()
    if path.read_bytes()[-1:] not in (b"", b"\n"):
        with path.open("a") as file:  # what was cut off stays a line that says nothing
            file.write("\n")
    while left:
        child = multiprocessing.get_context("spawn").Process(
            target=_go_on, args=(left, path, ways, controlled, of)
        )
        child.start()
        child.join()
        known = {line.seed for line in read(path)}
        left = [seed for seed in left if seed not in known]
        if left and child.exitcode:
            hung = child.exitcode == -signal.SIGVTALRM
            word = "hang" if hung else f"ended by {child.exitcode}"
            with path.open("a") as file:
                file.write(Line(left.pop(0), word).text)


def _go_on(
    seeds: Sequence[int], path: Path, ways: int, controlled: bool, of: Sequence[str]
) -> None:
    signal.signal(signal.SIGVTALRM, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with path.open("a") as file:
        for seed in seeds:
            signal.setitimer(signal.ITIMER_VIRTUAL, HANG)
            file.write(checked(seed, ways, controlled, of).text)
            file.flush()


def checked(
    seed: int, ways: int = len(WAYS), controlled: bool = False, of: Sequence[str] = WAYS
) -> Line:
    """Check one seed in so many further ways."""
    begun = time.process_time()
    recipe = random_recipe(seed, controlled=controlled)
    check = check_recipe(recipe, seed=seed, patience=SLOW, ways=ways_of(seed, ways, of))
    return Line(seed, check.outcome, round(time.process_time() - begun, 4), check.findings)


def read(path: Path) -> list[Line]:
    """Return the lines of a file, without what was cut off; none if it is not there."""
    found = []
    for text in path.read_text().splitlines() if path.exists() else ():
        try:
            data = json.loads(text)
        except json.JSONDecodeError:
            continue
        findings = tuple(Finding(**f) for f in data.pop("findings"))
        found.append(Line(**data, findings=findings))
    return found


def told(lines: Sequence[Line]) -> str:
    """Return outcomes with their seeds, what was found, and what a seed took."""
    outcomes: defaultdict[str, list[int]] = defaultdict(list)
    found: defaultdict[str, list[str]] = defaultdict(list)
    for line in sorted(lines, key=lambda line: line.seed):
        outcomes[line.outcome].append(line.seed)
        for f in line.findings:
            found[f.kind].append(f"{line.seed} ({line.outcome}): {f.said}")
    text = []
    for word, which in sorted(outcomes.items(), key=lambda item: -len(item[1])):
        seeds = "" if word == "ok" else " ".join(map(str, which[:40]))
        text.append(f"{len(which):6d}  {word}  {seeds}".rstrip())
    for kind, said in sorted(found.items()):
        text += [f"\n{kind}: {len(said)}", *(f"  {s}" for s in said)]
    seconds = sorted(line.seconds for line in lines)
    if seconds:
        mean, middle = sum(seconds) / len(seconds), seconds[len(seconds) // 2]
        text.append(f"\n{len(lines)} seeds, {mean:.3g} s each, {middle:.3g} s half of them")
        slow = sorted(lines, key=lambda line: -line.seconds)[:10]
        text.append("most: " + ", ".join(f"{x.seed} {x.seconds:.3g} s" for x in slow))
    return "\n".join(text)
