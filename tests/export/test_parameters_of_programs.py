"""Parameters of exported programs, set when they run, against hybond with these parameters."""

from __future__ import annotations

import copy
import re
import subprocess
from pathlib import Path

import needs
import pytest
from export.programs import (
    Said,
    ask,
    compile_quickly,
    expected,
    needs_c,
    needs_java,
    read_events,
)

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
CASES: list[tuple[str, dict[str, float]]] = [
    ("boost", {"V": 11.0, "light.R": 60.0, "C.C": 2e-5}),  # submodels; one follows from V
    ("half_bridge", {"Vdc": 12.0}),  # switched, timed
    ("diode_inductor", {"t_off": 0.8, "I_th": 0.01}),  # a guard of time, impulses
    ("half_wave_rectifier", {"V": 9.0}),  # a diode as a law
    ("bouncing_ball_newton", {"g": 7.0, "eps": 0.7, "h0": 1.3}),  # impacts that accumulate
    ("bouncing_ball_air", {"k": 900.0, "b": 0.3}),
    ("elevator_actuators", {"T": 0.02, "K": 1.1, "m": 900.0}),  # a sampled controller
    ("cam_follower", {"eps": 0.35}),  # laws of motion that are no polynomials
    ("evaporator", {"area": 1.2, "edge": 1.05}),  # nonlinear
    ("coulomb_friction", {"F": 0.9, "Fb": 1.3}),
    ("relay_feedback", {"sigma": 0.9, "omega": 14.0}),  # along a surface
    ("impacting_stick", {"mu": 0.55, "l": 1.1}),  # impacts with friction
]


def settings(values: dict[str, float]) -> list[str]:
    return [word for k, v in values.items() for word in ("--set", f"{k}={v!r}")]


def same(said: Said, run: Said) -> None:
    assert said.end == pytest.approx(run.end, rel=1e-9)
    assert said.transitions == run.transitions
    assert said.times == pytest.approx(run.times, abs=1e-9 * run.end)
    assert said.states.keys() == run.states.keys()
    for path, value in said.states.items():
        size = max(abs(value), 1e-4 * run.sizes[path])
        assert value == pytest.approx(run.states[path], abs=1e-9 * size), path


def run_with(model: hb.Model, values: dict[str, float]) -> Said:
    return expected(hb.simulate(model, parameters=values))


def program_of(model: hb.Model, folder: Path) -> Path:
    return compile_quickly(str(hb.export(model, to="c")), folder, "model")


def refusal(program: Path, *words: str) -> str:
    """Run a program that ends with 1 and prints nothing but a complaint; return that."""
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    return done.stderr


@pytest.mark.slow
@needs_c
@pytest.mark.parametrize(("name", "values"), CASES, ids=[name for name, _ in CASES])
def test_a_program_with_other_parameters(
    name: str, values: dict[str, float], tmp_path: Path
) -> None:
    model = hb.load(EXAMPLES / f"{name}.toml")
    program = program_of(model, tmp_path)
    run = run_with(model, values)
    assert run.states != run_with(model, {}).states
    same(read_events(ask(program, "--events", *settings(values))), run)


WAVES = [
    "A*sin(314[1/s]*time)",
    "A*exp(-20[1/s]*time)*cos(9[1/s]*time)",
    "A + B*cos(50[1/s]*time)^2",
    "A*B/(2 [V])*sin(40[1/s]*time)*cos(30[1/s]*time + 0.4)",
]


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize("solver", ["exact", "auto"])
@pytest.mark.slow
def test_amplitudes_of_what_is_propagated_are_parameters(solver: str, tmp_path: Path) -> None:
    """They were fixed: `--set` was refused for what a sine or an exponential is multiplied by."""
    m = hb.Model("waves", domain="electrical", parameters={"A": "10 V", "B": "2 V", "R": "3 ohm"})
    for k, wave in enumerate(WAVES):
        m.add(**{f"V{k}": hb.Se(wave), f"j{k}": hb.One(), f"C{k}": hb.C("1 mF")})
        m.add(**{f"R{k}": hb.R("R")})
        m.bond(f"V{k} -> j{k} -> C{k}" if k % 2 else f"j{k} -> V{k}", f"j{k} -> R{k}")
        m.bond(*([] if k % 2 else [f"j{k} -> C{k}"]))
    m.experiment.update(until=0.05, solver=solver)
    program = program_of(m, tmp_path)
    values = {"A": 23.0, "B": -1.5, "R": 4.0}
    same(read_events(ask(program, "--events", *settings(values))), run_with(m, values))


