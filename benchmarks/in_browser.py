"""What the studio costs in a browser: opening, dragging, strokes after an edit.

    python benchmarks/in_browser.py [--sizes 500 1500]

A ladder of coils, resistors and capacitors with a switch in every twentieth section is opened in a
headless Chromium with software rendering. Measured by the page's own clock: the first paint, the
time until all nodes stand, the frames while a node is dragged, and the time from a click that
changes the model (a bond turned, the mode that is drawn) until its strokes are painted.
Needs chromium, chromedriver and selenium.
"""

from __future__ import annotations

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from studio.chromium import browser, missing

FRAMES = """
window.frames_ = []; let last = performance.now();
const tick = (now) => { window.frames_.push(now - last); last = now;
  if (!window.stop_) requestAnimationFrame(tick); };
window.stop_ = false; requestAnimationFrame(tick);
"""
PAINTED = """
const done = arguments[0];
const see = () => SEE;
const before = see();
const begin = performance.now();
ACT;
const look = () => (see() !== before
  ? requestAnimationFrame(() => setTimeout(() => done(performance.now() - begin)))
  : requestAnimationFrame(look));
look();
"""


def ladder(size: int) -> str:
    """Return the model file of a ladder with `size` elements."""
    elements, bonds, machines, last = ['V = { Se = "10 V" }'], [], [], "V"
    for k in range((size - 1) // 5):
        elements += [
            f"s{k} = {{ junction = 1 }}",
            f'L{k} = {{ I = "1 mH" }}',
            f'R{k} = {{ R = "10 ohm" }}',
            f"p{k} = {{ junction = 0 }}",
            f'C{k} = {{ C = "1 uF" }}',
        ]
        bonds += [f"{last} -> s{k} -> p{k} -> C{k}", f"s{k} -> L{k}", f"s{k} -> R{k}"]
        last = f"p{k}"
        if k % 20 == 10:
            machines.append(
                f'[machines.S{k}]\nstart = "on"\nstates = {{ on = ["s{k}"], off = [] }}\n'
                f'rules = ["on -> off when time >= {k} us"]\n'
            )
    listed = ",\n".join(f'  "{b}"' for b in bonds)
    return (
        'hybond = 1\ntitle = "ladder"\ndomain = "electrical"\n\n[elements]\n'
        + "\n".join(elements)
        + f"\n\n[graph]\nbonds = [\n{listed},\n]\n\n"
        + "\n".join(machines)
        + '\n[experiment]\nuntil = "1 ms"\n'
    )


def opened(driver: Any, address: str, size: int) -> tuple[float, float]:
    """Open the page; return its first paint and the time until `size` nodes stand, ms."""
    driver.get(address)
    driver.set_script_timeout(60)
    all_there = driver.execute_async_script(
        "const [n, done] = arguments; const look = () =>"
        "document.querySelectorAll('[data-node]').length >= n"
        "? requestAnimationFrame(() => setTimeout(() => done(performance.now())))"
        ": requestAnimationFrame(look); look();",
        size,
    )
    first = driver.execute_script(
        "return performance.getEntriesByName('first-contentful-paint')[0].startTime"
    )
    return first, all_there


def dragged(driver: Any, name: str, moves: int = 90) -> list[float]:
    """Drag a node about; return how long each frame took, ms."""
    x, y = driver.execute_script(
        "const r = document.querySelector(arguments[0]).getBoundingClientRect();"
        "return [r.x + r.width / 2, r.y + r.height / 2]",
        f'[data-node="{name}"] .letters',
    )

    def mouse(kind: str, dx: float, dy: float) -> None:
        driver.execute_cdp_cmd(
            "Input.dispatchMouseEvent",
            {"type": kind, "x": x + dx, "y": y + dy, "button": "left", "buttons": 1}
            | ({"clickCount": 1} if kind != "mouseMoved" else {}),
        )

    mouse("mousePressed", 0, 0)
    mouse("mouseMoved", 8, 8)
    driver.execute_script(FRAMES)
    for k in range(moves):
        mouse("mouseMoved", 10 + k % 30, 10 + (k * 7) % 20)
    frames = driver.execute_script("window.stop_ = true; return window.frames_.slice(2)")
    mouse("mouseReleased", 10, 10)
    return list(frames)


def painted(driver: Any, act: str, see: str, repeats: int = 7) -> list[float]:
    """Return how long each repetition took from the action until its picture, ms."""
    script = PAINTED.replace("SEE", see).replace("ACT", act)
    found = []
    for _ in range(repeats):
        time.sleep(0.5)  # a hand is not faster; the text of the file is written meanwhile
        found.append(driver.execute_async_script(script))
    return found


def measure(size: int) -> dict[str, float]:
    """Return what a ladder of about `size` elements costs, ms."""
    with tempfile.TemporaryDirectory() as folder:
        text = ladder(size)
        Path(folder, "m.toml").write_text(text)
        nodes = text.count(" = { ") - text.count("states = { ")
        process = subprocess.Popen(
            [sys.executable, "-m", "hybond", "studio", "m.toml", "--no-browser"],
            cwd=folder,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "HYBOND_STATE": folder},
        )
        driver = browser()
        try:
            assert process.stdout is not None
            said = re.search(r"http://\S+", process.stdout.readline())
            assert said is not None
            paints, opens = zip(*(opened(driver, said[0], nodes) for _ in range(3)))
            frames = dragged(driver, "L3")
            select = "document.querySelector('select[aria-label^=\"State of S10 \"]')"
            modes = painted(
                driver,
                f"const s = {select}; s.value = s.value === 'on' ? 'off' : 'on';"
                "s.dispatchEvent(new Event('change', {bubbles: true}))",
                "document.querySelectorAll('.node.off').length",
            )
            driver.execute_script(
                "const b = document.querySelector('[data-text=\"s1 -> L1\"] .reach');"
                "b.dispatchEvent(new PointerEvent('pointerdown',"
                "{bubbles: true, button: 0, pointerId: 77}))"
            )
            turns = painted(
                driver,
                "document.querySelector('.canvas svg').dispatchEvent("
                "new KeyboardEvent('keydown', {key: 'r', bubbles: true}))",
                "document.querySelector('[data-bond].selected').getAttribute('data-text')",
            )
        finally:
            driver.quit()
            process.kill()
            process.wait()
    return {
        "nodes": nodes,
        "first paint": statistics.median(paints),
        "opened": statistics.median(opens),
        "frame, median": statistics.median(frames),
        "frame, 95 %": sorted(frames)[int(0.95 * len(frames))],
        "mode": statistics.median(modes),
        "edit": statistics.median(turns),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[500, 1500])
    given = parser.parse_args()
    if missing():
        print(f"skipped: {missing()}")
        return
    rows = [measure(size) for size in given.sizes]
    print("ms" + " " * 16 + "".join(f"{row['nodes']:>12.0f}" for row in rows))
    for name in list(rows[0])[1:]:
        print(f"{name:18}" + "".join(f"{row[name]:12.1f}" for row in rows))


if __name__ == "__main__":
    main()
