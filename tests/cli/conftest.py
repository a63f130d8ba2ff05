"""Small model files, and the command line called as a function."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from hybond.cli.main import main
from hybond.cli.new import STARTER

SPRING = """\
hybond = 1
title = "Mass on a spring"
domain = "translational"
[parameters]
m = "2 kg"
k = "8 N/m"
[elements]
mass = { I = "m", f = "3 m/s" }
spring = { C = "1/k" }
v = { junction = 1 }
[graph]
bonds = ["v -> mass", "v -> spring"]
[experiment]
until = "2 s"
"""

BALL = """\
hybond = 1
title = "A ball that loses speed at each bounce"
domain = "translational"
[parameters]
e = 0.5
[elements]
weight = { Se = "-10 N" }
ball = { I = "1 kg" }
floor = { Sf = "-e*pre(v.f)" }
v = { junction = 1 }
contact = { junction = 0 }
[graph]
bonds = ["weight -> v -> ball", "contact -> v", "floor -> contact"]
[signals]
height = { integral = "v.f", start = "5 m" }
[machines.impact]
states = { away = [], hits = ["contact"] }
start = "away"
rules = ["away -> hits when height <= 0 and v.f < 0", "hits -> away when pre(v.f) >= 0"]
[experiment]
until = "1.5 s"
"""

NO_MODE = """\
hybond = 1
[elements]
S = { Se = 1 }
j = { junction = 1 }
d = { junction = 1 }
node = { junction = 0 }
c = { C = 1 }
r = { R = 1 }
r2 = { R = 1 }
[graph]
bonds = ["S -> j -> node -> c", "j -> r", "node -> d -> r2"]
[machines.D]
states = { a = [], b = ["d"] }
start = "a"
rules = ["a -> b when c.e > 0.5", "b -> a when c.e > 0.4"]
[experiment]
until = 5
plot = ["c.e"]
"""


@dataclass
class Done:
    """What a command has said, and its exit code."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        return json.loads(self.out)


class Shell:
    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self.capsys = capsys

    def file(self, name: str, text: str) -> str:
        (self.folder / name).write_text(text, encoding="utf-8")
        return name

    def __call__(self, *words: str) -> Done:
        self.capsys.readouterr()
        code = main(words)
        said = self.capsys.readouterr()
        return Done(code, said.out, said.err)


@pytest.fixture
def shell(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Shell:
    """Return a command line in an empty folder with a few models."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HYBOND_DEBUG", raising=False)
    made = Shell(tmp_path, capsys)
    made.file("spring.toml", SPRING)
    made.file("ball.toml", BALL)
    made.file("no_mode.toml", NO_MODE)
    made.file("charger.toml", STARTER)
    return made
