"""Bond graphs to draw, made directly as flat graphs: these tests need no parser."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hybond.model.graph import Bond, End, FlatGraph, Machine, Node, Storage
from hybond.report import EventTable
from hybond.units import DOMAINS


def make_graph(
    elements: Mapping[str, tuple[str, str] | str],
    chains: Sequence[str],
    *,
    machines: Mapping[str, Mapping[str, Sequence[str]]] | None = None,
    hidden: Sequence[str] = (),
    title: str = "",
    layout: Mapping[str, tuple[float, float]] | None = None,
) -> FlatGraph:
    """Build a flat graph: elements are ``name: kind`` or ``name: (kind, label)``."""
    domain = DOMAINS["generic"]
    paths = list(elements)
    number = {p: k for k, p in enumerate(paths)}
    pairs = []
    for chain in chains:
        names = [n.strip() for n in chain.split("->")]
        pairs += list(itertools.pairwise(names))
    bonds = tuple(
        Bond(k, number[a], number[b], f"{a} -> {b}", domain) for k, (a, b) in enumerate(pairs)
    )
    table = [
        Machine(
            index=k,
            path=path,
            states=tuple(states),
            on=tuple(frozenset(number[n] for n in on) for on in states.values()),
            start=0,
            rules=(),
        )
        for k, (path, states) in enumerate((machines or {}).items())
    ]
    nodes, storages = [], []
    for k, path in enumerate(paths):
        given = elements[path]
        kind, label = (given, "") if isinstance(given, str) else given
        ends = [(b.index, b.head == k) for b in bonds if k in (b.tail, b.head)]
        machine = next((m.index for m in table if k in m.controls), None)
        nodes.append(
            Node(
                index=k,
                path=path,
                kind=kind,
                ends=tuple(End(b, inward, port) for port, (b, inward) in enumerate(ends)),
                domain=domain,
                controlled=machine is not None,
                machine=machine,
                label=label,
                hidden=path in hidden,
            )
        )
        if kind in ("C", "I"):
            for port, (b, inward) in enumerate(ends):
                storages.append(
                    Storage(len(storages), k, port, b, 1 if inward else -1, kind, path, 0.0)
                )
    return FlatGraph(
        name="model",
        title=title,
        nodes=tuple(nodes),
        bonds=bonds,
        storages=tuple(storages),
        machines=tuple(table),
        integrals=(),
        inputs=(),
        watches=(),
        signals={},
        parameters={},
        dimensions={},
        layout=layout or {},
    )


def _ball() -> FlatGraph:
    return make_graph(
        {
            "weight": ("Se", "-m*g"),
            "ball": ("I", "m"),
            "pad": ("C", "1 mm/N"),
            "damper": ("G", "10 m/(N*s)"),
            "v": "1",
            "contact": "0",
            "squeeze": "1",
        },
        ["weight -> v -> ball", "contact -> v", "contact -> squeeze -> pad", "squeeze -> damper"],
        machines={"floor": {"away": [], "touching": ["contact"]}},
        title="Ball on a springy floor (Margetts & Ngwompo)",
    )


def _diode() -> FlatGraph:
    return make_graph(
        {
            "V": ("Se", "10 V"),
            "R": ("R", "10 ohm"),
            "L": ("I", "0.1 H"),
            "drop": ("Se", "0.7 V"),
            "switch": "1",
            "diode": "1",
            "node": "0",
        },
        ["V -> switch -> node -> L", "switch -> R", "diode -> node", "diode -> drop"],
        machines={
            "Sw": {"closed": ["switch"], "open": []},
            "D": {"blocks": [], "conducts": ["diode"]},
        },
        title="Diode and inductor",
    )


def _motor() -> FlatGraph:
    return make_graph(
        {
            "supply": ("Se", "24 V"),
            "i": "1",
            "winding": ("R", "0.5 ohm"),
            "armature": ("I", "1.5 mH"),
            "motor": ("GY", "50 mN*m/A"),
            "w": "1",
            "rotor": ("I", "0.1 g*m^2"),
            "friction": ("R", "20 uN*m*s"),
            "gear": ("TF", "1/20"),
            "out": "1",
            "load": ("I", "J_load"),
            "shaft": ("C", "1/k_shaft"),
            "twist": "0",
        },
        [
            "supply -> i -> motor -> w -> gear -> twist -> out -> load",
            "i -> winding",
            "i -> armature",
            "w -> rotor",
            "w -> friction",
            "twist -> shaft",
        ],
        title="DC motor with gear and elastic shaft",
    )


def _bridge() -> FlatGraph:
    return make_graph(
        {
            "u": ("Se", "u(t)"),
            "line": "1",
            "Ls": ("I", "1 mH"),
            "a": "0",
            "b": "0",
            "p": "0",
            "n": "0",
            **{f"D{k}": "1" for k in (1, 2, 3, 4)},
            **{f"r{k}": ("R", "1 mohm") for k in (1, 2, 3, 4)},
            "out": "1",
            "Cf": ("C", "470 uF"),
            "dc": "0",
            "load": ("R", "50 ohm"),
        },
        [
            "u -> line -> a",
            "b -> line -> Ls",
            "a -> D1 -> p",
            "b -> D2 -> p",
            "n -> D3 -> a",
            "n -> D4 -> b",
            "D1 -> r1",
            "D2 -> r2",
            "D3 -> r3",
            "D4 -> r4",
            "p -> out -> n",
            "out -> dc -> Cf",
            "dc -> load",
        ],
        machines={f"S{k}": {"off": [], "on": [f"D{k}"]} for k in (1, 2, 3, 4)},
        title="Diode bridge",
    )


def _rod() -> FlatGraph:
    return make_graph(
        {
            "mass_x": ("I", "m"),
            "mass_y": ("I", "m"),
            "inertia": ("I", "m*l^2/12"),
            "weight": ("Se", "-m*g"),
            "vx": "1",
            "vy": "1",
            "w": "1",
            "arm_x": ("TF", "l/2*sin(theta)"),
            "arm_y": ("TF", "l/2*cos(theta)"),
            "tip_x": "0",
            "tip_y": "0",
            "slide": "1",
            "touch": "1",
            "friction": ("R", "mu*F_n"),
            "floor": ("Sf", "0"),
        },
        [
            "weight -> vy -> mass_y",
            "vx -> mass_x",
            "w -> inertia",
            "w -> arm_x -> tip_x",
            "w -> arm_y -> tip_y",
            "vx -> tip_x -> slide -> friction",
            "vy -> tip_y -> touch",
            "floor -> touch",
        ],
        machines={
            "normal": {"free": [], "contact": ["touch"]},
            "tangent": {"free": [], "sliding": ["slide"]},
        },
        title="Falling rod",
    )


def _masses(count: int = 20) -> FlatGraph:
    elements: dict[str, Any] = {}
    chains = []
    for k in range(1, count + 1):
        elements |= {f"v{k}": "1", f"m{k}": ("I", "1 kg"), f"k{k}": "0", f"c{k}": ("C", "1 mm/N")}
        chains += [f"v{k} -> m{k}", f"v{k} -> k{k} -> c{k}"]
        if k > 1:
            chains.append(f"k{k - 1} -> v{k}")
    elements |= {"push": ("Se", "1 N"), "wall": ("Sf", "0")}
    chains += ["push -> v1", f"k{count} -> wall"]
    return make_graph(elements, chains, title=f"Chain of {count} masses")


EXAMPLES = {
    "ball": _ball,
    "diode": _diode,
    "motor": _motor,
    "bridge": _bridge,
    "rod": _rod,
    "masses": _masses,
}


@pytest.fixture(params=sorted(EXAMPLES))
def example(request: pytest.FixtureRequest) -> FlatGraph:
    return EXAMPLES[request.param]()


@pytest.fixture
def build() -> Any:
    return make_graph


@pytest.fixture
def examples() -> Any:
    return EXAMPLES


@pytest.fixture
def strokes() -> Any:
    def make(graph: FlatGraph, **kwargs: Any) -> Any:
        given = {"strokes": (1,) * len(graph.bonds), "derivative": (), "conflicts": ()} | kwargs
        return SimpleNamespace(**given)

    return make


def make_run(
    signals: Mapping[str, tuple[str, Sequence[tuple[Any, Any]]]],
    modes: Sequence[tuple[int, ...]],
    *,
    machines: Mapping[str, Sequence[str]] | None = None,
    impulses: Sequence[Mapping[str, float]] = (),
    warnings: Sequence[str] = (),
) -> Any:
    """Return what `plot_run` reads of a result; `impulses` are those at each segment's start."""
    any_signal = next(iter(signals.values()))[1]
    times = [np.asarray(t, dtype=float) for t, _ in any_signal]
    areas = list(impulses) or [{} for _ in times]
    graph = SimpleNamespace(
        nodes=[],
        machines=[SimpleNamespace(path=p, states=tuple(s)) for p, s in (machines or {}).items()],
    )
    events = [
        SimpleNamespace(
            t=t[0],
            steps=(
                SimpleNamespace(kind="mythical", impulses=dict.fromkeys(a, 99.0)),
                SimpleNamespace(kind="continuous", impulses=a),
            ),
        )
        for t, a in zip(times, areas)
    ]
    return SimpleNamespace(
        title="A run of $x$",
        t_end=float(times[-1][-1]),
        warnings=list(warnings),
        graph=graph,
        segments=[SimpleNamespace(t=t, mode=m) for t, m in zip(times, modes)],
        events=EventTable(graph, events),  # type: ignore[arg-type]
        unit=lambda name: signals[name][0],
        pieces=lambda name, points_per_segment=None: [
            (np.asarray(t, dtype=float), np.asarray(y, dtype=float)) for t, y in signals[name][1]
        ],
    )


