"""Refusals of functions, given at the command line: in its options, and nothing left behind."""

from pathlib import Path

import pytest

from hybond.cli.arguments import parse
from hybond.cli.main import main
from hybond.errors import UsageError

MODEL = """
hybond = 1
domain = "electrical"

[parameters]
T = "0.1 ms"
I0 = "0 A"

[inputs]
u = { pwm = { period = "T", duty = 0.4 } }

[elements]
V = { Se = "10 V*u" }
B = { Se = "1 V" }
L = { I = "1 mH", f = "I0" }
R = { R = "1 ohm" }
j = { junction = 1 }

[graph]
bonds = ["V -> j -> L", "B -> j", "j -> R"]
"""
ALONE = """
hybond = 1
[elements]
c = { C = 1, q = 1 }
r = { R = 1 }
n = { junction = 0 }
[graph]
bonds = ["n -> c", "n -> r"]
"""
INJECT = ["--inject", "--input", "B", "--output", "L.f", "--frequencies", "1300"]


@pytest.fixture
def files(tmp_path: Path) -> dict[str, str]:
    for name, text in (("driven", MODEL), ("alone", ALONE)):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    (tmp_path / "data.csv").write_text("t,L.f\n1e-4,0.1\n2e-4,0.2\n", encoding="utf-8")
    return {p.stem: str(p) for p in tmp_path.iterdir()}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["periodic", "driven", "--period", "0.15 ms"], "at --period: the model repeats"),
        (["periodic", "driven", "--period", "0.15 ms"], "--period '0.0001 s', or leave it out and"),
        (["periodic", "driven", "--period", "0.15 ms"], "say --multiple 2"),
        (["periodic", "driven", "--along", "Tx=1..2"], "at --along: 'Tx' is no parameter"),
        (["periodic", "driven", "--along", "T=x..2"], "try: --along 'D=0.3..0.7'"),
        (["periodic", "alone"], "--settle '10 s', in which"),
        (["periodic", "driven", "--period", "2*T1"], "did you mean 'T'?"),
        (["periodic", "driven", "--period", "I0"], "'I0' is in A, and no time"),
        (["periodic", "driven", "--period", "L.f"], "reads signals, not parameters alone"),
        (["bifurcation", "driven", "--vary", "I0=0..1:3", "--of", "L.f"], "try: --period T looks"),
        (["linearise", "driven", *INJECT, "--period", "7 us"], "try: --period '0.0001 s'"),
        (["linearise", "driven", *INJECT, "--period", "I0"], "at --period: 'I0' is in A"),
        (["fit", "driven", "data", "--free", "R.R", "--bounds", "R.R=2..3"],
         "--bounds 'pad.C=0.5e-3..2 mm/N', --log pad.C"),
        (["fit", "driven", "data", "--free", "R.R", "--seed", "3"], "at --seed: one search"),
    ],
)  # fmt: skip
def test_places_and_remedies_are_options(
    words: list[str], said: str, files: dict[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([files.get(w, w) for w in words]) == 1
    told = capsys.readouterr().err
    assert said in told and '="' not in told and "hb." not in told


def test_a_period_may_be_an_expression_of_parameters(
    files: dict[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["periodic", files["driven"], "--period", "2*T"]) == 0
    assert "repeats every 200 µs" in capsys.readouterr().out
    assert main(["linearise", files["driven"], *INJECT, "--period", "2*T"]) == 0
    assert "the model repeats every 200 µs" in capsys.readouterr().out


def test_a_sweep_that_cannot_begin_leaves_no_folder(
    files: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    vary = ["sweep", files["driven"], "--vary", "R.R=uniform(1, 2)", "--sample", "random:3"]
    asked = [*vary, "--until", "1 ms", "--out", str(folder)]
    assert main([*asked, "--collect", "final(nothing)"]) == 1
    assert "nothing" in capsys.readouterr().err and not folder.exists()
    assert main([*asked, "--collect", "final(L.f)"]) == 0
    kept = sorted(p.name for p in folder.rglob("*"))
    # one that cannot go on takes away nothing, and says what is another, without guesses
    other = [w.replace("(1, 2)", "(1, 3)") for w in asked]
    capsys.readouterr()
    assert main([*other, "--collect", "final(L.f)"]) == 1
    told = capsys.readouterr().err
    assert "HB-P107" in told and "the plan is another" in told and "SciPy" not in told
    assert sorted(p.name for p in folder.rglob("*")) == kept


@pytest.mark.parametrize(
    ("words", "many"),
    [
        ("measure m.toml --until 1s mean(x) rms(x)", ["mean(x)", "rms(x)"]),
        ("measure m.toml mean(x) --json rms(x)", ["mean(x)", "rms(x)"]),
        ("measure --set a=1 m.toml mean(x) --until 1s rms(x) --json max(x)",
         ["mean(x)", "rms(x)", "max(x)"]),
        ("fit m.toml one.csv --free a two.csv", ["one.csv", "two.csv"]),
        ("fit m.toml --free a one.csv two.csv", ["one.csv", "two.csv"]),
    ],
)  # fmt: skip
def test_options_may_stand_between_words_of_a_list(words: str, many: list[str]) -> None:
    given = parse(words.split())
    assert given.file == "m.toml"
    assert (given.measures if given.verb == "measure" else given.data) == many


def test_what_is_no_list_takes_no_more_words() -> None:
    with pytest.raises(UsageError, match="HB-X101"):
        parse(["run", "m.toml", "--until", "1s", "2s"])


def test_a_misspelt_option_between_words_of_a_list_is_none_of_them() -> None:
    with pytest.raises(UsageError, match="HB-X101"):
        parse(["measure", "m.toml", "x", "--jsn", "y"])