@needs_c
@pytest.mark.slow
def test_it_is_the_program_that_is_exported_with_them(tmp_path: Path) -> None:
    """To the last bit, also where the motion is chaotic."""
    model = hb.load(EXAMPLES / "bouncing_rod.toml")
    program = program_of(model, tmp_path)
    other = copy.copy(model)
    other.parameters = {**model.parameters, "m": "1.1 kg", "g": "9.7 m/s^2"}
    (tmp_path / "other").mkdir()
    baked = program_of(other, tmp_path / "other")
    assert ask(program, "--events", *settings({"m": 1.1, "g": 9.7})) == ask(baked, "--events")


def circuits() -> hb.Model:
    """Circuits side by side, whose parameters have the same values."""
    m = hb.Model("twins", domain="electrical")
    m.parameter(R="5 ohm", S="5 ohm", C="1 mF", D="2*C", U="4 V", cut="0.5", none="0 V")
    for k, (c, start, r) in enumerate(
        [("C", {"e": "U"}, "R"), ("D", {"q": "D*U"}, "S"), ("1 mF", {"e": "4 V"}, "5 ohm")]
    ):
        node, store, lossy = f"n{k}", f"c{k}", f"r{k}"
        m.add(**{node: hb.Zero(), store: hb.C(c, **start), lossy: hb.R(r)})
        m.bond(f"{node} -> {store}", f"{node} -> {lossy}")
    m.add(n3=hb.Zero(), c3=hb.C("1 mF", e="4 V - none"))
    m.add(r3=hb.G({"f": {"table": [["-2*cut", 0, "cut", 5], [-0.2, 0, "0.1*cut", 1]]}}))
    m.bond("n3 -> c3", "n3 -> r3")
    m.experiment["until"] = 0.01
    return m


@needs_c
@pytest.mark.slow
def test_what_follows_from_a_parameter(tmp_path: Path) -> None:
    """Parameters of one value, made of others, in starts and in tables: each goes its own way."""
    model = circuits()
    program = program_of(model, tmp_path)
    before = read_events(ask(program, "--events"))
    for values, moved in (
        ({"R": 7.0}, {"c0.q"}),
        ({"S": 3.0}, {"c1.q"}),
        ({"C": 2e-3}, {"c0.q", "c1.q"}),
        ({"D": 5e-3}, {"c1.q"}),
        ({"D": 5e-3, "C": 3e-3}, {"c0.q", "c1.q"}),
        ({"U": 0.0}, {"c0.q", "c1.q"}),
        ({"cut": 0.3}, {"c3.q"}),
        ({"none": 1.0}, {"c3.q"}),
    ):
        said = read_events(ask(program, "--events", *settings(values)))
        same(said, run_with(model, values))
        # steps are shared: the others move by what the tolerance leaves
        close = {k for k, x in said.states.items() if x == pytest.approx(before.states[k], 1e-5)}
        assert said.states.keys() - close == moved


@needs_c
def test_values_that_make_another_model_are_refused(tmp_path: Path) -> None:
    program = program_of(circuits(), tmp_path)
    assert refusal(program, "--set", "R=0", "--set", "S=1") == (
        "the model is made of other parts where not R != 0: export it again with --set R=0"
        " --set S=1\n"
    )
    assert "where not C > 0" in refusal(program, "--set", "C=-1")
    assert "where not cut < 5" in refusal(program, "--set", "cut=6")


@needs_c
def test_what_is_no_setting_is_refused(tmp_path: Path) -> None:
    program = program_of(circuits(), tmp_path)
    assert "no such parameter" in refusal(program, "--set", "Q=1")
    assert "a number in SI" in refusal(program, "--set", "R=5 kOhm")
    assert "a number in SI" in refusal(program, "--set", "R=inf")
    assert "a number in SI" in refusal(program, "--set", "R")
    assert "usage" in refusal(program, "--set")


