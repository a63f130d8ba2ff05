"""The order of time-stepping: errors of six problems against their closed forms.

    python benchmarks/order_of_steps.py --plot docs/img/step_order.png

The problems and the errors are those of `tests/engine/semantics/test_order_of_time_stepping.py`,
where their slopes are held to.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "engine" / "semantics"))

from test_order_of_time_stepping import PROBLEMS, errors  # noqa: E402

STEPS = [50, 100, 200, 400, 800, 1600, 3200]
TITLES = {
    "oscillator": "mass on a spring",
    "decay": "capacitor that discharges",
    "ball": "ball that bounces",
    "stop": "mass against a stop",
    "brake": "block that brakes",
    "charger": "coil through a diode",
}


def main() -> None:
    """Print orders; draw them if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plot", type=Path, help="where to write the plot")
    asked = parser.parse_args()
    found = {(name, theta): errors(name, theta, STEPS) for name in PROBLEMS for theta in (0.5, 1.0)}
    print(f"{'problem':28} theta  order  error with {STEPS[-1]} steps")
    for (name, theta), error in found.items():
        order = -np.polyfit(np.log(STEPS[2:]), np.log(error[2:]), 1)[0]
        print(f"{TITLES[name]:28} {theta:5.1f}  {order:5.2f}  {error[-1]:.2e}")
    if asked.plot:
        draw(found, asked.plot)


def draw(found: dict[tuple[str, float], list[float]], path: Path) -> None:
    """Draw error over number of steps, a panel for each problem, with slopes to compare."""
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(2, 3, figsize=(9.0, 5.4), sharex=True, layout="constrained")
    for panel, name in zip(panels.flat, PROBLEMS, strict=True):
        for theta, mark, colour in ((0.5, "o", "C0"), (1.0, "s", "C1")):
            error = found[name, theta]
            order = PROBLEMS[name][4 if theta == 0.5 else 5]
            label = f"theta = {theta:g}: order {order:g}"
            panel.loglog(STEPS, error, mark, color=colour, ms=5, label=label)
            line = error[-1] * (np.array(STEPS) / STEPS[-1]) ** -order
            panel.loglog(STEPS, line, "-", color=colour, alpha=0.4)
        panel.legend(fontsize=8, loc="lower left")
        panel.set_title(TITLES[name], fontsize=10)
        panel.grid(alpha=0.3)
    for panel in panels[1]:
        panel.set_xlabel("steps")
    for panel in panels[:, 0]:
        panel.set_ylabel("mean error")
    figure.savefig(path, dpi=110)
    print(f"written: {path}")


if __name__ == "__main__":
    main()
