"""Tests of the library itself are skipped where there is none; a compiler has to make one."""

import os

import pytest
from engine.by_engine import ABSENT

from hybond.engine.compiled.compiler import compiler


@pytest.fixture
def native() -> None:
    """Skip a test of the library, or say that it should be there."""
    if not ABSENT:
        return
    if compiler() is not None and not os.environ.get("HYBOND_ENGINE"):
        pytest.fail(f"there is a compiler, but no library: {ABSENT}")
    pytest.skip(ABSENT)
