"""hybond: hybrid bond graphs in Python.

Names are imported when they are first used, so that ``import hybond`` costs next to nothing.

>>> import hybond as hb
>>> model = hb.Model("oscillator", domain="translational")
>>> model.add(mass=hb.I("1 kg"), spring=hb.C("10 mm/N", q="5 cm"), v=hb.One())
>>> model.bond("v -> mass", "v -> spring")
>>> run = hb.simulate(model, until="1 s")
>>> run.status
'ok'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from hybond._version import __version__
from hybond.uncollected import uncollected

if TYPE_CHECKING:
    from hybond import library, studio, switching
    from hybond.analysis.complementarity.form import complementarity
    from hybond.analysis.coverage import Coverage, coverage
    from hybond.analysis.cross.check import CrossCheck, cross_check
    from hybond.analysis.linear.frequency import FrequencyResponse, frequency_response
    from hybond.analysis.linear.linearisation import Linearisation
    from hybond.analysis.linear.linearise import linearise
    from hybond.analysis.modes.reachable import reachable
    from hybond.analysis.modes.records import ModeGraph
    from hybond.analysis.periodic.branch import Continuation
    from hybond.analysis.periodic.continuation import continuation
    from hybond.analysis.periodic.orbit import PeriodicOrbit
    from hybond.analysis.periodic.periodic import periodic
    from hybond.analysis.residuals.residuals import residuals
    from hybond.analysis.restitution.newton_law import newton_law_model
    from hybond.analysis.restitution.restitution import restitution
    from hybond.analysis.sensitivity.goals import EventTime, Final, Total
    from hybond.analysis.sensitivity.gradient import Gradient, gradient
    from hybond.analysis.sensitivity.record import Sensitivities
    from hybond.analysis.sensitivity.sensitivities import sensitivities
    from hybond.analysis.structure.structure import structure
    from hybond.blocks.fmu import FMU
    from hybond.causality.report import causality
    from hybond.circuits.bond_graph_tools import read_bond_graph
    from hybond.circuits.circuit import Conversion, read_circuit
    from hybond.draw import draw, draw_hybrid, draw_mode, draw_modes
    from hybond.equations.derive import state_equations
    from hybond.equations.junction_matrix import junction_matrix
    from hybond.errors import (
        CausalityError,
        DivergenceOfTime,
        EquationError,
        ExpressionError,
        FileError,
        HybondError,
        ModelError,
        NumericsError,
        UnitError,
        UsageError,
    )
    from hybond.files.load import load, loads
    from hybond.files.save import dumps, save
    from hybond.fitting.fit import fit
    from hybond.fitting.optimise import Optimum, optimise
    from hybond.fitting.record import Fit
    from hybond.measures.signal import Signal
    from hybond.model.builder import Model
    from hybond.model.constructors import GY, TF, C, G, I, One, R, Se, Sf, Zero
    from hybond.model.parts import Block, Integral, Sampled, Submodel
    from hybond.model.parts import InputPart as Input
    from hybond.result import Result
    from hybond.runs.policies import (
        LIQSS,
        QSS,
        RK4,
        RK45,
        Auto,
        Euler,
        Exact,
        Hysteresis,
        Journal,
        Limits,
        MoreauJean,
        Radau,
    )
    from hybond.runs.states import State, load_state
    from hybond.scripts.run import run_script
    from hybond.scripts.steps import Step
    from hybond.simulation import simulate
    from hybond.sweep.bifurcation.call import bifurcation
    from hybond.sweep.bifurcation.record import Bifurcation
    from hybond.sweep.collection import Ensemble
    from hybond.sweep.ensemble import ensemble

_HOME = {
    **dict.fromkeys(
        (
            "CausalityError",
            "DivergenceOfTime",
            "EquationError",
            "ExpressionError",
            "FileError",
            "HybondError",
            "ModelError",
            "NumericsError",
            "UnitError",
            "UsageError",
        ),
        "hybond.errors",
    ),
    **dict.fromkeys(("dumps", "load", "loads", "save"), "hybond.files"),
    **dict.fromkeys(
        ("C", "I", "R", "G", "Se", "Sf", "TF", "GY", "One", "Zero"),
        "hybond.model.constructors",
    ),
    **dict.fromkeys(("Block", "Integral", "Sampled", "Submodel"), "hybond.model.parts"),
    "Bifurcation": "hybond.sweep.bifurcation.record",
    "bifurcation": "hybond.sweep.bifurcation.call",
    "Ensemble": "hybond.sweep.collection",
    "FMU": "hybond.blocks.fmu",
    "Input": "hybond.model.parts",
    "Model": "hybond.model.builder",
    "Plan": "hybond.sweep.plan",
    "Result": "hybond.result",
    "Signal": "hybond.measures.signal",
    "SweepTable": "hybond.sweep.table",
    **dict.fromkeys(("draw_hybrid", "draw_mode", "draw_modes"), "hybond.draw"),
    **dict.fromkeys(("Coverage", "coverage"), "hybond.analysis.coverage"),
    **dict.fromkeys(("CrossCheck", "cross_check"), "hybond.analysis.cross.check"),
    **dict.fromkeys(("Conversion", "read_circuit"), "hybond.circuits.circuit"),
    "read_bond_graph": "hybond.circuits.bond_graph_tools",
    "ensemble": "hybond.sweep.ensemble",
    "complementarity": "hybond.analysis.complementarity.form",
    "junction_matrix": "hybond.equations.junction_matrix",
    "Linearisation": "hybond.analysis.linear.linearisation",
    **dict.fromkeys(
        ("FrequencyResponse", "frequency_response"), "hybond.analysis.linear.frequency"
    ),
    "linearise": "hybond.analysis.linear.linearise",
    **dict.fromkeys(("EventTime", "Final", "Total"), "hybond.analysis.sensitivity.goals"),
    **dict.fromkeys(("Gradient", "gradient"), "hybond.analysis.sensitivity.gradient"),
    "Continuation": "hybond.analysis.periodic.branch",
    "continuation": "hybond.analysis.periodic.continuation",
    "PeriodicOrbit": "hybond.analysis.periodic.orbit",
    "periodic": "hybond.analysis.periodic.periodic",
    "Sensitivities": "hybond.analysis.sensitivity.record",
    "Fit": "hybond.fitting.record",
    "fit": "hybond.fitting.fit",
    **dict.fromkeys(("Optimum", "optimise"), "hybond.fitting.optimise"),
    "sensitivities": "hybond.analysis.sensitivity.sensitivities",
    "ModeGraph": "hybond.analysis.modes.records",
    "newton_law_model": "hybond.analysis.restitution.newton_law",
    "reachable": "hybond.analysis.modes.reachable",
    "residuals": "hybond.analysis.residuals.residuals",
    "restitution": "hybond.analysis.restitution.restitution",
    "structure": "hybond.analysis.structure.structure",
    "simulate": "hybond.simulation",
    "run_script": "hybond.scripts.run",
    "Step": "hybond.scripts.steps",
    **dict.fromkeys(
        (
            "LIQSS",
            "QSS",
            "RK4",
            "RK45",
            "Auto",
            "Euler",
            "Exact",
            "Hysteresis",
            "Journal",
            "Limits",
            "MoreauJean",
            "Radau",
        ),
        "hybond.runs.policies",
    ),
    **dict.fromkeys(("State", "load_state"), "hybond.runs.states"),
    "state_equations": "hybond.equations.derive",
    **dict.fromkeys(("StateSpace", "state_space"), "hybond.export.linear.state_space"),
}
_OTHER_NAME = {"Input": "InputPart"}
_ROOMS = {
    "causality": "hybond.causality",
    "draw": "hybond.draw",
    "export": "hybond.export",
    "library": "hybond.library",
    "studio": "hybond.studio",
    "sweep": "hybond.sweep",
    "switching": "hybond.switching",
}
"""Rooms that are public as such; `causality`, `draw`, `export`, `studio`, `sweep` can be called."""

__all__ = [
    "FMU",
    "Auto",
    "Bifurcation",
    "Block",
    "C",
    "CausalityError",
    "Continuation",
    "Conversion",
    "Coverage",
    "CrossCheck",
    "DivergenceOfTime",
    "Ensemble",
    "EquationError",
    "Euler",
    "EventTime",
    "Exact",
    "ExpressionError",
    "FileError",
    "Final",
    "Fit",
    "FrequencyResponse",
    "G",
    "GY",
    "Gradient",
    "HybondError",
    "I",
    "Hysteresis",
    "Input",
    "Integral",
    "LIQSS",
    "Journal",
    "Limits",
    "Linearisation",
    "ModeGraph",
    "Model",
    "ModelError",
    "MoreauJean",
    "NumericsError",
    "One",
    "Optimum",
    "PeriodicOrbit",
    "Plan",
    "QSS",
    "R",
    "RK4",
    "RK45",
    "Radau",
    "Result",
    "Sampled",
    "Se",
    "Sensitivities",
    "Sf",
    "Signal",
    "State",
    "StateSpace",
    "Step",
    "Submodel",
    "SweepTable",
    "TF",
    "Total",
    "UnitError",
    "UsageError",
    "Zero",
    "__version__",
    "bifurcation",
    "causality",
    "complementarity",
    "continuation",
    "coverage",
    "cross_check",
    "draw",
    "draw_hybrid",
    "draw_mode",
    "draw_modes",
    "dumps",
    "ensemble",
    "export",
    "fit",
    "frequency_response",
    "gradient",
    "junction_matrix",
    "library",
    "linearise",
    "load",
    "load_state",
    "loads",
    "newton_law_model",
    "optimise",
    "periodic",
    "reachable",
    "read_bond_graph",
    "read_circuit",
    "residuals",
    "restitution",
    "run_script",
    "save",
    "sensitivities",
    "simulate",
    "state_equations",
    "state_space",
    "structure",
    "studio",
    "sweep",
    "switching",
]


_ELSEWHERE = {
    **dict.fromkeys(("l", "inductor", "inductance", "inertia", "mass", "coil"), "I"),
    **dict.fromkeys(("capacitor", "capacitance", "spring", "compliance", "tank"), "C"),
    **dict.fromkeys(("resistor", "resistance", "damper", "friction"), "R"),
    **dict.fromkeys(("conductance",), "G"),
    **dict.fromkeys(("mse", "effortsource", "voltagesource", "force", "source"), "Se"),
    **dict.fromkeys(("msf", "flowsource", "currentsource", "velocity"), "Sf"),
    **dict.fromkeys(("transformer", "mtf", "gear", "lever"), "TF"),
    **dict.fromkeys(("gyrator", "mgy", "motor"), "GY"),
    **dict.fromkeys(("junction0", "zero", "j0", "p", "parallel"), "Zero"),
    **dict.fromkeys(("junction1", "one", "j1", "s", "series"), "One"),
    **dict.fromkeys(("open", "read", "from_file"), "load"),
    **dict.fromkeys(("sim", "run", "solve"), "simulate"),
    **dict.fromkeys(("linearize", "poles"), "linearise"),
    **dict.fromkeys(("optimize", "minimise", "minimize"), "optimise"),
    **dict.fromkeys(("netlist", "spice", "load_netlist"), "read_circuit"),
}
"""What is named otherwise in other programs, in small letters."""


@uncollected
def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return import_module(_ROOMS[name])
    if name not in _HOME:
        # what looks into every module asks for names of its own, and often
        if name.startswith("_"):
            raise AttributeError(f"module 'hybond' has no attribute {name!r}")
        from hybond.names import did_you_mean

        same = _ELSEWHERE.get(name.lower().removesuffix("junction").rstrip("_"), "")
        near = f"did you mean {same!r}?" if same else did_you_mean(name, __all__)
        more = f"; try: {near}" if near.startswith("did") else ""
        raise AttributeError(f"module 'hybond' has no attribute {name!r}{more}")
    value = getattr(import_module(_HOME[name]), _OTHER_NAME.get(name, name))
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
