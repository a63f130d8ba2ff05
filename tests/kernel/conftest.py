"""The kernel, or the reason why these tests are skipped."""

import ctypes

import pytest

from hybond.kernel.library import library


@pytest.fixture(scope="session")
def kernel() -> ctypes.CDLL:
    found = library()
    if isinstance(found, str):
        pytest.skip(found)
    return found
