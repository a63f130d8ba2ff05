"""Random networks against nodal analysis, and against themselves with nodes swapped."""

import random

import numpy as np
import pytest

import hybond as hb

NODES = 6


def network(seed):
    """Branches (name, a, b, value, control) of a network that has one solution."""
    rng = random.Random(seed)
    found = []
    for n in range(1, NODES):  # a tree first, so that every node has a way to ground
        found.append((f"R{n}", n, rng.randrange(n), rng.uniform(1, 10), None))
    for k in range(rng.randrange(2, 8)):
        a, b = rng.sample(range(NODES), 2)
        found.append((f"R{NODES + k}", a, b, rng.uniform(1, 10), None))
    for k in range(rng.randrange(1, 4)):
        a, b = rng.sample(range(NODES), 2)
        found.append((f"I{k}", a, b, rng.uniform(-2, 2), None))
    # voltage sources reach nodes of their own, in series with a resistor
    extra = NODES
    for kind in rng.choices("VEHV", k=rng.randrange(1, 4)):
        a, b = rng.sample(range(NODES), 2)
        found.append((f"R{extra}x", extra, a, rng.uniform(1, 10), None))
        ends = (extra, b) if rng.random() < 0.5 else (b, extra)
        control = tuple(rng.sample(range(NODES), 2)) if kind == "E" else None
        if kind == "H":
            control = "V0"
        found.append((f"{kind}{extra}", *ends, rng.uniform(-0.5, 0.5), control))
        extra += 1
    found.append(("V0", extra, rng.randrange(NODES), rng.uniform(1, 5), None))
    found.append((f"R{extra}x", extra, rng.randrange(NODES), rng.uniform(1, 10), None))
    for kind in rng.choices("GF", k=rng.randrange(0, 3)):
        a, b = rng.sample(range(NODES), 2)
        control = tuple(rng.sample(range(NODES), 2)) if kind == "G" else "V0"
        found.append((f"{kind}{len(found)}", a, b, rng.uniform(-0.1, 0.1), control))
    return found


def nodal(branches):
    """Node voltages and the current of V0, by modified nodal analysis."""
    nodes = 1 + max(max(a, b) for _, a, b, _, _ in branches)
    volts = [name for name, *_ in branches if name[0] in "VEH"]
    n = nodes + len(volts)
    m, rhs = np.zeros((n, n)), np.zeros(n)
    meter = nodes + volts.index("V0")
    for name, a, b, value, control in branches:
        kind = name[0]
        if kind == "R":
            for i, j, s in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                m[i, j] += s / value
        elif kind == "I":
            rhs[a] -= value
            rhs[b] += value
        elif kind in "GF":
            for i, s in ((a, 1), (b, -1)):
                if kind == "F":
                    m[i, meter] += s * value
                else:
                    m[i, control[0]] += s * value
                    m[i, control[1]] -= s * value
        else:
            k = nodes + volts.index(name)
            m[a, k] += 1
            m[b, k] -= 1
            m[k, a] += 1
            m[k, b] -= 1
            if kind == "V":
                rhs[k] = value
            elif kind == "E":
                m[k, control[0]] -= value
                m[k, control[1]] += value
            else:
                m[k, meter] -= value
    keep = list(range(1, n))
    x = np.linalg.solve(m[np.ix_(keep, keep)], rhs[keep])
    return {**{f"v({k})": x[k - 1] for k in range(1, nodes)}, "i(V0)": x[meter - 1]}


def netlist(branches, swapped=()):
    rows = ["Title"]
    for name, a, b, value, control in branches:
        if name in swapped:
            a, b, value = b, a, value if name[0] == "R" else -value
        senses = (
            ""
            if control is None
            else f" {control}"
            if isinstance(control, str)
            else (f" {control[0]} {control[1]}")
        )
        rows.append(f"{name} {a} {b}{senses} {value!r}")
    return rows


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(24))
def test_voltages_and_currents_are_those_of_nodal_analysis(tmp_path, seed):
    branches = network(seed)
    wanted = nodal(branches)
    path = tmp_path / "net.cir"
    swapped = {name for k, (name, *_) in enumerate(branches) if (seed >> (k % 5)) & 1}
    # followed by ideal amplifiers, which are signals, as they have no load
    rows = netlist(branches, swapped - {"V0"})
    nodes = [name for name in wanted if name.startswith("v")]
    rows += [f"Ex{k} x{k} 0 {name[2:-1]} 0 1" for k, name in enumerate(nodes)]
    rows += ["Hx y 0 V0 1"]
    probes = [f"v(x{k})" for k in range(len(nodes))] + ["v(y)"]
    path.write_text("\n".join([*rows, f".print tran {' '.join(probes)}", ".end"]))
    run = hb.simulate(hb.read_circuit(path).model, until=1)
    for k, name in enumerate(nodes):
        assert run[f"Ex{k}"].at(0.5) == pytest.approx(wanted[name], abs=1e-9)
    current = run["Hx"].at(0.5)
    assert current == pytest.approx(wanted["i(V0)"], abs=1e-9)
