"""The kernel, or the reason why these tests are skipped."""

import ctypes
import os

import pytest

from hybond.kernel import build
from hybond.kernel.library import library


@pytest.fixture(scope="session")
def kernel() -> ctypes.CDLL:
    found = library()
    if isinstance(found, str):
        if build.compiler() is None or os.environ.get("HYBOND_KERNEL") == "off":
            pytest.skip(found)
        pytest.fail(f"there is a compiler, but no kernel: {found}")
    return found
