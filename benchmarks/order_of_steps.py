"""The order of time-stepping: errors of six problems against their closed forms.

    python benchmarks/order_of_steps.py --plot docs/img/step_order.png

Their slopes are held to in `tests/engine/semantics/test_order_of_time_stepping.py`.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

import hybond as hb

G = 9.81
STEPS = [50, 100, 200, 400, 800, 1600, 3200]
TITLES = {
    "oscillator": "mass on a spring",
    "decay": "capacitor that discharges",
    "ball": "ball that bounces",
    "stop": "mass against a stop",
    "brake": "block that brakes",
    "charger": "coil through a diode",
}


def stepped(model: hb.Model, until: float, step: float, theta: float = 0.5) -> hb.Result:
    return hb.simulate(model, until, solver="moreau-jean", step=step, theta=theta)


def oscillator() -> hb.Model:
    m = hb.Model("oscillator", domain="translational")
    m.add(mass=hb.I(1.0), spring=hb.C(0.04, q=1.0), v=hb.One())
    m.bond("v -> mass", "v -> spring")
    return m


def decay() -> hb.Model:
    m = hb.Model("decay", domain="electrical")
    m.add(c=hb.C(0.5, e=2.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    return m


def ball(eps: float) -> hb.Model:
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se(-G), ball=hb.I(1.0), v=hb.One())
    m.add(contact=hb.Zero(law="unilateral", gap="height", restitution=eps))
    m.bond("weight -> v -> ball", "contact -> v")
    m.signal(height=hb.Integral("v.f", start=1.0))
    return m


def bounces(eps: float, t: np.ndarray) -> np.ndarray:
    """Height by Newton's law: parabolas, until 1.2 s of which the second impact is the last."""
    first = math.sqrt(2.0 / G)
    second = first * (1.0 + 2.0 * eps)
    up, again = G * first * eps, G * first * eps**2
    late = t - second
    return np.where(
        t < first,
        1.0 - 0.5 * G * t**2,
        np.where(
            t < second,
            up * (t - first) - 0.5 * G * (t - first) ** 2,
            again * late - 0.5 * G * late**2,
        ),
    )


def brake() -> hb.Model:
    """A block that dry friction brings to rest after 1/3 s."""
    m = hb.Model("brake", domain="translational")
    m.add(block=hb.I(2.0, f=1.0), v=hb.One(law="coulomb", limit=6.0))
    m.bond("v -> block")
    m.signal(x=hb.Integral("v.f"))
    return m


def brakes(t: np.ndarray) -> np.ndarray:
    s = np.minimum(t, 1.0 / 3.0)
    return s - 1.5 * s**2


def stop() -> hb.Model:
    """A mass on a spring against a stop at its rest position: half waves of one side."""
    m = hb.Model("stop", domain="translational")
    m.add(mass=hb.I(1.0), spring=hb.C(0.04, q=1.0), v=hb.One())
    m.add(contact=hb.Zero(law="unilateral", gap="spring.q", restitution=1.0))
    m.bond("v -> mass", "v -> spring", "contact -> v")
    return m


def charger() -> hb.Model:
    """A coil pours its current through a diode into a capacitor, once."""
    m = hb.Model("charger", domain="electrical")
    m.add(l=hb.I(1.0, f=1.0), c=hb.C(0.25), d=hb.One(law="diode"))
    m.bond("d -> l", "d -> c")
    return m


def charges(t: np.ndarray) -> np.ndarray:
    """Charge: a quarter of a swing, then it is kept."""
    return 0.5 * np.sin(2.0 * np.minimum(t, math.pi / 4.0))


PROBLEMS: dict[str, tuple[Callable[[], hb.Model], str, Callable, float, float, float]] = {
    # model, variable, closed form, end, order with theta = 1/2, with theta = 1
    "oscillator": (oscillator, "spring.q", lambda t: np.cos(5.0 * t), 2.0, 2.0, 1.0),
    "decay": (decay, "c.e", lambda t: 2.0 * np.exp(-2.0 * t), 2.0, 2.0, 1.0),
    "ball": (lambda: ball(0.8), "height", lambda t: bounces(0.8, t), 1.2, 1.0, 1.0),
    "stop": (stop, "spring.q", lambda t: np.abs(np.cos(5.0 * t)), 2.0, 1.0, 1.0),
    # one event in all, after which nothing moves: it costs a second order at most
    "brake": (brake, "x", brakes, 1.0, 2.0, 1.0),
    "charger": (charger, "c.q", charges, 2.0, 2.0, 1.0),
}


def errors(name: str, theta: float, steps: list[int]) -> list[float]:
    """Mean errors at forty times, whatever the steps are: each is a mean of some lengths."""
    make, variable, exact, until, *_ = PROBLEMS[name]
    model = make()
    t = np.linspace(0.0, until, 41)[1:]
    found = []
    for many in steps:
        # where events fall within steps makes errors rise and fall: lengths that differ a little
        own = []
        for part in (1.0, 1.013, 1.029, 1.041, 1.057):
            run = stepped(model, until, until / (many * part), theta)
            own.append(np.abs(run[variable].at(t) - exact(t)).mean())
        found.append(float(np.mean(own)))
    return found


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
        bottom, top = panel.get_ylim()
        panel.set_ylim(bottom * (bottom / top) ** 0.3, top)  # room below for the legend
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
