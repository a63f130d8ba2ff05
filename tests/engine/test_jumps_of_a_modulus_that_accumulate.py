"""A yo-yo that winds up on the other side loses a part of its speed each time, and comes to rest.

The modulus jumps as the string is out; ``w+ = w- (J - m r^2)/(J + m r^2)``. What comes behind the
limit of ever shorter turns was the error of steps, without end.
"""

import pytest

import hybond as hb

R, M, G, START = 0.1, 1.0, 9.81, -5.0


def yoyo(inertia):
    m = hb.Model("yo-yo", domain="rotational")
    m.add(w=hb.One(), J=hb.I(inertia), tf=hb.TF(f"if phi > 0 then {R} else -{R}"))
    m.add(v=hb.One(domain="translational"), m=hb.I(M, domain="translational"))
    m.add(W=hb.Se(-M * G, domain="translational"))
    m.bond("w -> J", "w -> tf -> v -> m", "W -> v")
    m.signal(phi=hb.Integral("w.f", start=START))
    return m


def uneven(out, back):
    """One whose string winds up on a thinner or a thicker side."""
    m = yoyo(0.03)
    m.elements["tf"] = hb.TF(f"if phi > 0 then {back} else -{out}")
    return m


def limit(inertia):
    """When the first turn is, and the limit of all."""
    speed_up = M * G * R / (inertia + M * R * R)
    first = (2.0 * -START / speed_up) ** 0.5
    kept = (inertia - M * R * R) / (inertia + M * R * R)
    return first, first + 2.0 * first * kept / (1.0 - kept)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("ratio", [2.0, 3.0, 6.0])
def test_a_yoyo_is_refused_where_its_turns_end(ratio, solver):
    inertia = ratio * M * R * R
    first, end = limit(inertia)
    run = hb.simulate(yoyo(inertia), until=1.5 * end, on_error="return", solver=solver)
    assert run.status == "error" and run.error.code == "HB-N410"
    assert run.t_end == pytest.approx(end, rel=1e-4)
    kept = (ratio - 1.0) / (ratio + 1.0)
    speed = (2.0 * -START * M * G * R / (inertia + M * R * R)) ** 0.5
    top = first + kept * first  # as long on the way back as it took, at a part of the speed
    assert run["w.f"].at(first * (1 - 1e-9)) == pytest.approx(speed, rel=1e-7)
    assert run["w.f"].at(first * (1 + 1e-9)) == pytest.approx(kept * speed, rel=1e-7)
    assert run["w.f"].at(top) == pytest.approx(0.0, abs=1e-6 * speed)


@pytest.mark.parametrize("ratio", [2.0, 3.0])
def test_before_that_it_runs(ratio):
    inertia = ratio * M * R * R
    _, end = limit(inertia)
    run = hb.simulate(yoyo(inertia), until=0.999 * end)
    assert run.status == "ok" and run.audit().holds()


@pytest.mark.parametrize("until", [20.0, 3600.0])
def test_teeth_that_only_happen_to_come_faster_are_passed(until):
    """A flywheel that is driven up and brakes: one tooth lies just behind another by chance."""
    m = hb.Model("teeth", domain="rotational")
    m.add(w=hb.One(), J=hb.I(1.0), T=hb.Se("if time < 8 then 1 else 0"), B=hb.R(0.02))
    m.bond("T -> w -> J", "w -> B")
    for k, radius in enumerate(
        ("if sin(phi) > 0 then 0.1 else 0.09", "if phi > 21.9912486 then 0.1 else 0.09")
    ):
        part = {f"v{k}": hb.One(domain="translational"), f"m{k}": hb.I(1.0, domain="translational")}
        m.add({f"tf{k}": hb.TF(radius), **part})
        m.bond(f"w -> tf{k} -> v{k} -> m{k}")
    m.signal(phi=hb.Integral("w.f", start=0.5))
    run = hb.simulate(m, until=until)
    assert run.status == "ok" and len(run.events) > 20


def test_where_it_ends_does_not_hang_on_how_long_the_run_would_be():
    ends = [
        hb.simulate(yoyo(0.03), until=until, on_error="return").t_end for until in (3.0, 20.0, 1e4)
    ]
    assert ends == pytest.approx([ends[0]] * 3, rel=3e-6)


@pytest.mark.parametrize(("out", "back"), [(0.1, 0.11), (0.1, 0.15), (0.15, 0.1)])
def test_turns_that_are_long_and_short_in_turn_have_a_limit_as_well(out, back):
    inertia = 0.03
    run = hb.simulate(uneven(out, back), until=20.0, on_error="return")
    speed, t, phi = 0.0, 0.0, START
    ways = [out, back]
    for k in range(400):
        here, there = ways[k % 2], ways[(k + 1) % 2]
        push = M * G * here / (inertia + M * here * here)
        # from rest, or with what is left of the speed up and back
        way = -phi if k == 0 else 0.0
        t += (2.0 * way / push) ** 0.5 if k == 0 else 2.0 * speed / push
        speed = (2.0 * way * push) ** 0.5 if k == 0 else speed
        kept = inertia - M * here * there
        speed = abs(kept) / (inertia + M * there * there) * speed
    assert run.status == "error" and run.error.code == "HB-N410"
    assert run.t_end == pytest.approx(t, rel=1e-5)


@pytest.mark.parametrize("until", [0.1, 2.0, 20.0])
def test_steps_of_a_converter_that_come_faster_for_a_while_are_passed(until):
    """``floor`` of what rises with the square of the time, for ten microseconds."""
    m = hb.Model("steps", domain="electrical")
    m.add(V=hb.Se("floor(x)"), i=hb.One(), c=hb.C(1e-6), r=hb.R(10.0), n=hb.Zero())
    m.bond("V -> n -> c", "n -> i -> r")
    m.signal(x="min(time, 0.00001)^2*200000000000")
    run = hb.simulate(m, until=until)
    assert run.status == "ok" and run["c.e"].at(until) == pytest.approx(20.0, rel=1e-9)
