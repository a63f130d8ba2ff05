"""The sign that the slope of a law keeps, whatever number it reads."""

import pytest

import hybond as hb
from hybond.engine.engine import OK, make_engine
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.nonlinear.one_root import sign_by_sizes
from hybond.engine.tables import answered, tables_of


@pytest.mark.parametrize("bond", ["n -> r", "r -> n"])
@pytest.mark.parametrize(
    ("law", "sign"),
    [("sinh(3*f)", -1.0), ("f^3", -1.0), ("-tanh(2*f)", 1.0), ("f^3 - f", 0.0)],
)
def test_a_law_that_resists_is_told_from_one_that_drives_and_reads_what_it_read(bond, law, sign):
    m = hb.Model("law")
    m.add(L=hb.I(1, f=1), n=hb.One(), r=hb.R({"e": law}))
    m.bond("n -> L", bond)
    e = make_engine(answered(tables_of(m.flatten(), until=1.0)))
    assert mode_of(e, []) == OK
    (d,) = [d for d in range(e.model.dynamics) if e.model.dynamic_partner[d] >= 0]
    v = [0.25] * (2 * e.model.slots)
    assert sign_by_sizes(e, e.mode, d, -1, v) == sign
    assert v == [0.25] * (2 * e.model.slots)
