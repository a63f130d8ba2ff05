"""Programs without what a model does not need say nothing that a compiler warns of."""

from __future__ import annotations

from hybond.translate import load_texts
from hybond.translate.c_printer import CPrinter
from hybond.translate.effects import effects_of
from hybond.translate.specialise import Specialist

MODEL = """
from __future__ import annotations

from hybond.engine.words import Floats, given


@given
class Model:
    many: int
"""
USER = """
from __future__ import annotations

from hybond.engine.model import Model
from hybond.engine.words import Floats


def put(v: Floats) -> Floats:
    v[0] = 1.0
    return v


def half(v: Floats) -> float:
    return 0.5 * v[0]


def used(m: Model, v: Floats) -> float:
    same = put(v)
    part = half(v)
    if m.many > 0:
        return same[0] + part
    return v[0]
"""


def test_a_call_stays_whose_result_nothing_reads_any_more() -> None:
    """It changes something; what only reads goes, and so do both variables."""
    program = load_texts({"model": MODEL, "user": USER})
    effects = effects_of(program, ["used"])
    less, uses = Specialist(program, effects).program_for({("Model", "many"): 0})
    printer = CPrinter(less, ["used"], effects=effects, uses=uses)
    (module,) = [m for m in less.modules if m.name == "user"]
    text = "\n".join(printer.chapter(module))
    body = text[text.index("static double used(") :]
    assert "    put(v);" in body
    assert "same" not in body and "part" not in body and "half" not in text
