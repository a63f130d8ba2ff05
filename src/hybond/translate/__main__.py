"""``python -m hybond.translate check FILE...``: whether modules are portable."""

from __future__ import annotations

import sys
from pathlib import Path

from hybond.translate import PortableError, load
from hybond.translate.effects import effects_of


def main(words: list[str]) -> int:
    """Check the files that are named; return 0 if all of them are portable."""
    if len(words) < 2 or words[0] != "check":
        print("python -m hybond.translate check FILE...")
        return 1
    code = 0
    for name in words[1:]:
        try:
            effects_of(load([Path(name)]))
        except (PortableError, OSError, SyntaxError) as error:
            print(f"{name}: {error}")
            code = 2
        else:
            print(f"{name}: portable")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
