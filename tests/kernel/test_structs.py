"""What Python and C both say is the same in both."""

import ctypes
import re

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
    Mode,
    Motion,
    Rows,
    Sampling,
    Schedule,
    Trail,
)
from hybond.modes import dirac, jump, locate, trial
from hybond.modes.laws import complementarity
from hybond.solvers import dopri

HEADER = re.sub(r"/\*.*?\*/", "", (SOURCES / "hybond.h").read_text(), flags=re.S)
TYPES = {"int32_t": INTEGER, "int64_t": ctypes.c_int64, "double": REAL, "hb_rows": Rows}
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


@pytest.mark.parametrize("structure", [Sampling, Rows, Mode, Motion, Trail, Atlas, Schedule, Log])
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
    assert numbers("constraints.c", "MET", "AGREE", "CANCELLED", "NOTHING") == [
        jump.CONSISTENT,
        jump.AGREE,
        jump.CANCELLED,
        jump.NOTHING,
    ]
    assert numbers("dopri.c", "BETA", "SAFETY", "SHRINK", "GROW", "SMALLEST") == [
        dopri._BETA,
        dopri._SAFETY,
        dopri._SHRINK,
        dopri._GROW,
        dopri._SMALLEST_ERROR,
    ]
