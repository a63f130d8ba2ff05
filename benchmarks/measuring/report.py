"""The costs as plain text, as a Markdown table, and as bars."""

from __future__ import annotations

import math
from pathlib import Path

from measuring.slopes import Cost

HEADS = ("problem", "tool", "each", "ratio", "fixed", "error")


def time_text(seconds: float) -> str:
    """Return a time with three digits and a unit."""
    if not math.isfinite(seconds):
        return ""
    for factor, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if abs(seconds) >= factor:
            return f"{seconds / factor:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def ratio_text(ratio: float) -> str:
    """Return a ratio with as many digits as mean something."""
    if not math.isfinite(ratio):
        return ""
    return f"{ratio:.2f}" if ratio < 10.0 else f"{ratio:,.0f}"


def cells(cost: Cost) -> tuple[str, ...]:
    """Return one row."""
    problem = cost.problem
    error = f"{cost.error:.0e}" if math.isfinite(cost.error) else ""
    return (
        f"{problem.key} {problem.title}, per {problem.unit}",
        cost.tool,
        time_text(cost.each),
        ratio_text(cost.ratio),
        time_text(cost.start) if cost.start > 0.0 else "",
        error,
    )


def plain(costs: list[Cost], header: bool) -> str:
    """Return the rows of a problem, its name only once."""
    lines = []
    widths = (58, 14, 11, 11, 10, 8)
    rows = [cells(c) for c in costs]
    if header:
        rows.insert(0, HEADS)
    seen = ""
    for row in rows:
        shown = ("" if row[0] == seen else row[0], *row[1:])
        seen = row[0]
        texts = [t.ljust(w) if k < 2 else t.rjust(w) for k, (t, w) in enumerate(zip(shown, widths))]
        lines.append("".join(texts).rstrip())
    if costs and costs[0].problem.note:
        lines.append(f"  {costs[0].problem.note}")
    return "\n".join(lines)


def growth(groups: list[list[Cost]]) -> list[str]:
    """Return how the costs of each tool grow over problems of one key and several sizes."""
    lines = []
    sized = [c for costs in groups for c in costs if c.problem.size]
    for key, tool in dict.fromkeys((c.problem.key, c.tool) for c in sized):
        found = [c for c in sized if (c.problem.key, c.tool) == (key, tool)]
        for what, costs in (
            (found[0].problem.unit, [c.each for c in found]),
            ("event", [c.event for c in found]),
        ):
            if len(found) < 2 or not all(a > 0.0 for a in costs):
                continue
            ends = math.log(found[-1].problem.size / found[0].problem.size)
            exponent = math.log(costs[-1] / costs[0]) / ends
            sizes = ", ".join(f"{c.problem.size:g}" for c in found)
            texts = ", ".join(time_text(a) for a in costs)
            lines.append(
                f"{key} {tool}: {texts} for one {what} at sizes {sizes}; grows with exponent "
                f"{exponent:.2f}"
            )
    return lines


def markdown(groups: list[list[Cost]]) -> str:
    """Return a Markdown table of all problems."""
    lines = ["| " + " | ".join(HEADS) + " |", "| --- | --- | ---: | ---: | ---: | ---: |"]
    lines += ["| " + " | ".join(cells(c)) + " |" for costs in groups for c in costs]
    notes = [f"{g[0].problem.key}: {g[0].problem.note}" for g in groups if g and g[0].problem.note]
    return "\n".join([*lines, "", *(f"- {n}" for n in [*notes, *growth(groups)]), ""])


def renewed(page: str, groups: list[list[Cost]]) -> str:
    """Return a page whose table, with what stands below it up to the picture, is a new one."""
    begin = page.index("| problem |")
    end = page.index("![", begin)
    return f"{page[:begin]}{markdown(groups)}\n{page[end:]}"


def bars(groups: list[list[Cost]], path: Path) -> None:
    """Draw the ratios to C, one group of bars a problem, on a logarithmic scale."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = [[c for c in g if c.tool != c.problem.base and c.ratio > 0.0] for g in groups]
    shown = [g for g in shown if g]
    tools = list(dict.fromkeys(c.tool for g in shown for c in g))
    colours = {tool: f"C{k}" for k, tool in enumerate(tools)}
    rows = sum(len(g) + 1 for g in shown)
    figure, axes = plt.subplots(figsize=(8.0, 0.24 * rows + 1.2), layout="constrained")
    place, ticks, names = 0.0, [], []
    for g in shown:
        for k, c in enumerate(g):
            axes.barh(place - k, c.ratio - 1.0, left=1.0, color=colours[c.tool], height=0.85)
            axes.annotate(
                f" {c.tool} {ratio_text(c.ratio)}",
                (max(c.ratio, 1.0), place - k),
                va="center",
                fontsize=8,
            )
        ticks.append(place - 0.5 * (len(g) - 1))
        names.append(f"{g[0].problem.key} {g[0].problem.title}")
        place -= len(g) + 1
    axes.set_xscale("log")
    axes.set_ylim(place + 0.5, 1.0)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 1.0), high * 10.0)  # room for the text beside the longest bar
    axes.set_yticks(ticks, names, fontsize=8)
    axes.set_xlabel(
        "marginal time, as a multiple of that of hand-written C\n"
        "(P8: of empty Python, P13: of ngspice)"
    )
    axes.axvline(1.0, color="black", linewidth=0.8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.savefig(path)
    plt.close(figure)
