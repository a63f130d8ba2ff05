"""Random hybrid bond graphs, each run in several ways that must agree.

``python benchmarks/random_models.py 2000 --first 0 --processes 2`` says how runs ended, by status
or code of refusal, and for what must not be the seeds. ``--show 17`` prints one model and what is
said of it. ``--ways 1`` runs each once more in one way only, the next way for the next seed.
"""

from __future__ import annotations

import argparse
import multiprocessing
from collections import defaultdict
from functools import partial

from hybond.files.save import dumps
from hybond.testing import WAYS, Check, check_recipe, random_recipe


def checked(seed: int, count: int = len(WAYS)) -> tuple[int, Check]:
    """Check one model in so many further ways."""
    ways = [WAYS[(seed + k) % len(WAYS)] for k in range(count)]
    return seed, check_recipe(random_recipe(seed), seed=seed, ways=ways)


def main() -> None:
    """Check as many as asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--ways", type=int, default=len(WAYS))
    parser.add_argument("--show", type=int)
    given = parser.parse_args()
    if given.show is not None:
        print(dumps(random_recipe(given.show).model()))
        _, check = checked(given.show)
        print(check.outcome, *(f"{f.kind}: {f.said}" for f in check.findings), sep="\n")
        return
    outcomes: defaultdict[str, list[int]] = defaultdict(list)
    found: defaultdict[str, list[str]] = defaultdict(list)
    with multiprocessing.Pool(given.processes) as pool:
        seeds = range(given.first, given.first + given.count)
        for seed, check in pool.imap_unordered(
            partial(checked, count=given.ways), seeds, chunksize=8
        ):
            outcomes[check.outcome].append(seed)
            for finding in check.findings:
                found[finding.kind].append(f"{seed} ({check.outcome}): {finding.said}")
    for word, which in sorted(outcomes.items(), key=lambda item: -len(item[1])):
        seeds = "" if word == "ok" else " ".join(str(s) for s in sorted(which)[:40])
        print(f"{len(which):6d}  {word}  {seeds}".rstrip())
    for kind, lines in sorted(found.items()):
        print(f"\n{kind}: {len(lines)}", *sorted(lines), sep="\n  ")


if __name__ == "__main__":
    main()
