"""Files that are written as a whole: after a failure half-way there is what was there before."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray


@contextmanager
def whole(path: str | Path) -> Iterator[Path]:
    """Give the name of a new file that takes the place of `path` when the block ends well.

    The new file lies beside `path` and ends in the same suffix; links are followed, permissions
    kept. What is not a regular file, as a pipe or a terminal, is given as it is.

    Yields
    ------
    Path
        To be written, by any writer.

    Raises
    ------
    OSError
        That of the writer, or of the place. No part of the new file is left.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     table = pathlib.Path(folder, "table.csv")
    ...     _ = table.write_text("t,x")
    ...     try:
    ...         with whole(table) as new:
    ...             _ = new.write_text("t,")
    ...             raise OSError("no space left")
    ...     except OSError as error:
    ...         print(error, [f.name for f in table.parent.iterdir()], table.read_text())
    no space left ['table.csv'] t,x
    """
    try:
        target = Path(path).resolve()
    except ValueError:  # letters that no file system has
        raise OSError(errno.EINVAL, "that is no name of a file", ascii(str(path))[1:-1]) from None
    if target.exists() and not target.is_file():
        yield target
        return
    new = target.with_name(f".{os.urandom(4).hex()}.{target.name}")
    try:
        yield new
        if target.exists():
            os.chmod(new, target.stat().st_mode)
        os.replace(new, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            new.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno and error.filename in (None, str(new)):
            # a full disk names no file, and a folder that is not ours one that nobody asked for
            error.filename = str(path)
        raise


def write_whole(path: str | Path, data: str | bytes) -> None:
    """Write a text (UTF-8, lines as they are) or bytes to a file, all or nothing."""
    with whole(path) as new, open(new, "wb") as file:
        file.write(data.encode("utf-8") if isinstance(data, str) else data)


def write_rows(path: str | Path, columns: Mapping[str, NDArray[Any]]) -> None:
    """Write columns as CSV, their names first, all or nothing."""
    import csv

    with whole(path) as new, open(new, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))


def write_arrays(path: str | Path, columns: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as NumPy's ``.npz``, all or nothing; the ending is added where it is missing."""
    import numpy as np

    target = Path(path)
    if target.suffix != ".npz":
        target = target.with_name(target.name + ".npz")
    with whole(target) as new, open(new, "wb") as file:
        np.savez(file, allow_pickle=False, **columns)
