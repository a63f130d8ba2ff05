"""What Python and C both say is the same in both."""

import ctypes
import re

import numpy as np
import pytest

from hybond.equations import mode
from hybond.kernel import crossing, marcher, settling
from hybond.kernel.build import SOURCES
from hybond.kernel.bytecode import DEPTH
from hybond.kernel.structs import (
    ADDRESSES,
    INTEGER,
    INTEGERS,
    REAL,
    REALS,
    Atlas,
    Log,
    Memory,
    Mode,
    Motion,
    Rows,
    Sampling,
    Schedule,
    Trail,
)
from hybond.model.expressions import FLOATS, compile_expression, parse
from hybond.modes import dirac, jump, locate, trial
from hybond.modes.laws import complementarity
from hybond.solvers import dopri, implicit, newton
from hybond.solvers.collocation import collocation

HEADER = re.sub(r"/\*.*?\*/", "", (SOURCES / "hybond.h").read_text(), flags=re.S)
STRUCTURES = [Sampling, Rows, Mode, Memory, Motion, Trail, Atlas, Schedule, Log]
TYPES = {
    "int32_t": INTEGER,
    "int64_t": ctypes.c_int64,
    "double": REAL,
    "hb_rows": Rows,
    "hb_memory": Memory,
}
POINTERS = {"int32_t": INTEGERS, "double": REALS, "hb_mode": ADDRESSES}


def declared(name):
    body = re.search(r"typedef struct \{([^}]*)\} " + name + ";", HEADER).group(1)
    for line in filter(str.strip, body.split(";")):
        kind, rest = line.replace("const ", "").split(None, 1)
        for one in map(str.strip, rest.split(",")):
            yield one.lstrip("*"), (POINTERS if one.startswith("*") else TYPES)[kind]


def numbers(file, *names):
    text = (SOURCES / file).read_text()
    return [float(re.search(rf"\b{name} = ([0-9.e+-]+)", text).group(1)) for name in names]


def table(file, name):
    """The numbers of an array, which may be products and quotients of others."""
    text = re.search(rf"\b{name}\[.*?= (\{{.*?\}});", (SOURCES / file).read_text(), re.S).group(1)
    root = re.search(r"#define S6 (\S+)", (SOURCES / "radau.h").read_text()).group(1)
    rows = [row for row in re.split(r"\}\s*,|\{|\}", text.replace("S6", root)) if row.strip()]
    found = [[_value(one) for one in row.split(",") if one.strip()] for row in rows]
    return np.array(found if len(found) > 1 else found[0])


def _value(text):
    return compile_expression(parse(text.strip()), {}, FLOATS, pre_offset=0)(())


@pytest.mark.parametrize("structure", STRUCTURES)
def test_fields_stand_as_in_the_header(structure):
    fields = [(f[0], f[1]) for f in structure._fields_]
    assert fields == list(declared(structure.__doc__.strip("`.")))


def test_a_misspelt_field_is_refused():
    with pytest.raises(AttributeError):
        Mode().rowz = 3


def test_reasons_and_sizes_are_the_same():
    listed = re.search(r"enum \{ (HB_ARRIVED.*?) \};", HEADER).group(1).split(", ")
    assert [getattr(marcher, name.removeprefix("HB_")) for name in listed] == list(
        range(len(listed))
    )
    methods = re.search(r"METHODS\[\] = \{(.*?)\}", (SOURCES / "method.c").read_text()).group(1)
    twins = {"hb_dopri": "rk45", "hb_radau": "radau", "hb_exact": "exact"}
    assert tuple(twins[name.strip(" &")] for name in methods.split(",")) == marcher.METHODS
    assert numbers("hybond.h", "HB_SAMPLES") == [len(locate.FRACTIONS)]
    assert numbers("hybond.h", "HB_GRID") == [len(locate.GRID)]
    assert numbers("bytecode.c", "DEPTH") == numbers("pairs.c", "DEPTH") == [DEPTH]


def test_constants_are_the_same():
    assert numbers("locate.c", "DEEPEST", "AROUND", "SEARCH") == [
        locate.DEEPEST,
        locate.AROUND,
        locate.SEARCH,
    ]
    assert numbers("pairs.c", "ROUNDING") == [dirac.ROUNDING]
    assert numbers("settle.c", "IMPULSE_RTOL") == [dirac.IMPULSE_RTOL]
    assert numbers("branches.c", "ZERO") == [complementarity.ZERO]
    assert numbers("branches.c", "DUST") == [trial.DUST]
    assert numbers("branches.c", "CARRIES") == [settling.CARRIES]
    assert numbers("values.c", "TOLERANCE", "STEPS") == [
        mode.NEWTON_TOLERANCE,
        mode.NEWTON_STEPS,
    ]
    assert numbers("constraints.c", "STEPS") == [jump.JUMP_STEPS]
    assert numbers("hybond.h", "HB_WRITES") == [crossing.WRITES]
    assert numbers("constraints.c", "MET", "AGREE", "CANCELLED", "NOTHING", "TINY") == [
        jump.CONSISTENT,
        jump.AGREE,
        jump.CANCELLED,
        jump.NOTHING,
        jump.TINY,
    ]
    assert numbers("dopri.c", "BETA", "SAFETY", "SHRINK", "GROW", "SMALLEST") == [
        dopri._BETA,
        dopri._SAFETY,
        dopri._SHRINK,
        dopri._GROW,
        dopri._SMALLEST_ERROR,
    ]
    assert numbers("radau.c", "SAFETY", "SHRINK", "GROW", "SMALLEST", "KEEP", "FRESH", "SLOW") == [
        implicit._SAFETY,
        implicit._SHRINK,
        implicit._GROW,
        implicit._SMALLEST_ERROR,
        implicit._KEEP,
        implicit._FRESH,
        implicit._SLOW,
    ]
    assert numbers("stages.c", "ENOUGH", "STEADY") == [implicit._ENOUGH, newton._STEADY]
    assert numbers("radau.h", "ITERATIONS") == [newton.ITERATIONS]


def test_the_method_of_radau_is_the_same():
    method = collocation()
    for file, name, values in [
        ("radau.h", "C", method.c),
        ("radau.c", "A", method.a),
        ("radau.c", "ERROR", method.error),
        ("radau.c", "POLYNOMIAL", method.polynomial),
        ("stages.c", "INVERSE", method.inverse),
    ]:
        assert table(file, name) == pytest.approx(values, rel=1e-13, abs=1e-15), name
    assert [
        *numbers("radau.h", "REAL"),
        *numbers("stages.c", "PAIR_RE", "PAIR_IM"),
    ] == pytest.approx([method.real, method.pair.real, method.pair.imag], rel=1e-13)


def test_eigenvectors_are_scaled_to_end_in_one():
    """Here one factor is free: it is shared out between what leads in and what leads out."""
    method = collocation()
    parts = {name: table("stages.c", name) for name in ("REAL_OUT", "REAL_IN")}
    parts |= {n: table("stages.c", n) @ [1.0, 1.0j] for n in ("PAIR_OUT", "PAIR_IN")}
    for kind, out, into in [
        ("REAL", method.real_out, method.real_in),
        ("PAIR", method.pair_out, method.pair_in),
    ]:
        assert parts[f"{kind}_OUT"] == pytest.approx(out / out[2], rel=1e-12, abs=1e-14)
        assert parts[f"{kind}_IN"] == pytest.approx(into * out[2], rel=1e-12)
