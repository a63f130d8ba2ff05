"""``hybond run``: what it prints, writes and returns."""

import csv
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond.cli.record as record_module
from tests.example_runs import EXAMPLES

OMEGA = 2.0  # of the spring file: sqrt(8 N/m / 2 kg)


def test_a_run_prints_title_events_final_values_and_statistics(shell: Any) -> None:
    done = shell("run", "ball.toml")
    assert done.code == 0 and done.err == ""
    assert done.out.startswith("A ball that loses speed at each bounce\n")
    assert "impact  away -> hits" in done.out
    assert "1.25 m" in done.out
    *_, work, method, kernel = done.out.splitlines()
    assert work.startswith("auto, ") and kernel.startswith("made by the ")
    assert method == "1 mode propagated exactly"


def test_samples_follow_the_exact_solution_of_the_spring(shell: Any) -> None:
    done = shell("run", "spring.toml", "--json", "--at", "0.5, 250 ms", "--signals", "mass.f")
    samples = done.json["samples"]
    assert samples["t"] == [0.5, 0.25]
    assert samples["mass.f"] == pytest.approx([3 * math.cos(OMEGA * t) for t in (0.5, 0.25)])


def test_a_sample_at_an_event_is_the_limit_from_the_right(shell: Any) -> None:
    run = shell("run", "ball.toml", "--json").json
    t = next(e["t"] for e in run["events"] if e["cause"] == "guard")
    assert t == pytest.approx(1.0)  # 5 m at 10 m/s^2
    run = shell("run", "ball.toml", "--json", "--at", repr(t), "--signals", "v.f").json
    assert run["samples"]["v.f"] == pytest.approx([5.0])  # half of 10 m/s, upwards


def test_the_json_record_tells_the_bounce(shell: Any) -> None:
    run = shell("run", "ball.toml", "--json").json
    assert (run["hybond"], run["model"], run["status"]) == (1, "ball", "ok")
    assert run["mode"] == {"impact": "away"}
    event = run["events"][1]
    step = event["steps"][0]
    assert (event["cause"], step["kind"], step["mode"]) == ("guard", "pinnacle", {"impact": "hits"})
    fired = step["fired"][0]
    assert (fired["machine"], fired["from"], fired["to"]) == ("impact", "away", "hits")
    assert fired["values"]["v.f"] == pytest.approx(-10.0)
    assert step["impulses"]["contact.e"] == pytest.approx(15.0)
    energy = step["energy"]
    assert energy["before"] == pytest.approx(50.0) and energy["after"] == pytest.approx(12.5)
    assert energy["before"] + energy["source"] - energy["lost"] == pytest.approx(energy["after"])
    assert run["final"]["height"] == pytest.approx(1.25)
    assert run["units"]["ball.f"] == "m/s"


def test_a_run_may_keep_its_end_and_write_all_events_to_a_journal(shell: Any) -> None:
    boost = (str(EXAMPLES / "boost.toml"), "--until", "1 ms")
    whole = shell("run", *boost, "--json").json
    done = shell("run", *boost, "--keep", "5", "--journal", "events.csv")
    with open("events.csv", encoding="utf-8") as file:
        written = [float(row["t"]) for row in csv.DictReader(file)]
    assert written == [e["t"] for e in whole["events"]]
    kept = shell("run", *boost, "--json", "--keep", "5").json
    assert 5 <= len(kept["events"]) < len(written) / 2
    # how many more than five are kept follows the slices of the run, which follow the clock
    told = re.search(rf"{len(written)} events, the last (\d+) kept", done.out)
    assert told is not None and 5 <= int(told[1]) < len(written) / 2
    assert kept["events"] == whole["events"][-len(kept["events"]) :]
    assert kept["final"] == whole["final"]


def test_limits_of_a_run(shell: Any) -> None:
    done = shell("run", "ball.toml", "--max-events", "1")
    assert (done.code, "HB-N404" in done.err) == (3, True)
    assert shell("run", "ball.toml", "--max-steps", "0").err.startswith("HB-S120 at max_steps")
    assert shell("run", "ball.toml", "--journal", "ball.toml").err.startswith("HB-X102")


def test_json_fits_its_schema(shell: Any) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    path = Path(record_module.__file__).with_name("result.schema.json")
    validator = jsonschema.Draft202012Validator(json.loads(path.read_text(encoding="utf-8")))
    for words in (
        ["ball.toml", "--at", "0.5", "--signals", "height"],
        ["ball.toml", "--until", "10"],
        ["no_mode.toml", "--at", "0.1,4"],
        ["nothing.toml"],
        ["spring.toml", "--until", "1 kg"],
    ):
        validator.validate(shell("run", *words, "--json").json)
    shell("run", "ball.toml", "--out", "run.json")
    validator.validate(json.loads((shell.folder / "run.json").read_text(encoding="utf-8")))


def test_set_changes_a_parameter(shell: Any) -> None:
    run = shell("run", "spring.toml", "--json", "--set", "k=800 N/m", "--set", "m=2kg").json
    assert run["final"]["mass.f"] == pytest.approx(3 * math.cos(20.0 * 2.0), rel=1e-5)


