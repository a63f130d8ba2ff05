"""Words of other tools on models, runs and signals say what is meant; a bond has two ends."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import hybond as hb


def discharge() -> hb.Model:
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    return m


@pytest.mark.parametrize(
    ("owner", "name", "meant"),
    [
        ("model", "simulate", "hb.simulate(model"),
        ("model", "save", "hb.save(model"),
        ("model", "signl", "did you mean 'signal'"),
        ("run", "t", "run.t_end"),
        ("run", "y", "run.names"),
        ("run", "evnts", "did you mean 'events'"),
        ("signal", "value", "signal.y"),
        ("signal", "integal", "did you mean 'integral'"),
        ("signal", "final", "signal.y[-1]"),  # it was told 'integral'
        ("signal", "average", "signal.mean()"),
        ("signal", "peak", "signal.max()"),
        ("run", "to_dataframe", "run.to_pandas()"),
        ("run", "df", "run.to_pandas()"),
    ],
)
def test_what_is_not_there_is_named_with_what_is_meant(owner: str, name: str, meant: str) -> None:
    model = discharge()
    run = hb.simulate(model, until=1)
    asked = {"model": model, "run": run, "signal": run["c.e"]}[owner]
    with pytest.raises(AttributeError, match=f"has no '{name}'; try: ") as caught:
        getattr(asked, name)
    assert meant in str(caught.value)
    # who looks for what may be there finds nothing and goes on
    assert getattr(asked, name, None) is None and not hasattr(asked, "_repr_nothing_")


def test_models_are_copied_as_before() -> None:
    model = discharge()
    assert hb.dumps(copy.deepcopy(model)) == hb.dumps(model)
    assert hb.dumps(pickle.loads(pickle.dumps(model))) == hb.dumps(model)


@pytest.mark.parametrize(
    ("ends", "meant"),
    [
        (("node", "c"), 'm.bond("node -> c")'),
        (("node", "c", "r"), 'm.bond("node -> c -> r")'),
        (("node",), 'm.bond("node -> b")'),
        (("cell[1].plus", "node"), 'm.bond("cell[1].plus -> node")'),
    ],
)
def test_ends_without_an_arrow_are_refused_where_they_are_given(
    ends: tuple[str, ...], meant: str
) -> None:
    model = discharge()
    with pytest.raises(hb.ModelError, match="HB-M109") as caught:
        model.bond(*ends)
    assert meant in str(caught.value)
    assert model.bonds == ["node -> c", "node -> r"]


def test_a_picture_is_saved_and_not_drawn_to_a_name() -> None:
    with pytest.raises(hb.UsageError, match="HB-S130 at draw") as caught:
        discharge().draw("rc.png")  # type: ignore[call-arg]
    assert "save(" in str(caught.value)


def test_a_rule_that_leads_back_to_its_state_is_refused() -> None:
    model = discharge()
    model.machine("m", states={"a": []}, start="a", rules=["a -> a when time > 1"])
    with pytest.raises(hb.ModelError, match="HB-M145") as caught:
        model.flatten()
    assert "leave it out" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "meant"), [("zero", "'Zero'"), ("Sweep", "'sweep'"), ("simulat", "'simulate'")]
)
def test_a_name_that_the_package_has_not_is_told_with_what_is_meant(name: str, meant: str) -> None:
    with pytest.raises(AttributeError, match="did you mean") as caught:
        getattr(hb, name)
    assert meant in str(caught.value)


@pytest.mark.parametrize("name", ["__test__", "_repr_nothing_"])
def test_what_looks_into_every_module_is_told_at_once(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of collecting the tests, a sixth went into searching for what `__test__` may have meant."""
    monkeypatch.setattr("hybond.names.did_you_mean", None)
    with pytest.raises(AttributeError, match=f"^module 'hybond' has no attribute '{name}'$"):
        getattr(hb, name)


@pytest.mark.parametrize(
    ("word", "meant"),
    [("t_end", "until"), ("dt", "step"), ("tol", "rtol"), ("integrator", "solver")],
)
def test_arguments_of_runs_in_words_of_elsewhere(word: str, meant: str) -> None:
    with pytest.raises(hb.UsageError, match="HB-S130") as caught:
        hb.simulate(discharge(), **{word: 1})
    assert f"it is named {meant!r} here" in caught.value.hint


def test_a_mode_of_a_model_without_machines_has_a_remedy() -> None:
    with pytest.raises(hb.ModelError, match="HB-M144") as caught:
        discharge().draw(mode={"S": "on"})
    assert "no machines" in caught.value.hint


def test_a_suffix_with_a_slip_is_told_with_the_file_that_is_there(tmp_path: Path) -> None:
    hb.save(discharge(), tmp_path / "rc.toml")
    with pytest.raises(hb.FileError, match="HB-F102") as caught:
        hb.load(tmp_path / "rc.tml")
    assert caught.value.hint == f"did you mean {tmp_path / 'rc.toml'}?"


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        *(("L", "I"), ("Resistor", "R"), ("Capacitor", "C"), ("MSe", "Se"), ("Transformer", "TF")),
        *(("Junction0", "Zero"), ("OneJunction", "One"), ("J1", "One"), ("linearize", "linearise")),
    ],
)
def test_elements_by_the_names_of_other_programs_are_told_theirs(name: str, meant: str) -> None:
    with pytest.raises(AttributeError, match=f"no attribute '{name}'; try: did you mean '{meant}'"):
        getattr(hb, name)
    assert hasattr(hb, meant)


def test_an_element_is_no_signal_and_its_values_are_named() -> None:
    """Of an element with one letter it was asked whether a unit was meant: coulombs."""
    m = hb.Model("rc", domain="electrical")
    m.add(C=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> C", "node -> r")
    run = hb.simulate(m, until=1)
    with pytest.raises(hb.UsageError) as caught:
        run["C"]
    assert caught.value.hint == "did you mean 'C.e', 'C.f', 'C.q'?"


def test_a_signal_is_an_array_for_numpy_and_no_list() -> None:
    """An array of it was of no dimension and held the signal itself."""
    run = hb.simulate(discharge(), until=1)
    signal = run["c.e"]
    values = np.asarray(signal)
    assert values.shape == signal.t.shape and np.array_equal(values, signal.y)
    # i = 10 V/(1 kohm) exp(-t/1 s)
    assert np.allclose(values, 10.0 * np.exp(-signal.t), rtol=1e-6)
    for wrong in (lambda: signal[0], lambda: list(signal)):
        with pytest.raises(TypeError, match=r"signal.at\(0.1\) at a time"):
            wrong()


def test_a_sweep_is_told_where_its_plan_stands() -> None:
    with pytest.raises(hb.UsageError, match="HB-S115") as caught:
        hb.sweep(discharge(), {}, collect="final(c.e)", vary={"r.R": [1.0, 2.0]})
    assert "comes second" in caught.value.hint
