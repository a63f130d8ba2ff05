"""``hybond new``: a model to start from."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from hybond.cli.streams import say
from hybond.cli.targets import check_new, check_target
from hybond.files.examples import example
from hybond.files.whole import write_whole

STARTER = """\
hybond = 1
title  = "A capacitor kept between two voltages"
domain = "electrical"                     # effort in V, flow in A

[parameters]
low  = "2 V"
high = "4 V"

[elements]
supply = { Se = "5 V" }                   # a source of effort
wire   = { R = "1 kohm" }
leak   = { R = "10 kohm" }
cap    = { C = "100 uF", e = "0 V" }      # starts empty
series = { junction = 1 }                 # one flow through all its bonds
node   = { junction = 0 }                 # one effort on all its bonds

[graph]
bonds = ["supply -> series -> node -> cap", "series -> wire", "node -> leak"]

[machines.charger]                        # each state lists the junctions it switches ON
states = { charging = ["series"], resting = [] }
start  = "charging"
rules  = [
  "charging -> resting when cap.e >= high",
  "resting -> charging when cap.e <= low",
]

[experiment]
until = "3 s"
plot  = ["cap.e", "series.f"]
"""


def new(given: Namespace) -> int:
    """Write a starter model, or a copy of an example."""
    named = Path(given.file).name not in ("", "..") and not Path(given.file).suffix
    name = given.file + ".toml" if named else given.file
    target = check_target(name, (".toml", ".json"), "FILE")
    assert target is not None
    check_new(target, force=given.force)
    text = STARTER
    if given.example is not None:
        text = example(given.example).read_text(encoding="utf-8")
    if target.suffix.lower() == ".json":
        from hybond.files import dumps, loads

        model = loads(text)
        model.name = target.stem
        text = dumps(model, format="json")
    write_whole(target, text)
    say(f"{name}: now try  hybond run {name}")
    return 0
