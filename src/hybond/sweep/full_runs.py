"""Full runs of members as files: netCDF or Zarr, one for each, whole or not at all."""

from __future__ import annotations

import contextlib
import importlib.util
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond.errors import UsageError
from hybond.files.whole import whole, write_whole
from hybond.model.parts import Value
from hybond.names import did_you_mean

if TYPE_CHECKING:
    from hybond.result import Result

FORMS: dict[str, tuple[str, tuple[str, ...]]] = {
    "netcdf": (".nc", ("xarray",)),
    "zarr": (".zarr", ("xarray", "zarr")),
}
"""Each with the ending of its files, and the packages that it needs."""
DIGITS = 9


def check_form(form: str) -> str:
    """Return a form of full runs that can be written here.

    Raises
    ------
    UsageError
        HB-P108 for one that there is not, or whose packages are not installed.
    """
    if form and form not in FORMS:
        raise UsageError(
            f"there is no form {form!r} of full runs",
            code="HB-P108",
            where="runs",
            hint=did_you_mean(form, FORMS),
        )
    for package in FORMS[form][1] if form else ():
        if importlib.util.find_spec(package) is None:
            raise UsageError(
                f"runs as {form} need the package {package}, which is not installed",
                code="HB-P108",
                where="runs",
                hint=f"pip install {package}",
            )
    return form


def path_of(folder: Path, member: int, form: str) -> Path:
    """Return where the run of a member lies.

    Examples
    --------
    >>> path_of(Path("runs"), 12, "netcdf").name
    '000000012.nc'
    """
    return folder / f"{member:0{DIGITS}}{FORMS[form][0]}"


def write_run(
    run: Result, folder: Path, member: int, form: str, given: Mapping[str, Value]
) -> None:
    """Write a run with its parameters, over what a sweep that was stopped has left."""
    target = path_of(folder, member, form)
    data: Any = run.to_xarray()
    data.attrs["member"] = member
    for path, value in given.items():
        data.attrs[f"parameter {path}"] = value
    if form == "netcdf":
        with whole(target) as new:
            # netCDF 4 where there is a package for it, else netCDF 3 by SciPy
            known = [e for e in ("h5netcdf", "netCDF4") if importlib.util.find_spec(e)]
            engine = known[0].lower() if known else "scipy"
            data.to_netcdf(new, engine=engine)
        return
    with _whole_folder(target) as new:
        data.to_zarr(new, mode="w", consolidated=False)


def read_files(folder: Path) -> dict[str, bytes]:
    """Return all files of a folder, by their path in it, with slashes."""
    found = sorted(p for p in folder.rglob("*") if p.is_file())
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in found}


def put_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write what `read_files` has read elsewhere: each run whole or not at all.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name:
    ...     put_files(Path(name), {"000000001.nc": b"a", "000000002.zarr/c/0": b"b"})
    ...     sorted(read_files(Path(name)))
    ['000000001.nc', '000000002.zarr/c/0']
    """
    runs: dict[str, dict[str, bytes]] = {}
    for path, data in files.items():
        run, _, within = path.partition("/")
        runs.setdefault(run, {})[within] = data
    for run, parts in runs.items():
        if "" in parts:
            write_whole(folder / run, parts[""])
            continue
        with _whole_folder(folder / run) as new:
            for within, data in parts.items():
                (new / within).parent.mkdir(parents=True, exist_ok=True)
                (new / within).write_bytes(data)


@contextlib.contextmanager
def _whole_folder(target: Path) -> Iterator[Path]:
    """Give the name of a new folder that takes the place of `target` when the block ends well."""
    import shutil

    new = target.with_name(f".{os.urandom(4).hex()}.{target.name}")
    try:
        yield new
        if target.exists():
            shutil.rmtree(target)
        os.replace(new, target)
    finally:
        shutil.rmtree(new, ignore_errors=True)
