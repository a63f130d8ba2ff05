"""``F*tanh(f/v)`` where what is stored gives the effort: the flow is found from that.

Beside its end a millionth of the effort is all of the flow, far less than steps may be off by: the
run crossed the end, where the law holds, to and fro by the error of its steps, or was refused.
"""

import pytest

import hybond as hb


def pushed(scale=1.0, turned=False):
    """Two storages of a field, the smaller behind such a law, with a spring and a mass, shaken."""
    m = hb.Model("pushed")
    m.add(j0=hb.One(), j1=hb.Zero(), j2=hb.One(), r0=hb.R({"e": "0.00813*tanh(f/0.136)"}))
    m.add(c1=hb.C([[0.181, 2.58], [2.58, 117.0]], q=[-0.16618095183844098, 69.49004368572832]))
    m.add(c2=hb.C({"e": "1.38*((q/80.7) + (q/80.7)^3)"}), i3=hb.I(50.5 * scale))
    m.add(s0=hb.Sf("10.9*sin(2.26*time)"))
    m.bond("j1 -> r0", "j2 -> s0", "c1.2 -> j2", "c2 -> j2", "i3 -> j2", "j2 -> j0")
    m.bond("j0 -> j1" if turned else "j1 -> j0", "j1 -> c1.1")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_it_is_not_crossed_to_and_fro(scale, turned):
    # one way a tighter run is a far longer one: there the others are compared
    tight = hb.simulate(pushed(scale, turned), until=0.215, rtol=1e-11 if turned else 1e-8)
    for options in ({}, {"solver": "radau"}, {"rtol": 1e-6}):
        run = hb.simulate(pushed(scale, turned), until=0.215, **options)
        assert run.status == "ok" and run.audit().holds()
        assert len(run.events) <= len(tight.events) + 2
        assert run.stats["steps"] < 1000
        for name in ("c1.1.q", "c1.2.q", "c2.q"):
            assert run[name].at(0.215) == pytest.approx(tight[name].at(0.215), rel=2e-6)
