"""``hybond convert``: a model file in the other format."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from hybond.cli.streams import say
from hybond.cli.targets import check_new, check_target
from hybond.files import load, save


def convert(given: Namespace) -> int:
    """Read one model file and write another; nothing but a model is ever replaced."""
    target = check_target(given.target, (".toml", ".json"), "OUT")
    assert target is not None
    check_new(target, force=given.force)
    save(load(Path(given.source)), target)
    say(given.target)
    return 0
