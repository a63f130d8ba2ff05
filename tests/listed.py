"""One test for a long list of quick cases: to collect each takes longer than to run it."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any


def listed(name: str, cases: Iterable[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Run a test with each case as the argument `name`; say all that fail."""
    every = list(cases)

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(test)
        def run(**given: Any) -> None:
            failed = []
            for case in every:
                try:
                    test(**given, **{name: case})
                except Exception as error:
                    failed.append(f"{case}: {type(error).__name__}: {error}")
            assert not failed, f"{len(failed)} of {len(every)}:\n" + "\n".join(failed)

        signature = inspect.signature(test)
        left = [p for p in signature.parameters.values() if p.name != name]
        run.__signature__ = signature.replace(parameters=left)  # type: ignore[attr-defined]
        return run

    return decorate
