"""A script that rebuilds a model: the same graph, the same events, the same bits."""

import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import hybond as hb
from hybond.errors import ModelError
from hybond.export.python import literal, to_python

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))


def rebuilt(model: hb.Model, path: Path) -> hb.Model:
    path.write_text(to_python(model))
    return runpy.run_path(str(path))["model"]()


@pytest.mark.sampled(3)
@pytest.mark.parametrize("file", EXAMPLES, ids=lambda p: p.stem)
def test_every_example_is_rebuilt_to_the_same_graph(file: Path, tmp_path: Path) -> None:
    model = hb.load(file)
    again = rebuilt(model, tmp_path / "script.py")
    assert again.flatten() == model.flatten()
    assert hb.dumps(again, inline=True) == hb.dumps(model, inline=True)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["falling_rod", "mmc_arm", "end_stops"])
def test_the_run_of_the_script_has_the_same_bits(name: str, tmp_path: Path) -> None:
    model = hb.load(next(f for f in EXAMPLES if f.stem == name))
    run = hb.simulate(model)
    again = hb.simulate(rebuilt(model, tmp_path / "script.py"))
    assert [e.t.hex() for e in again.events] == [e.t.hex() for e in run.events]
    assert str(again.events) == str(run.events)
    assert {k: v.hex() for k, v in again.final.items()} == {
        k: v.hex() for k, v in run.final.items()
    }


@pytest.mark.slow
def test_a_script_prints_its_events(tmp_path: Path) -> None:
    model = hb.load(next(f for f in EXAMPLES if f.stem == "diode_inductor"))
    script = tmp_path / "script.py"
    script.write_text(to_python(model))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(hb.simulate(model).events).strip()


def test_scripts_are_laid_out_as_a_formatter_would(tmp_path: Path) -> None:
    ruff = Path(sys.executable).with_name("ruff")
    found = str(ruff) if ruff.exists() else shutil.which("ruff")
    if found is None:
        pytest.skip("ruff is not installed")
    for file in EXAMPLES:
        (tmp_path / f"{file.stem}.py").write_text(to_python(hb.load(file)))
    check = [found, "format", "--check", "--isolated", "--line-length", "100", str(tmp_path)]
    done = subprocess.run(check, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def odd() -> hb.Model:
    """Names and texts that Python could take for something else."""
    inner = hb.Model("inner part", parameters={"r": 1.0})
    inner.add(node=hb.Zero(), leak=hb.R("r"), drive=hb.Sf("lambda_"))
    inner.bond("node -> leak", "drive -> node")
    inner.input(lambda_=hb.Input(table=[[0, 0], [1, 2.5]], linear=True))
    inner.port(p="node")
    m = hb.Model("odd", title='Three """quotes""" and a \\', parameters={"class": "1e-3"})
    m.about = 'One line\nand *another* with a quote"'
    m.indeterminate = "least leakage"
    m.elements["self"] = hb.Zero()
    m.add(
        **{
            "in": hb.Submodel(inner, r="class"),
            "is": hb.Submodel(inner, inputs={"lambda_": "2*time"}),
        }
    )
    m.add(
        store=hb.C("1 F", q=0.1), far=hb.I({"f": {"table": [[-1, 0, 1], [-2, 0, 1]]}}), j=hb.One()
    )
    m.bond("self -> in.p", "self -> is.p", "self -> store", "self -> j", "slow: j -> far")
    m.signal(both='if S.state == "on" then store.q else far.p')
    m.machine(
        "S", states={"on": ["j"], "off": []}, start="on", rules=["on -> off when store.q > 1"]
    )
    m.pin("slow", at="far")
    m.reference(S="on")
    m.experiment = {"until": 0.25, "plot": ["both"]}
    m.layout["store"] = (1.5, -2.0)
    return m


def test_words_of_python_and_quotes_do_no_harm(tmp_path: Path) -> None:
    model = odd()
    again = rebuilt(model, tmp_path / "script.py")
    assert again.flatten() == model.flatten()
    assert (again.title, again.about, again.layout) == (model.title, model.about, model.layout)
    assert again.pins == model.pins and again.reference_states == model.reference_states


def test_a_text_is_data_whatever_it_says(tmp_path: Path) -> None:
    nasty = '");import os;os.abort()#\n\t\'"\\'
    assert runpy.run_path(str(_file(tmp_path, f"x = {literal(nasty)}")))["x"] == nasty
    model = hb.Model(nasty, title=nasty)
    model.about = nasty + '"""'
    model.add(a=hb.Se(1), r=hb.R(1))
    model.bond("a -> r")
    again = rebuilt(model, tmp_path / "script.py")
    assert (again.name, again.title, again.about) == (nasty, nasty, nasty + '"""')


def _file(folder: Path, text: str) -> Path:
    path = folder / "text.py"
    path.write_text(text)
    return path


def test_a_python_function_is_refused() -> None:
    model = hb.Model("driven")
    model.input(u=lambda t: t**2)
    with pytest.raises(ModelError, match="script") as refused:
        to_python(model)
    assert refused.value.code == "HB-E670"
