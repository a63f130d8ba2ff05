"""Portable modules stay in their subset; what leaves it is refused where it stands."""

from __future__ import annotations

import pytest

from hybond.engine.compiled.sources import portable_paths
from hybond.export.formulas import Formulas
from hybond.export.program import DRIVEN, GIVEN, LOG_OR_REPORT, ROOTS, runtime
from hybond.model.expressions import parse
from hybond.translate import PortableError, load, load_texts
from hybond.translate.effects import effects_of
from hybond.translate.modules import text_of
from hybond.translate.reach import reached, uses_of

OTHERS = ("words", "log", "asked", "look", "energies", "known", "trying")
"""What the subset is made of, and what only the library has."""
FILES = [p for p in portable_paths() if p.stem not in OTHERS]


def test_the_runtime_is_portable() -> None:
    program = load(FILES, FILES, lambda path: text_of(path).replace(*LOG_OR_REPORT))
    effects_of(program)
    given = {f.name for f in program.functions.values() if f.body is None}
    calls = {"call_input", "call_input_rate", "call_block", "call_outside"}
    assert given - calls == GIVEN, "what the runtime asks of a model is what programs bring along"
    assert calls <= given, "and what only runs by hybond itself have is printed in no program"


def test_what_is_asked_for_by_its_name_has_that_name_alone() -> None:
    """What two modules call the same is printed with the names of the modules before it."""
    formulas = Formulas({"x": "X"})
    text = "if not (x > 1 and x != 2) or x >= 3 then max(x, 2)^3 - sin(x)/x else -sqrt(x)*x^2"
    formulas.pairs(parse(text))
    formulas.number(parse(f"{text} + mod((x + 1)^2, floor(x))"))
    assert len(formulas.calls) > 15
    assert {*ROOTS, *DRIVEN, *formulas.calls} <= runtime().functions.keys()


HEAD = """
import math
from typing import Final
from hybond.engine.words import Floats, Ints, Records, Text, floats, given, ints
from hybond.engine.words import put_number, put_text, quotient, record, records, some

@record
class Body:
    mass: float
    count: int
    row: Floats
    next: Body

@record
class Many:
    bodies: Records[Body]

"""


def read(body: str, head: str = "def f(a: float, n: int, v: Floats, b: Body) -> float:") -> None:
    lines = "\n".join("    " + line for line in body.splitlines())
    used = "\n    a = a + float(n) + v[0] + b.mass"
    load_texts({"sample": f"{HEAD}\n{head}{used if 'Body' in head else ''}\n{lines}\n"})


def test_what_is_portable_is_read() -> None:
    read(
        "total: float = 0\n"
        "for i in range(n):\n    total += v[i] if i % 2 == 0 else -v[i]\n"
        "while total > 1.0 and not math.isnan(a):\n    total = total / 2\n"
        "if b.next is None:\n    x = 1.0\nelif n > 3:\n    x = math.floor(a)\n"
        "else:\n    return 0.0\n"
        "b.row = floats(n)\n"
        "b.row[n - 1] = x\n"
        "return quotient(total, x) + min(a, x)"
    )


def test_after_a_loop_without_end_stands_what_was_assigned_at_every_break() -> None:
    read("while True:\n    x = a\n    if x > 0.0:\n        break\n    a = -a\nreturn x")
    with pytest.raises(PortableError, match="'x' may have no value"):
        read("while True:\n    if a > 0.0:\n        break\n    x = a\n    a = -x\nreturn x")


REFUSED = [
    ("return [1.0, 2.0]", "List is not an expression"),
    ("return n", None),
    ("return n / 2", "/ of two whole numbers"),
    ("return a // 2.0", "// of float and float"),
    ("return a ** 2", "not in the subset"),
    ("return 0.0 < a < 1.0", "a chain"),
    ("if n:\n    pass\nreturn a", "not true or false"),
    ("if a and b is None:\n    pass\nreturn a", "not true or false"),
    ("x = n\nx = a\nreturn a", "'x' is int, and gets float"),
    ("if n > 0:\n    x = a\nreturn x", "'x' may have no value"),
    ("for i in range(n):\n    x = v[i]\nreturn x", "'x' may have no value"),
    ("for i in range(n):\n    pass\nreturn float(i)", "'i' is neither"),
    ("for i in range(n):\n    i = i + 1\nreturn a", "the variable of a loop"),
    ("for x in v:\n    pass\nreturn a", "over range"),
    ("for i in range(0, n, n):\n    pass\nreturn a", "is a literal"),
    ("x, y = a, a\nreturn x", None),
    ("x = y = a\nreturn x + y", "two targets"),
    ("v[0:2] = v\nreturn a", "slices"),
    ("return v[-1]", "counts from the beginning"),
    ("return v[a]", "int is wanted"),
    ("return len(v)", "not a function of the subset"),
    ("return math.gamma(a)", "math.gamma"),
    ("return math.exp(x=a)", "by position"),
    ("return b.length", "no field 'length'"),
    ("b.mass = b\nreturn a", "float is wanted"),
    ("b.count = a\nreturn a", "int is wanted"),
    ("n + 1\nreturn a", "goes nowhere"),
    ("math.exp(a)\nreturn a", "goes nowhere"),
    ("return", "returns float"),
    ("if n > 0:\n    return a", "may end without a result"),
    ("return a\na = 0.0", "never reached"),
    ("x = 1.0\nreturn a", "never reads 'x'"),
    ("_x = 1.0\nreturn _x", "can be called '_x'"),
    ("x = None\nreturn a", "no type yet"),
    ("try:\n    pass\nfinally:\n    pass\nreturn a", "Try is not a statement"),
    ("return f(a, n)", None),
    ("return f'{a}'", "not an expression"),
    ("return 3000000000 + a", "32 bits"),
    ("x = a if n > 0 else b\nreturn a", "either float or Body"),
    ("put_text('a' + 'b')\nreturn a", "of Text and Text"),
]


