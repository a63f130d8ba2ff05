"""Work that makes many objects and no cycles, done without the garbage collector looking on.

The collector walks all containers again whenever their number has grown by a part; where a graph
of 100,000 elements is built, that makes linear work grow faster than the graph.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def uncollected(work: Callable[P, T]) -> Callable[P, T]:
    """Return `work` as a function that the collector does not interrupt.

    Examples
    --------
    >>> @uncollected
    ... def collecting() -> bool:
    ...     return gc.isenabled()
    >>> collecting(), gc.isenabled()
    (False, True)
    """

    @wraps(work)
    def quietly(*args: P.args, **options: P.kwargs) -> T:
        if not gc.isenabled():
            return work(*args, **options)
        gc.disable()
        try:
            return work(*args, **options)
        finally:
            gc.enable()

    return quietly
