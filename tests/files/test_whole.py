"""No writer leaves half a file: where the disk is full there is what was there before."""

import stat
import subprocess
import sys
from pathlib import Path

import pytest

from hybond.files.whole import whole, write_whole
from tests.example_runs import EXAMPLES

SCRIPT = """
import resource, sys
from pathlib import Path
import hybond as hb
from hybond.cli.main import main

model = hb.load("rod.toml")
run = hb.simulate(model, until=0.2)
many = hb.ensemble(model, 0.2, sets={"mu": [0.1, 0.2]}, workers=1)
drawing = hb.draw(model)
hb.draw(model).save("warm.png"), run.plot("slip.e", path="warm.png")  # fonts found, caches there
writers = {
    "saved.toml": lambda f: hb.save(model, f),
    "table.csv": run.to_csv,
    "table.npz": run.to_npz,
    "many.csv": many.to_csv,
    "many.npz": many.to_npz,
    "graph.svg": drawing.save,
    "graph.tex": drawing.save,
    "graph.png": drawing.save,
    "graph.pdf": drawing.save,
    "plot.png": lambda f: run.plot("slip.e", path=f),
    "program.mo": lambda f: hb.export(model, to="modelica", path=f),  # one writer of all languages
    "new.toml": lambda f: main(["new", f, "--force"]),
    "out.csv": lambda f: main(["run", "rod.toml", "--until", "0.2", "--out", f]),
    "out.json": lambda f: main(["run", "rod.toml", "--until", "0.2", "--out", f]),
    "sweep.json": lambda f: main(
        ["sweep", "rod.toml", "--vary", "mu=0.1,0.2", "--until", "0.2", "--out", f]
    ),
    "draw.svg": lambda f: main(["draw", "rod.toml", "--out", f]),
    "export.py": lambda f: main(["export", "rod.toml", "--to", "python", "--out", f, "--force"]),
}
sys.dont_write_bytecode = True  # Python does not find it cut short
_, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (64, hard))
silent = []
for name, write in writers.items():
    Path(name).write_text("as before")
    try:
        if write(name) == 0:
            silent.append(name)
    except (OSError, hb.HybondError, SystemExit) as error:
        continue
print(" ".join(["silent:", *silent]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs a limit on the size of a file")
@pytest.mark.slow
def test_a_full_disk_leaves_every_output_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "rod.toml").write_bytes((EXAMPLES / "falling_rod.toml").read_bytes())
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "silent:", done.stdout
    written = {f.name: f.read_bytes() for f in tmp_path.iterdir()}
    assert len(written) == 19
    changed = [n for n, b in written.items() if b != b"as before"]
    assert sorted(changed) == ["rod.toml", "warm.png"]


def test_permissions_and_links_are_kept(tmp_path: Path) -> None:
    file, link = tmp_path / "a.toml", tmp_path / "b.toml"
    file.write_text("old")
    file.chmod(0o600)
    link.symlink_to(file)
    write_whole(link, "new\n")
    assert link.is_symlink()
    assert file.read_bytes() == b"new\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600


def test_a_device_is_written_to_as_it_is() -> None:
    with whole("/dev/null") as given:
        assert given == Path("/dev/null")
    assert Path("/dev/null").is_char_device()


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="nowhere"):
        write_whole(tmp_path / "nowhere" / "x.csv", "")