@pytest.mark.parametrize(("body", "said"), REFUSED, ids=[b.splitlines()[0] for b, _ in REFUSED])
def test_what_is_not_portable_is_refused(body: str, said: str | None) -> None:
    if body == "return n":  # a whole number goes where a float is wanted
        read(body)
        return
    with pytest.raises(PortableError) as caught:
        read(body)
    assert caught.value.code == "HB-E601"
    assert caught.value.where.startswith("sample.py:")
    if said:
        assert said in caught.value.why


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def f(a, b: int) -> int:\n    return b", "no annotation"),
        ("def f(a: int = 1) -> int:\n    return a", "without defaults"),
        ("def f(a: int):\n    return a", "what it returns"),
        ("def f(a: list[float]) -> int:\n    return 1", "not a type"),
        ("def _f(a: int) -> int:\n    return a", "can be called '_f'"),
        ("def floats(a: float) -> float:\n    return a", "can be called 'floats'"),
        ("limit = 1.0", "Assign does not stand"),
        ("import os", "only `import math`"),
        ("class A:\n    x: int", "plain @record"),
        ("from typing import Final\nA: Final = max(1, 2)", "not a constant"),
        ("from other import g\ndef f(a: int) -> int:\n    return a", "no portable module 'other'"),
    ],
)
def test_declarations_that_are_refused(text: str, said: str) -> None:
    with pytest.raises(PortableError) as caught:
        load_texts({"sample": text})
    assert said in caught.value.why


def test_one_name_is_one_record_in_all_modules() -> None:
    a = "from hybond.engine.words import record\n@record\nclass A:\n    x: int\n"
    with pytest.raises(PortableError, match=r"'A' is declared in b\.py, too"):
        load_texts({"a": a, "b": a})


def test_functions_of_one_name_are_printed_with_their_modules() -> None:
    f = "def f(a: int) -> int:\n    return a\n"
    program = load_texts({"a": f, "b": f + "def g(a: int) -> int:\n    return f(a)\n"})
    assert sorted(program.functions) == ["a_f", "b_f", "g"]
    assert reached(program, ["g"], uses_of(program)).functions == {"g", "b_f"}


def test_constants_are_worked_out() -> None:
    text = "import math\nfrom typing import Final\nA: Final = 2.0\nB: Final = math.sqrt(A) / 2**3\n"
    assert load_texts({"c": text}).constants["B"].value == 2.0**0.5 / 8


ORDER = """
from hybond.engine.words import Floats, Ints
def step(v: Ints) -> int:
    v[0] += 1
    return v[0]
def look(v: Ints) -> int:
    return v[0]
"""


@pytest.mark.parametrize(
    ("line", "fine"),
    [
        ("n = v[0] + step(v)", False),
        ("n = step(v) + step(v)", False),
        ("n = step(v) + 1", True),
        ("n = look(v) + v[0]", True),
        ("v[v[0]] = step(v)", False),
        ("v[n] = step(v)", True),
        ("v[0] += step(v)", False),
        ("n = n + 1 if step(v) > 0 and step(v) > 1 else step(v)", True),
    ],
)
def test_the_order_of_evaluation_does_not_matter(line: str, fine: bool) -> None:
    program = load_texts(
        {"s": f"{ORDER}def f(v: Ints, n: int) -> int:\n    {line}\n    return n\n"}
    )
    if fine:
        effects_of(program)
        return
    with pytest.raises(PortableError, match="a call changes Ints") as caught:
        effects_of(program)
    assert caught.value.where == "s.py:9"


def test_a_table_of_the_model_is_not_changed() -> None:
    text = (
        "from hybond.engine.words import Ints, given\n@given\nclass Tables:\n"
        "    first: Ints\ndef f(m: Tables) -> None:\n    row = m.first\n    row[0] = 1\n"
    )
    with pytest.raises(PortableError, match=r"Tables\.first is given by the model, and changed"):
        effects_of(load_texts({"s": text}))
