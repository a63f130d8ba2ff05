"""The library, or the reason why these tests are skipped."""

import pytest

from hybond.engine.compiled.compiler import compiler
from hybond.engine.compiled.native import Unavailable, library


@pytest.fixture(scope="session", autouse=True)
def there() -> None:
    try:
        library()
    except Unavailable as why:
        if compiler() is not None:
            pytest.fail(f"there is a compiler, but no library: {why}")
        pytest.skip(str(why))
