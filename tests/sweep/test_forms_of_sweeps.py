"""Tables as Parquet and pandas, full runs as netCDF and Zarr: read back by others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb


def rc() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c", "node -> r1")
    return m


def swept(out: Path | None, **options: Any) -> Any:
    factors = {"r": "500 ohm, 1 kohm, 0 ohm, 2 kohm", "c.C": "1 mF, 0 F"}
    collect = "final(c.e), count(events), ended, curve(c.e, 3)"
    return hb.sweep(rc(), factors, until=1.0, collect=collect, out=out, **options)


def test_as_a_table_of_pandas() -> None:
    pytest.importorskip("pandas", reason="pandas is not installed")
    table = swept(None)
    frame = table.to_pandas()
    assert list(frame.columns) == table.columns[1:] and len(frame) == 8
    assert frame["code"].tolist() == table["code"].tolist()
    assert frame["r"].tolist() == [500.0, 500.0, 1000.0, 1000.0, 0.0, 0.0, 2000.0, 2000.0]


def test_as_parquet(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    table = swept(tmp_path / "s", part=3)
    whole = swept(tmp_path / "whole", part=100)
    files = [tmp_path / name / "table.parquet" for name in ("s", "whole")]
    assert files[0].read_bytes() == files[1].read_bytes()  # wherever parts end
    read = parquet.read_table(files[0])
    assert read.schema.field("c.C").metadata[b"unit"] == b"F"
    assert read.column("status").to_pylist() == table["status"].tolist()
    events = read.column("count(events)").to_pylist()
    assert events[0] == 1 and events[1] is None
    np.testing.assert_allclose(read.column("final(c.e)")[0].as_py(), 10 * np.exp(-2.0), rtol=1e-7)
    curve = read.column("curve(c.e, 3)")[2].as_py()
    np.testing.assert_allclose(curve, 10 * np.exp([0.0, -0.5, -1.0]), rtol=1e-7)
    assert whole["final(c.e)"].tolist() == pytest.approx(
        read.column("final(c.e)").to_pylist(), nan_ok=True
    )


@pytest.mark.parametrize("form", ["netcdf", "zarr"])
def test_full_runs(form: str, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    if form == "zarr":
        pytest.importorskip("zarr", reason="zarr is not installed")
    table = swept(tmp_path / "s", runs=form)
    ending = {"netcdf": "nc", "zarr": "zarr"}[form]
    files = sorted((tmp_path / "s" / "runs").iterdir())
    there = [k for k, code in enumerate(table["code"]) if not code]
    assert [f.name for f in files] == [f"{k:09}.{ending}" for k in there]
    opened = xarray.open_dataset(files[0], **({"engine": "zarr"} if form == "zarr" else {}))
    with opened as run:
        t, e = run["t"].values, run["c.e"].values
        np.testing.assert_allclose(e, 10.0 * np.exp(-t / 0.5), rtol=1e-7)
        assert run.attrs["parameter r"] == 500.0 and run["c.e"].attrs["units"] == "V"