def test_set_changes_elements_starts_and_machines(shell: Any) -> None:
    words = ["--set", "mass.I=8 kg", "--set", "mass.f=1 m/s"]
    run = shell("run", "spring.toml", "--json", *words).json
    assert run["final"]["mass.f"] == pytest.approx(math.cos(1.0 * 2.0))
    words = ["--set", "height.start=20 m", "--set", "ball.p=0"]
    run = shell("run", "ball.toml", "--json", *words).json
    assert run["final"]["height"] == pytest.approx(20 - 5 * 1.5**2)
    run = shell("run", "charger.toml", "--json", "--set", "charger.start=resting").json
    assert run["events"][0]["steps"][0]["mode"] == {"charger": "resting"}


def test_set_reaches_into_one_of_two_instances_of_a_submodel(shell: Any) -> None:
    part = '[models.tank]\n[models.tank.parameters]\nsize = "1"\n[models.tank.elements]\n'
    part += 'c = { C = "size", e = 1 }\nr = { R = 1 }\nj = { junction = 0 }\n'
    part += '[models.tank.graph]\nbonds = ["j -> c", "j -> r"]\n'
    top = '[elements]\na = { submodel = "tank" }\nb = { submodel = "tank" }\n'
    shell.file("two.toml", f"hybond = 1\n{top}{part}[experiment]\nuntil = 1\n")
    run = shell("run", "two.toml", "--json", "--set", "a.size=2", "--set", "b.r.R=4").json
    assert run["status"] == "ok", run
    assert run["final"]["a.c.e"] == pytest.approx(math.exp(-1 / 2))
    assert run["final"]["b.c.e"] == pytest.approx(math.exp(-1 / 4))


@pytest.mark.parametrize(
    "path, meant",
    [("mm", "'m'"), ("mas.I", "'mass.I'"), ("mass.q", "'mass.p'"), ("spring.f", "'spring.e'")],
)
def test_set_of_an_unknown_path_names_the_nearest(shell: Any, path: str, meant: str) -> None:
    done = shell("run", "spring.toml", "--set", f"{path}=1")
    assert done.code == 2
    assert done.err.startswith("HB-M107") and meant in done.err


def test_tables_hold_both_limits_of_an_event(shell: Any) -> None:
    assert shell("run", "ball.toml", "--out", "r.csv", "--signals", "v.f, height").code == 0
    with open(shell.folder / "r.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["t", "side", "v.f", "height"]
    limits = {r["side"]: float(r["v.f"]) for r in rows if r["side"]}
    assert limits == {"left": pytest.approx(-10.0), "right": pytest.approx(5.0)}

    assert shell("run", "ball.toml", "--out", "r.npz").code == 0
    with np.load(shell.folder / "r.npz") as arrays:
        assert arrays["height"][-1] == pytest.approx(1.25)

    assert shell("run", "ball.toml", "--out", "r.json").code == 0
    table = json.loads((shell.folder / "r.json").read_text(encoding="utf-8"))["table"]
    assert table["t"][-1] == 1.5 and len(table["height"]) == len(table["t"])


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "suffix, magic", [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_plots_are_pictures(shell: Any, suffix: str, magic: bytes) -> None:
    assert shell("run", "ball.toml", "--plot", f"r.{suffix}").code == 0
    assert (shell.folder / f"r.{suffix}").read_bytes().startswith(magic)


def test_a_run_that_fails_keeps_what_came_before(shell: Any) -> None:
    done = shell(
        "run", "no_mode.toml", "--json", "--at", "0.1,4", "--signals", "c.e", "--out", "r.csv"
    )
    assert done.code == 3
    assert done.err.startswith("HB-N401")
    run = done.json
    assert run["status"] == "error" and run["error"]["code"] == "HB-N401"
    assert run["t_end"] == pytest.approx(math.log(2))
    assert run["samples"]["c.e"] == [pytest.approx(1 - math.exp(-0.1)), None]
    assert any("sample times" in w for w in run["warnings"])
    assert (shell.folder / "r.csv").read_text(encoding="utf-8").count("\n") > 3


def test_an_accumulation_point_is_passed(shell: Any) -> None:
    done = shell("run", "ball.toml", "--until", "10 s", "--json")
    assert done.code == 0
    assert done.json["status"] == "ok" and done.json["t_end"] == 10.0
    (record,) = done.json["accumulations"]
    assert record["t"] == pytest.approx(3.0)  # 1 + 1 + 1/2 + 1/4 + ...
    assert record["landed"] is True and record["state"] in done.json["mode"].values()
    last = done.json["events"][-1]
    assert last["cause"] == "accumulation" and last["landed"] == [record["machine"]]


def test_the_same_command_gives_the_same_bytes(shell: Any) -> None:
    words = ("run", "ball.toml", "--json", "--at", "0.1,0.7")
    assert shell(*words).out == shell(*words).out


def test_what_is_not_finite_is_null() -> None:
    text = record_module.to_json({"a": [float("nan"), 1.0], "b": {"c": -math.inf}})
    assert json.loads(text) == {"a": [None, 1.0], "b": {"c": None}}


def test_a_file_that_cannot_be_written_leaves_the_rest(shell: Any) -> None:
    def broken(*args: Any, **options: Any) -> None:
        raise OSError(28, "No space left on device", "r.csv")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hybond.result.Result.to_csv", broken)
        done = shell("run", "ball.toml", "--json", "--out", "r.csv", "--plot", "r.png")
    assert done.code == 1
    assert done.json["status"] == "ok"
    assert "No space left on device" in done.err
    assert (shell.folder / "r.png").exists()
