"""Arrays of elements, submodels, machines and signals, and ranges of bonds."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
LADDER = """
hybond = 1
domain = "electrical"
[parameters]
n = 10
[elements]
supply = { Se = "1 V" }
"cell[1..n]" = { submodel = "rc", parameters = { C = "(1 + 0.1*i) [mF]" } }
[graph]
bonds = ["supply -> cell[1].in", "cell[1..n-1].out -> cell[2..n].in"]
[signals]
charge = "sum(cell[1..n].c.q)"
[models.rc]
domain = "electrical"
parameters = { C = "1 mF", R = "1 ohm" }
elements = { in = { junction = 1 }, r = { R = "R" }, out = { junction = 0 }, c = { C = "C" } }
graph = { bonds = ["in -> r", "in -> out -> c"] }
ports = { in = "in", out = "out" }
"""


def written_out(n: int) -> str:
    """Return the text of the ladder with its cells one by one, as a person without arrays would."""
    cells = "\n".join(
        f'cell{k} = {{ submodel = "rc", parameters = {{ C = "(1 + 0.1*{k}) [mF]" }} }}'
        for k in range(1, n + 1)
    )
    bonds = ["supply -> cell1.in"]
    bonds += [f"cell{k}.out -> cell{k + 1}.in" for k in range(1, n)]
    text = re.sub(r'"cell\[1\.\.n\]".*', cells, LADDER)
    text = re.sub(r"bonds = \[\"supply.*", f"bonds = {bonds}".replace("'", '"'), text)
    return re.sub(r"charge = .*", "", text)


def test_a_ladder_of_ten_cells_is_the_same_written_out_bit_for_bit() -> None:
    array = hb.simulate(hb.loads(LADDER), until="60 ms")
    cells = hb.simulate(hb.loads(written_out(10)), until="60 ms")
    times = np.linspace(0, 0.06, 61)
    for k in range(1, 11):
        a, b = array[f"cell[{k}].c.q"].at(times), cells[f"cell{k}.c.q"].at(times)
        assert np.array_equal(a, b)
        assert k > 5 or a[-1] > 1e-4
    assert array.stats["steps"] == cells.stats["steps"]


@pytest.mark.parametrize("n", [1, 3, 7])
def test_the_number_of_members_may_be_set(n: int) -> None:
    model = hb.loads(LADDER)
    hb.simulate(model, until="1 ms", parameters={"n": 5})  # what is kept of it must not stay
    run = hb.simulate(model, until="40 ms", rtol=1e-11, parameters={"n": n})
    c = 1e-3 * (1 + 0.1 * np.arange(1, n + 1))
    a = np.zeros((n + 1, n + 1))
    for k in range(n):
        a[k, k] -= 1 / c[k]
        if k:
            a[k, k - 1] += 1 / c[k]
            a[k - 1, k - 1] -= 1 / c[k - 1]
            a[k - 1, k] += 1 / c[k - 1]
    a[0, n] = 1 / c[0]
    v = (expm(a * 0.04) @ np.eye(n + 1)[n])[:n]
    assert run["charge"].at(0.04) == pytest.approx(float(c @ v), rel=1e-8)
    assert run[f"cell[{n}].c.e"].at(0.04) == pytest.approx(v[-1], rel=1e-8)
    with pytest.raises(hb.HybondError, match=f"members 1 to {n}, no {n + 1}"):
        run[f"cell[{n + 1}].c.e"]


def test_members_of_an_ensemble_may_differ_in_length() -> None:
    model = hb.loads(LADDER)
    sets = [{"n": n} for n in (2, 4, 3)]
    many = hb.ensemble(model, "40 ms", sets=sets, outputs="charge", samples=5)
    for k, given in enumerate(sets):
        one = hb.simulate(model, "40 ms", parameters=given)
        assert many.run(k)["charge"].at(0.04) == one["charge"].at(0.04)
    assert len({float(many.run(k)["charge"].at(0.04)) for k in range(3)}) == 3


def test_a_diffusion_line_decays_in_its_own_shapes() -> None:
    """A line of n cells, short at its begin and open at its end, has the eigenvalues
    ``-4/(R*C)*sin(a/2)^2`` with the shapes ``sin(a*j)``, ``a = (2*k - 1)*pi/(2*n + 1)``."""
    text = """
    hybond = 1
    domain = "electrical"
    parameters = { n = 12, k = 3, a = "(2*k - 1)*pi/(2*n + 1)" }
    [elements]
    short       = { Se = 0 }
    "i[1..n]"    = { junction = 1 }
    "r[1..n]"    = { R = "2 ohm" }
    "node[j=1..n]" = { junction = 0 }
    "c[j=1..n]"  = { C = "5 mF", e = "sin(a*j) [V]" }
    [graph]
    bonds = ["short -> i[1]", "node[1..n-1] -> i[2..n]", "i[1..n] -> node[1..n] -> c[1..n]",
      "i[1..n] -> r[1..n]"]
    """
    model = hb.loads(text)
    for n, k in ((12, 1), (12, 3), (5, 5)):
        run = hb.simulate(model, "50 ms", rtol=1e-11, parameters={"n": n, "k": k})
        a = (2 * k - 1) * np.pi / (2 * n + 1)
        decay = np.exp(-4 / (2 * 5e-3) * np.sin(a / 2) ** 2 * 0.05)
        for j in (1, 2, n):
            assert run[f"c[{j}].e"].at(0.05) == pytest.approx(np.sin(a * j) * decay, rel=1e-8)


def test_a_chain_of_masses_swings_in_its_own_shapes() -> None:
    m = hb.Model("chain", domain="translational", parameters={"n": 9, "w": 2})
    m.add(
        {
            "m[1..n]": hb.I("2 kg", f="cos(w*pi*(i - 0.5)/n) [m/s]"),
            "v[1..n]": hb.One(),
            "pull[1..n-1]": hb.Zero(),
            "s[1..n-1]": hb.C("1/(800 [N/m])"),
        }
    )
    m.bond(
        "v[1..n] -> m[1..n]", "v[1..n-1] -> pull[1..n-1] -> v[2..n]", "pull[1..n-1] -> s[1..n-1]"
    )
    m.signal({"x[1..n]": hb.Integral("v[i].f", start="i*0.5 [m]")}, p="sum(m[1..n].p)")
    m.signal(most="max(m[1..n].f)", late="all(x[1..n] > 0.2 [m])", still="any(m[2..4].f > 1 [m/s])")
    run = hb.simulate(m, "3 s", rtol=1e-11)
    omega = 2 * np.sqrt(800 / 2) * np.sin(2 * np.pi / 18)
    shape = np.cos(2 * np.pi * (np.arange(1, 10) - 0.5) / 9)
    for t in (0.7, 3.0):
        for k in range(9):
            speed = run[f"m[{k + 1}].f"].at(t)
            assert speed == pytest.approx(shape[k] * np.cos(omega * t), abs=1e-8)
            place = 0.5 * (k + 1) + shape[k] * np.sin(omega * t) / omega
            assert run[f"x[{k + 1}]"].at(t) == pytest.approx(place, abs=1e-8)
        assert run["p"].at(t) == pytest.approx(0, abs=1e-12)
        assert run["most"].at(t) == pytest.approx(max(shape * np.cos(omega * t)), abs=1e-8)
        assert run["min(m[1..9].f, 0)"].at(t) == pytest.approx(
            min(shape * np.cos(omega * t)), abs=1e-8
        )
    assert run["still"].at(0.0) == 0


def test_an_arm_of_a_converter_with_an_array_of_submodules_is_that_of_the_example() -> None:
    text = (EXAMPLES / "mmc_arm.toml").read_text(encoding="utf-8")
    text = re.sub(
        r"m1  .*\n",
        '"m[1..4]" = { submodel = "submodule", '
        'parameters = { phase = "(0.25*(i - 1)) [ms]", t_off = "t_block" } }\n',
        text,
    )
    text = re.sub(r"m[234]  .*\n", "", text)
    text = re.sub(r'"i -> m1.arm".*\]', '"i -> m[1..4].arm"]', text)
    text = re.sub(r"m1\.", "m[1].", re.sub(r"m2\.", "m[2].", text))
    array, example = (hb.simulate(m) for m in (hb.loads(text), hb.load(EXAMPLES / "mmc_arm.toml")))
    assert [e.t for e in array.events] == [e.t for e in example.events]
    times = np.linspace(0, 9.9e-3, 100)
    for k in range(1, 5):
        assert np.array_equal(array[f"m[{k}].C.e"].at(times), example[f"m{k}.C.e"].at(times))


def test_a_marx_generator_fires_gap_by_gap() -> None:
    m = hb.Model("marx", domain="electrical", parameters={"n": 6, "U": "10 kV"})
    m.add(
        {
            "top[0..n]": hb.Zero(),
            "gap[1..n]": hb.One(),
            "arc[1..n]": hb.R("0.5 ohm"),
            "c[1..n]": hb.C("20 nF", e="-U"),
        },
        ground=hb.Se(0),
        load=hb.R("500 ohm"),
    )
    m.bond("ground -> top[0]", "top[0..n-1] -> gap[1..n] -> top[1..n]")
    m.bond("gap[1..n] -> arc[1..n]", "gap[1..n] -> c[1..n]", "top[n] -> load")
    m.machine(
        "spark[1..n]",
        states={"open": [], "burns": ["gap[i]"]},
        start="open",
        rules=["open -> burns when time >= i*10 [ns]"],
    )
    run = hb.simulate(m, "2 us", rtol=1e-11)
    assert [e.t for e in run.events] == pytest.approx([0, *(k * 1e-8 for k in range(1, 7))])
    assert run["load.e"].at(5.5e-8) == 0
    tau = 503 * 20e-9 / 6
    for t in (1e-7, 1e-6):
        u = 60e3 * 500 / 503 * np.exp(-(t - 6e-8) / tau)
        assert run["load.e"].at(t) == pytest.approx(u, rel=1e-8)
    assert run["sum(c[1..6].e)"].at(0.0) == -60e3


def test_laws_and_inputs_read_the_index() -> None:
    """Diodes with rising thresholds share a current; a thyristor's gate is an input of its own."""
    m = hb.Model("laws", domain="electrical")
    m.add(
        {
            "d[1..3]": hb.One(law="thyristor", gate="g[i] > 0.5"),
            "drop[1..3]": hb.Se("(i) [V]"),
            "r[1..3]": hb.R(["1 ohm", "2 ohm", "4 ohm"]),
        },
        V=hb.Se("5 V"),
        n=hb.Zero(),
    )
    m.bond("V -> n -> d[1..3] -> drop[1..3]", "d[1..3] -> r[1..3]")
    m.input({"g[1..3]": hb.Input(table=[(0, 0), ("i*1 [s]", 1)])})
    run = hb.simulate(m, "4 s")
    for k, r in ((1, 1), (2, 2), (3, 4)):
        assert run[f"d[{k}].f"].at(k - 0.1) == 0
        assert run[f"d[{k}].f"].at(k + 0.1) == pytest.approx((5 - k) / r)


