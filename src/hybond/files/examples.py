"""The examples that come with hybond."""

from __future__ import annotations

from pathlib import Path

from hybond.errors import UsageError
from hybond.names import did_you_mean


def examples_folder() -> Path:
    """Return the folder of the examples: within the package, or beside ``src`` in a checkout.

    Raises
    ------
    UsageError
        HB-X106 if this installation has none.
    """
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "examples", package.parents[1] / "examples"):
        if (folder / "bouncing_ball.toml").is_file():
            return folder
    raise UsageError(
        "this installation has no examples",
        code="HB-X106",
        where=str(package),
        hint="install hybond again, or give --examples DIR",
    )


def example(name: str) -> Path:
    """Return the file of an example by name.

    Raises
    ------
    UsageError
        HB-X106 with the nearest names.
    """
    files = {f.stem: f for f in models_in(examples_folder())}
    stem = name.removesuffix(".toml")
    if stem not in files:
        near = did_you_mean(stem, files)
        raise UsageError(
            f"there is no example {name!r}",
            code="HB-X106",
            where="--from",
            hint=near if near.startswith("did") else f"known names: {', '.join(files)}",
        )
    return files[stem]


def models_in(folder: Path) -> list[Path]:
    """Return the models of a folder; files whose names begin with ``_`` are parts of others."""
    return sorted(f for f in folder.glob("*.toml") if not f.name.startswith("_"))
