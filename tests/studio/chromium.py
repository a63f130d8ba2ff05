"""A headless Chromium, where the machine has one, driven by selenium."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

BROWSER = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)
DRIVER = shutil.which("chromedriver")


def missing() -> str:
    """Return what is missing to run a browser, empty if nothing is."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "selenium is not installed"
    if BROWSER is None:
        return "there is no chromium"
    return "" if DRIVER else "there is no chromedriver"


def browser(
    width: int = 1400, height: int = 900, *, touch: bool = False, dark: bool = False
) -> Any:
    """Return a browser with a window of this size; with `touch` that of a telephone."""
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = str(BROWSER)
    for word in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--force-device-scale-factor=1",
        f"--window-size={width},{height}",
        *(["--force-dark-mode", "--enable-features=WebUIDarkMode"] if dark else []),
    ):
        options.add_argument(word)
    if touch:
        metrics = {"width": width, "height": height, "pixelRatio": 2.0, "touch": True}
        options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(str(DRIVER)), options=options)


def with_axe(desk: Any) -> Callable[[], list[Any]]:
    """Put axe into the page that is open; return what tells its serious findings."""
    axe = pytest.importorskip("axe_core_python")
    script = next(Path(axe.__file__).parent.glob("axe*.js")).read_text(encoding="utf-8")
    desk.execute_script(script)
    return lambda: desk.execute_async_script(
        "const done = arguments[0];"
        "axe.run(document, {resultTypes: ['violations']}).then(r => done(r.violations"
        ".filter(v => ['serious', 'critical'].includes(v.impact))"
        ".map(v => [v.id, v.nodes.map(n => n.html.slice(0, 120))])))"
    )