def test_members_can_be_set_one_by_one_and_together() -> None:
    m = hb.Model("set", domain="electrical", parameters={"n": 4})
    m.add({"c[1..n]": hb.C("(i) [F]", e="1 V"), "r[1..n]": hb.R([1, 2, 3, 4])}, a=hb.Zero())
    m.add({"s[1..n]": hb.Submodel("electrical.resistor", R="(i) [ohm]")}, b=hb.Se(1))
    m.bond("b -> a", "a -> s[1..n].plus", "s[1..n].minus -> c[1..n]", "a -> r[1..n]")
    stored = "sum(c[1..4].q)"

    def at(outputs: str, **given: object) -> float:
        parameters = {k.replace("_", "."): v for k, v in given.items()}
        return float(hb.simulate(m, "1 ms", parameters=parameters)[outputs].at(0.0))

    def of(path: str, value: object, outputs: str = stored) -> float:
        return float(hb.simulate(m, "1 ms", parameters={path: value})[outputs].at(0.0))

    assert at(stored) == pytest.approx(10)
    assert of("c[2].C", "5 F") == pytest.approx(13)
    assert of("c[1..n].C", "5 F") == pytest.approx(20)
    assert of("c[4].e", "3 V") == pytest.approx(18)
    assert of("r[3].R", 6, "r[3].f") == pytest.approx(1 / 6)
    assert of("r[3].R", 6, "r[4].f") == pytest.approx(1 / 4)
    assert of("s[3].R", "0.5 ohm", "c[3].f") == pytest.approx(0)
    assert of("s[1..n].R", "0.5 ohm", "s[4].r.e - 0.5*s[4].r.f") == pytest.approx(0)
    assert m.elements["c[1..n]"].value == "(i) [F]"
    with pytest.raises(hb.HybondError) as caught:
        of("c[5].C", 1)
    assert caught.value.code in ("HB-M107", "HB-M152")


