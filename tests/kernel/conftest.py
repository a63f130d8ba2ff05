"""The kernel, or the reason why these tests are skipped."""

import ctypes
import os
import sys
from pathlib import Path

import pytest

from hybond.kernel import build
from hybond.kernel.library import library

HERE = Path(__file__).parent
# random models, those of this folder and the passive networks of the next one
sys.path[:0] = [str(HERE), str(HERE.parent / "property")]


@pytest.fixture(autouse=True)
def _the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let runs be made by the reference, whose steps the kernel takes."""
    monkeypatch.setattr("hybond.simulation.ENGINE", "reference")


@pytest.fixture(scope="session")
def kernel() -> ctypes.CDLL:
    found = library()
    if isinstance(found, str):
        if build.compiler() is None or os.environ.get("HYBOND_KERNEL") == "off":
            pytest.skip(found)
        pytest.fail(f"there is a compiler, but no kernel: {found}")
    return found