@needs_c
def test_help_lists_parameters(tmp_path: Path) -> None:
    said = ask(program_of(circuits(), tmp_path), "--help")
    assert "  R = 5 ohm\n" in said
    assert "  D = 0.002 F, from 2*C\n" in said


def field() -> hb.Model:
    m = hb.Model("coupled", domain="electrical")
    m.parameter(L="2 mH", M="1 mH", R="1 ohm")
    m.add(l=hb.I([["L", "M"], ["M", "L"]], p=["1e-3 V*s", "0 V*s"]), a=hb.One(), b=hb.One())
    m.add(ra=hb.R("R"), rb=hb.R("2*R"))
    m.bond("a -> l.1", "b -> l.2", "a -> ra", "b -> rb")
    m.experiment["until"] = 0.001
    return m


@needs_c
@pytest.mark.slow
def test_a_parameter_that_cannot_be_followed_is_fixed(tmp_path: Path) -> None:
    model = field()
    program = program_of(model, tmp_path)
    assert refusal(program, "--set", "M=0.5e-3") == (
        "M is fixed in this file: it goes into the matrix of a field; export it again with"
        " --set M=0.5e-3\n"
    )
    assert "  L is fixed: " in ask(program, "--help")
    same(read_events(ask(program, "--events", "--set", "R=3")), run_with(model, {"R": 3.0}))


@needs_c
@pytest.mark.slow
def test_a_value_that_decides_is_fixed(tmp_path: Path) -> None:
    """A resistance of zero is left out of the equations."""
    program = program_of(hb.load(EXAMPLES / "boost.toml"), tmp_path)
    assert "where not diode.R_on == 0" in refusal(program, "--set", "diode.R_on=1")


@needs_c
@pytest.mark.slow
def test_thresholds_that_meet_make_a_surface(tmp_path: Path) -> None:
    """With hysteresis a relay switches; without, it slides: that is another model."""
    m = hb.Model("relay")
    m.parameter(low="-0.1", high="0.1")
    m.add(c=hb.C(1.0, q=1.0), u=hb.Sf('if r.state == "plus" then 1 else -1'), n=hb.Zero())
    m.bond("u -> n -> c")
    rules = ["plus -> minus when c.q > high", "minus -> plus when c.q < low"]
    m.machine("r", states={"plus": [], "minus": []}, start="minus", rules=rules)
    m.experiment["until"] = 3.0
    program = program_of(m, tmp_path)
    said = read_events(ask(program, "--events", "--set", "low=-0.3"))
    same(said, run_with(m, {"low": -0.3}))
    assert "made of other parts" in refusal(program, "--set", "low=0.1")


@pytest.mark.slow
@needs_java
def test_a_class_with_other_parameters(tmp_path: Path) -> None:
    """Two classes, compiled at once; what one run sets, the next one has forgotten."""
    models = {"Boost": hb.load(EXAMPLES / "boost.toml"), "Twins": circuits()}
    sets = {"Boost": {"V": 11.0, "light.R": 60.0}, "Twins": {"R": 7.0, "C": 2e-3, "cut": 0.3}}
    calls = []
    for name, model in models.items():
        hb.export(model, to="java", path=tmp_path / f"{name}.java")
        words = ", ".join(f'"{word}"' for word in ("--events", *settings(sets[name])))
        calls += [f"{name}.run(System.out, {words});", f'{name}.run(System.out, "--events");']
    calls.append('System.out.print(Twins.run(System.out, "--set", "R=0"));')
    body = ' System.out.print("\\f"); '.join(calls)
    text = f"final class All {{ public static void main(String[] words) {{ {body} }} }}\n"
    (tmp_path / "All.java").write_text(text, encoding="utf-8")
    sources = map(str, sorted(tmp_path.glob("*.java")))
    lint = ["-Xlint:all", "-Werror", "-d", str(tmp_path)]
    subprocess.run([*needs.JAVAC, *lint, *sources], check=True)
    done = subprocess.run(
        [*needs.JAVA, "-cp", tmp_path, "All"], capture_output=True, text=True, check=True
    )
    said = done.stdout.split("\f")
    for k, (name, model) in enumerate(models.items()):
        same(read_events(said[2 * k]), run_with(model, sets[name]))
        same(read_events(said[2 * k + 1]), run_with(model, {}))
    assert said[-1] == "1"
    assert done.stderr == (
        "the model is made of other parts where not R != 0: export it again with these values\n"
    )


