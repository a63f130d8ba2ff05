"""The studio in a notebook: the page as a widget, the model edited in place."""

from __future__ import annotations

import functools
import json
import threading
import time
from collections.abc import Callable
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from studio.chromium import browser, missing

import hybond as hb
from hybond.studio.server import PAGE, dumped

pytest.importorskip("anywidget")

HOST = """<!doctype html><meta charset="utf-8"><link rel="stylesheet" href="studio.css">
<div id="cell"></div><script type="module">
import widget from "./widget.js";
const heard = new Set(); window.out = [];
window.deliver = (text) => heard.forEach((f) => f(JSON.parse(text)));
const model = { get: () => 600, send: (m) => window.out.push(m),
  on: (name, f) => heard.add(f), off: (name, f) => heard.delete(f) };
window.stop = widget.render({ model, el: document.getElementById("cell") });
</script>"""


def rc() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c", "node -> r1")
    m.experiment["until"] = "2 s"
    return m


def test_edits_on_the_page_change_the_model_in_place_and_its_runs_are_results(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = rc()
    page = hb.studio(model)
    sent: list[dict[str, Any]] = []
    monkeypatch.setattr(page.widget, "send", lambda m, *_: sent.append(m))
    monkeypatch.setattr(page.session, "_listeners", [sent.append])
    edit = {"do": "set", "path": ["parameters", "r"], "value": "2 kohm"}
    page.widget._handle_custom_msg({"id": 1, "ask": "edit", "edit": edit}, [])
    assert [m["id"] for m in sent if "id" in m] == [1] and model.parameters["r"] == "2 kohm"
    # what says no model leaves it as it was
    page.widget._handle_custom_msg({"id": 2, "ask": "replace", "text": "hybond = "}, [])
    assert model.parameters["r"] == "2 kohm"
    page.widget._handle_custom_msg({"id": 3, "ask": "undo"}, [])
    page.widget._handle_custom_msg({"id": 4, "ask": "run", "until": "2 s"}, [])
    end = time.monotonic() + 20
    while page.run is None and time.monotonic() < end:
        time.sleep(0.01)
    assert page.run is not None
    assert page.run["c.e"].at(2.0) == pytest.approx(10 * 2.718281828459045**-1, rel=1e-7)
    # a sweep of a plan is a table: 10 V for 2 s over r C
    factors = [{"path": "r", "values": "1 kohm, 4 kohm"}]
    plan = {"factors": factors, "way": "grid", "collect": "final(c.e)"}
    assert page.table is None
    page.widget._handle_custom_msg({"id": 5, "ask": "plan begin", **plan}, [])
    while len(page.table or ()) < 2 and time.monotonic() < end:
        time.sleep(0.01)
    expected = [10 * 2.718281828459045**x for x in (-2.0, -0.5)]
    assert page.table is not None
    assert page.table["final(c.e)"].tolist() == pytest.approx(expected, rel=1e-6)
    page.widget._handle_custom_msg(["what"], [])  # no message: nobody answers, nothing breaks
    assert "text/plain" in page._repr_mimebundle_()[0]


@pytest.mark.skipif(bool(missing()), reason=missing() or "there is a browser")
@pytest.mark.slow
def test_the_page_in_a_cell_draws_edits_and_runs(tmp_path: Path) -> None:
    model = rc()
    studio = hb.studio(model)
    for name in ("widget.js", "studio.css"):
        (tmp_path / name).write_bytes((PAGE / name).read_bytes())
    (tmp_path / "index.html").write_text(HOST)
    quiet = type("Quiet", (SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    handler = functools.partial(quiet, directory=str(tmp_path))
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    driver = browser(1200, 700)
    told: list[dict[str, Any]] = []
    studio.session.listen(told.append)

    def pump() -> None:
        """Carry messages, as a notebook does."""
        for message in driver.execute_script("return window.out.splice(0)"):
            told.append(studio.session.handle(message))
            studio.session.settle()
        while told:
            driver.execute_script("window.deliver(arguments[0])", dumped(told.pop(0)))

    def until(what: Callable[[], Any], why: str) -> Any:
        end = time.monotonic() + 20
        while time.monotonic() < end:
            pump()
            found = what()
            if found:
                return found
            time.sleep(0.02)
        raise AssertionError(f"not so after 20 s: {why}")

    def all_of(selector: str) -> list[Any]:
        return list(driver.find_elements("css selector", selector))

    try:
        driver.get(f"http://127.0.0.1:{server.server_port}/")
        until(lambda: len(all_of("[data-node]")) == 3, "the graph is drawn")
        assert all_of("#cell.hybond-widget")
        until(lambda: all_of('[data-kind="Se"]'), "the palette")[0].click()
        until(lambda: "Se" in model.elements, "the model has the source")
        driver.find_element("css selector", 'button[aria-label="Undo"]').click()
        until(lambda: "Se" not in model.elements, "undone")
        driver.find_element("css selector", "button.run").click()
        until(lambda: studio.run is not None and all_of(".trace canvas"), "its plots are there")
        driver.execute_script("window.stop()")
        assert not all_of("[data-node]")
        severe = [e for e in driver.get_log("browser") if e["level"] == "SEVERE"]
        assert not [e for e in severe if "favicon" not in e["message"]], json.dumps(severe)
    finally:
        driver.quit()
        server.shutdown()
