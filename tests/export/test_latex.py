"""Reports for LaTeX: what they say, and that LaTeX reads it."""

import re
import subprocess
from pathlib import Path

import pytest

import hybond as hb
from hybond.export.latex import to_latex
from hybond.export.latex.formulas import broken, printed_width
from hybond.export.latex.plots import nice

EXAMPLES = Path(__file__).parents[2] / "examples"


def compiled(text: str, folder: Path) -> str:
    """Return what pdflatex says."""
    (folder / "report.tex").write_text(text)
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "report.tex"],
        cwd=folder,
        capture_output=True,
        text=True,
        errors="replace",
    )
    assert done.returncode == 0, done.stdout[-3000:]
    assert (folder / "report.pdf").stat().st_size > 10_000
    return done.stdout


def balanced(text: str) -> bool:
    """Whether braces and environments close in the order in which they open."""
    plain = re.sub(r"\\[{}%]", "", text)
    plain = re.sub(r"(?<!\\)%.*", "", plain)
    depth = 0
    for c in plain:
        depth += (c == "{") - (c == "}")
        if depth < 0:
            return False
    stack = []
    for kind, name in re.findall(r"\\(begin|end)\{([a-z*]+)\}", plain):
        if kind == "begin":
            stack.append(name)
        elif not stack or stack.pop() != name:
            return False
    return depth == 0 and not stack


@pytest.mark.latex
@pytest.mark.parametrize("name", ["falling_rod", "diode_inductor", "cam_follower"])
def test_reports_of_examples_compile(name: str, tmp_path: Path) -> None:
    text = to_latex(hb.load(EXAMPLES / f"{name}.toml"))
    assert balanced(text) and text.isascii()
    said = compiled(text, tmp_path)
    assert "Undefined" not in said and "Overfull \\hbox (1" not in said


def test_a_report_has_every_section_and_the_facts_of_the_run() -> None:
    model = hb.load(EXAMPLES / "diode_inductor.toml")
    run = hb.simulate(model)
    text = to_latex(model, run=run)
    titles = re.findall(r"\\section\{([^}]*)\}", text)
    assert titles == [
        "Bond graph",
        "Causality",
        "Parameters",
        "Elements",
        "State equations",
        "Machines",
        "Signals and inputs",
        "Results",
    ][:6] + ["Results"]
    assert text.count(r"\begin{tikzpicture}") == 3  # the graph, amperes, volts
    for event in run.events:
        assert f"{event.t:.9g}" in text
    assert r"diode.\allowbreak{}e & 0.001 & V\ensuremath{\cdot}s" in text  # the impulse
    mj = "5 \\ensuremath{\\mu}J"
    assert text.count(mj) >= 2  # what is stored before the end, and what is lost there
    assert "mythical" in text and r"\dot{p}_{\mathrm{L}}" in text


def test_values_are_as_written_and_in_si() -> None:
    text = to_latex(hb.load(EXAMPLES / "diode_inductor.toml"))
    row = next(line for line in text.splitlines() if line.startswith(r"I\_\allowbreak{}th &"))
    assert row == r"I\_\allowbreak{}th & 10 mA & 0.01 & A \\"


def nasty() -> hb.Model:
    m = hb.Model(
        "odd_name", title='50 % of $5 & #1_a {x} ~ ^ \\ "q" Ω µ δ → 中', domain="electrical"
    )
    m.about = "A line with % and _ and \\end{document}.\n\nAnother \\input{x}."
    m.parameter(a_b="1 kohm", mu="2 uF")
    m.add(V_in=hb.Se("u_x"), i_=hb.One(), r_1=hb.R("a_b"), c__2=hb.C("mu"))
    m.bond("V_in -> i_ -> r_1", "i_ -> c__2")
    m.input(u_x=hb.Input(pwm={"period": "1 ms", "duty": 0.5}))
    m.signal(w_1=hb.Integral("i_.f*c__2.e"), cond="if u_x > 0.5 then 1 else 0")
    m.machine(
        "M_m", states={"a_a": [], "b_b": []}, start="a_a", rules=["a_a -> b_b when c__2.e >= 0.2"]
    )
    m.experiment = {"until": "3 ms", "plot": ["c__2.e", "i_.f", "w_1", "cond"]}
    return m


@pytest.mark.latex
def test_names_and_titles_do_no_harm(tmp_path: Path) -> None:
    text = to_latex(nasty())
    assert balanced(text) and text.isascii()
    assert text.count(r"\end{document}") == 1 and r"\input{x}" not in text
    said = compiled(text, tmp_path)
    assert "Missing" not in said and "Undefined" not in said


@pytest.mark.slow
def test_no_closed_form_is_said_with_the_reason() -> None:
    m = hb.Model("grid", parameters={f"r{k}": 1.0 + 0.1 * k for k in range(40)})
    m.add(n=hb.Zero(), c=hb.C(1), **{f"n{k}": hb.Zero() for k in range(20)})
    chain = []
    for k in range(20):
        m.add(**{f"a{k}": hb.One(), f"ra{k}": hb.R(f"r{k}"), f"d{k}": hb.R(f"r{20 + k}")})
        chain += [
            f"{'n' if k == 0 else f'n{k - 1}'} -> a{k} -> n{k}",
            f"a{k} -> ra{k}",
            f"n{k} -> d{k}",
        ]
    m.bond("n -> c", *chain)
    for j in range(0, 18, 2):
        m.add(**{f"x{j}": hb.One(), f"rx{j}": hb.R("r3")})
        m.bond(f"n{j} -> x{j} -> n{19 - j}", f"x{j} -> rx{j}")
    text = to_latex(m)
    assert balanced(text)
    with pytest.raises(hb.EquationError) as refused:
        hb.state_equations(m)
    assert refused.value.code.replace("-", "{-}") in text
    assert "no mixed{-}Boolean equations in closed form: a coefficient has over" in text


def test_a_run_that_stops_is_in_the_report() -> None:
    text = to_latex(hb.load(EXAMPLES / "diode_inductor_no_mode.toml"))
    assert "The run stopped: HB{-}N401" in text


def test_a_model_without_experiment_has_no_results() -> None:
    m = hb.Model("rc")
    m.add(c=hb.C(1), r=hb.R(1), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    text = to_latex(m)
    assert r"\section{Results}" not in text and r"\section{Machines}" not in text
    run = hb.simulate(m, until=1)
    assert r"\section{Results}" in to_latex(m, run=run)


def test_long_formulas_are_broken_before_signs_outside_brackets() -> None:
    formula = "y = " + " + ".join(
        rf"\left(a_{{{k}}} - b\right) \, \frac{{c}}{{d + e}}" for k in range(30)
    )
    lines = broken(formula)
    assert len(lines) > 2 and "".join(lines).replace(" ", "") == formula.replace(" ", "")
    assert all(line.count(r"\left") == line.count(r"\right") for line in lines)
    assert all(line.startswith("+ ") for line in lines[1:])
    assert printed_width(r"\frac{abc}{\mathrm{defg}}") == 4


def test_ticks_cover_what_is_shown() -> None:
    for low, high in [(0.0, 0.0), (1e-9, 2e-9), (-3.0, 1e6), (5.0, 5.0)]:
        ticks = nice(low, high)
        assert 2 <= len(ticks) <= 8 and ticks[0] <= low and ticks[-1] >= high
