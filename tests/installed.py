"""What an installed hybond must do: run by its library (`[tool.cibuildwheel]`, pyproject.toml).

`python tests/installed.py examples` ends with 0, or says what is wrong.
"""

import sys
from pathlib import Path

import hybond as hb


def main() -> int:
    folder = Path(sys.argv[1])
    run = hb.simulate(hb.load(folder / "diode_inductor.toml"))
    # the diode conducts until 10 mA are left of what 10 V drive through 10 ohm for 50 ms
    print(f"hybond {hb.__version__} of {Path(hb.__file__).parent}: {run.engine}, {run.status}")
    if run.engine != "the library":
        print("the wheel is without its library", file=sys.stderr)
        return 1
    expected = 0.05 + 0.1 / 0.7 * (0.9932620530009145 - 0.01)
    if abs(run.events[-1].t - expected) > 1e-9:
        print(f"the diode turns off at {run.events[-1].t}, not at {expected}", file=sys.stderr)
        return 1
    if not hb.library.names():
        print("the wheel is without its parts", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