LINES = """
hybond = 1
domain = "electrical"
parameters = { m = 2, k = 3 }
[elements]
V = { Se = "1 V" }
"line[1..m]" = { submodel = "line", parameters = { n = "k + i - 1", r = "(2*i) [ohm]" } }
R = { R = "10 ohm" }
[graph]
bonds = ["V -> line[1].a", "line[1..m-1].b -> line[2..m].a", "line[m].b -> R"]
[signals]
all = "sum(line[1..m].held)"
[models.line]
domain = "electrical"
parameters = { n = 5, r = "1 ohm" }
[models.line.elements]
"i[1..n]" = { junction = 1 }
"loss[1..n]" = { R = "r*j[1]" }
"x[1..n]" = { junction = 0 }
"c[1..n]" = { C = "1 mF" }
[models.line.graph]
bonds = ["i[1..n] -> x[1..n] -> c[1..n]", "i[1..n] -> loss[1..n]", "x[1..n-1] -> i[2..n]"]
[models.line.signals]
held = "sum(c[1..n].q)"
"j[1..n]" = "1 + 0*i"
[models.line.ports]
a = "i[1]"
b = "x[n]"
"tap[1..n]" = "x[i]"
"""


def test_arrays_of_submodels_hold_arrays_as_long_as_their_parameter_says() -> None:
    model = hb.loads(LINES)
    graph = model.flatten()
    assert [s.path for s in graph.storages] == [
        *(f"line[1].c[{k}].q" for k in (1, 2, 3)),
        *(f"line[2].c[{k}].q" for k in (1, 2, 3, 4)),
    ]
    # at rest the current of a divider: k cells of 2 ohm, then k + 1 of 4 ohm
    for k in (3, 1, 2):
        run = hb.simulate(model, "2 s", parameters={"k": k}, rtol=1e-10)
        i = 1 / (2 * k + 4 * (k + 1) + 10)
        assert run["R.f"].at(2.0) == pytest.approx(i, rel=1e-6)
        volts = [1 - 2 * i * j for j in range(1, k + 1)]
        volts += [1 - 2 * i * k - 4 * i * j for j in range(1, k + 2)]
        assert run["all"].at(2.0) == pytest.approx(1e-3 * sum(volts), rel=1e-6)
        assert run["line[2].tap[1].e"].at(2.0) == pytest.approx(volts[k], rel=1e-6)


def test_a_longer_line_among_shorter_ones_is_a_parameter_of_one_member() -> None:
    run = hb.simulate(hb.loads(LINES), "2 s", parameters={"line[1].n": 6, "line[2].r": "1 ohm"})
    assert run["R.f"].at(2.0) == pytest.approx(1 / (12 + 4 + 10), rel=1e-6)
