"""Random hybrid bond graphs, each run in several ways that must agree.

``python benchmarks/random_models.py 2000 --first 0`` says how runs ended, by status or code of
refusal, and for what must not be the seeds. With ``--into FILE`` each seed has a line in a file,
and the same command goes on where it was ended, a seed that hangs or crashes included. ``--show
17`` prints one model and what is said of it. ``--ways 1`` runs each once more in one way only, the
next way for the next seed. With ``--further`` these are ways that the tests leave out.
"""

from __future__ import annotations

import argparse
import multiprocessing
from functools import partial
from pathlib import Path

from counting import checked, count, read, told

from hybond.files.save import dumps
from hybond.testing import WAYS, random_recipe
from hybond.testing.check import FURTHER_WAYS


def main() -> None:
    """Check as many as asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2, help="without --into")
    parser.add_argument("--ways", type=int, default=len(WAYS))
    parser.add_argument("--into", type=Path, help="a file with a line for each seed, gone on with")
    parser.add_argument("--controlled", action="store_true", help="with clocks, gates, gaps, ...")
    parser.add_argument("--further", action="store_true", help="exact, last segments, halves")
    parser.add_argument("--show", type=int)
    given = parser.parse_args()
    of = FURTHER_WAYS if given.further else WAYS
    if given.show is not None:
        print(dumps(random_recipe(given.show, controlled=given.controlled).model()))
        print(told([checked(given.show, controlled=given.controlled)]))
        return
    seeds = range(given.first, given.first + given.count)
    if given.into is not None:
        count(seeds, given.into, ways=given.ways, controlled=given.controlled, of=of)
        print(told([line for line in read(given.into) if line.seed in seeds]))
        return
    with multiprocessing.Pool(given.processes) as pool:
        do = partial(checked, ways=given.ways, controlled=given.controlled, of=of)
        print(told(list(pool.imap_unordered(do, seeds, chunksize=8))))


if __name__ == "__main__":
    main()