def test_parameters_have_names_in_print() -> None:
    text = str(hb.export(circuits(), to="c"))
    assert re.search(r"^    R = \d+, // R, ohm$", text, re.M)
    assert "m->parameter[D] = checked(2.0 * m->parameter[C], &all_finite);" in text
    assert "double points_0[8]; // arguments, then values" in text


@pytest.mark.slow
@needs_c
@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.stem)
def test_every_parameter_of_every_example(path: Path, tmp_path: Path) -> None:
    """All that may be set at once, against the program that is exported with these values."""
    model = hb.load(path)
    program = program_of(model, tmp_path)
    listed = ask(program, "--help").partition("parameters, in SI:\n")[2].splitlines()
    numbers, units = {}, {}
    for k, line in enumerate(listed):
        found = re.fullmatch(r"  (\w+) = (\S+)(| [^,]+)", line)
        if found:
            numbers[found[1]] = float(found[2]) * (1.0 - 1e-4 * (k + 1.0))
            units[found[1]] = found[3]
    if not numbers:
        pytest.skip("no parameters of its own")
    if path.stem == "friction_oscillator":
        numbers["F"] = 0.9 * numbers["F"]  # stays below the breakaway
    done = subprocess.run(
        [program, "--events", *settings(numbers)], capture_output=True, text=True, check=False
    )
    other = copy.copy(model)
    given = {k: f"{v!r}{units[k]}" if units[k] else v for k, v in numbers.items()}
    other.parameters = {**model.parameters, **given}
    (tmp_path / "other").mkdir()
    baked = program_of(other, tmp_path / "other")
    again = subprocess.run([baked, "--events"], capture_output=True, text=True, check=False)
    assert done.returncode == again.returncode
    one, two = read_events(done.stdout), read_events(again.stdout)
    assert one.transitions == two.transitions
    assert one.times == pytest.approx(two.times, abs=1e-12 * max(two.end, 1e-300))
    for state, value in one.states.items():
        assert value == pytest.approx(two.states[state], rel=1e-9, abs=1e-12), state


@needs_c
@pytest.mark.slow
def test_inputs_follow_their_times(tmp_path: Path) -> None:
    """Tables, those that repeat too, pulses and thresholds of time."""
    m = hb.Model("inputs", domain="electrical")
    m.parameter(t1="1 ms", t2="3 ms", high="1 V", low="1 V", T="1 ms", duty="0.5", k="1", c="2 ms")
    m.add(v=hb.Se("step + saw + pulses"), w=hb.Se("if k*time > c then high else -high"))
    m.add(i=hb.One(), r=hb.R("1 ohm"), l=hb.I("1 mH"))
    m.bond("v -> i -> r", "i -> l", "w -> i")
    step = [("0 s", "high"), ("t1", "low"), ("t2", "1 V"), ("4 ms", "2*high")]
    saw = [("0 s", "0 V"), ("T/2", "low"), ("T", "0 V")]
    pulses = {"period": "T", "duty": "duty", "high": "high", "low": "0 V"}
    m.input(step=hb.Input(table=step), pulses=hb.Input(pwm=pulses))
    m.input(saw=hb.Input(table=saw, linear=True, period="T"))
    m.experiment["until"] = 0.008
    program = program_of(m, tmp_path)
    for values in (
        {"t1": 1.5e-3},
        {"t1": 3e-3, "low": 0.5},
        {"T": 0.7e-3, "duty": 0.3},
        {"duty": 1.0},
        {"k": 2.0, "high": 2.0},
        {"k": -1.0, "c": -1e-3},
    ):
        same(read_events(ask(program, "--events", *settings(values))), run_with(m, values))
    assert "where not t2 >= t1" in refusal(program, "--set", "t1=3.5e-3")
    assert "where not duty <= 1" in refusal(program, "--set", "duty=1.1")