def bouncing_run(bounces: int = 14, ratio: float = 0.8) -> Any:
    """A ball that bounces: closed form, with the impulse of each impact."""
    g, v, t = 9.81, 5.0, 0.0
    height, speed, areas = [], [], []
    for k in range(bounces):
        local = np.linspace(0.0, 2 * v / g, 40)
        height.append((t + local, v * local - g * local**2 / 2))
        speed.append((t + local, v - g * local))
        areas.append({"contact.e": (1 + ratio) / ratio * v} if k else {})
        t += 2 * v / g
        v *= ratio
    force = [(a, 0.0 * b) for a, b in height]
    return make_run(
        {"height": ("m", height), "v.f": ("m/s", speed), "contact.e": ("N", force)},
        [(0,)] * bounces,
        machines={"floor": ("away", "touching")},
        impulses=areas,
        warnings=["something"],
    )


def switched_run(cycles: int = 2000) -> Any:
    """A pulse-width modulated current, with thousands of events."""
    pieces, level, modes = [], [], []
    for k in range(2 * cycles):
        t = np.linspace(k, k + 1, 3) * 25e-6
        up = k % 2 == 0
        wave = 1e-2 * np.sin(2 * np.pi * t / (cycles * 50e-6))
        pieces.append((t, wave + 1e-3 * (np.linspace(-1, 1, 3) if up else np.linspace(1, -1, 3))))
        level.append((t, np.full(3, 24.0 if up else 0.0)))
        modes.append((int(up), 0, int(k < cycles)))
    return make_run(
        {"L.f": ("A", pieces), "_node$.e": ("V", level), "i2": ("V", level)},
        modes,
        machines={"pwm": ("low", "high"), "idle": ("rest", "work"), "half": ("second", "first")},
    )


@pytest.fixture
def bouncing() -> Any:
    return bouncing_run


@pytest.fixture
def switched() -> Any:
    return switched_run


@pytest.fixture
def run_of() -> Any:
    return make_run


@pytest.fixture(autouse=True)
def _no_open_figures() -> Any:
    import matplotlib

    matplotlib.use("Agg")
    yield
    from matplotlib import pyplot

    pyplot.close("all")
