"""Clutches and a brake hold two shafts at rest beside a one-way clutch: none fights another.

Friction that came to rest was left at its limit against friction beside it as soon as any one-way
law took part, and the run told nobody that the shares are open: brakes changed what they hold when
a body that touches none of them met its stop. The oracle: the torques of least squares that keep
both shafts in equilibrium, the one-way clutch pushing or giving nothing.
"""

from __future__ import annotations

import random

import numpy as np
import pytest

import hybond as hb

WHERE = ["apart", "a", "b"]


def least(load: float, ratios: tuple[float, float], where: str) -> dict[str, float]:
    """The smallest torques in ``load = r0 c0 + r1 c1 - F_a`` and ``bk = c0 + c1 + F_b``.

    Where the one-way clutch would have to pull, it gives nothing.
    """
    pushes = [-float(where == "a"), float(where == "b")]
    for takes in (True, False):
        push = pushes if takes else [0.0, 0.0]
        rows = [[ratios[0], ratios[1], 0.0, push[0]], [1.0, 1.0, -1.0, push[1]]]
        c0, c1, bk, free = np.linalg.lstsq(np.array(rows), np.array([load, 0.0]), rcond=None)[0]
        if free >= -1e-12:
            break
    return {"c0.e": c0, "c1.e": c1, "bk.e": bk, "F.e": free}


def tied_up(
    load: float, ratios: tuple[float, float], where: str, seed: int, speeds: tuple[float, float]
) -> hb.Model:
    """Two shafts with two gears and a clutch in each, a brake on one, a one-way clutch to ground.

    In `apart` that stops a third body at 1 s, which is joined to nothing else.
    """
    r = random.Random(seed)
    parts = {
        "a": hb.One(),
        "Ja": hb.I(1.0, f=speeds[0]),
        "b": hb.One(),
        "Jb": hb.I(1.0, f=speeds[1]),
        "M": hb.Se(load),
        "bk": hb.One(law="coulomb", limit=2.0),
        "F": hb.Zero(law="diode"),
        "held": hb.One(),
        "ground": hb.Sf(0.0),
    }
    bonds = ["M -> a -> Ja", "b -> Jb", "b -> bk", "ground -> held -> F"]
    for k, (ratio, limit) in enumerate(zip(ratios, (3.0, 4.0), strict=True)):
        parts[f"g{k}"] = hb.TF(ratio)
        parts[f"s{k}"] = hb.One()
        parts[f"z{k}"] = hb.Zero()
        parts[f"c{k}"] = hb.One(law="coulomb", limit=limit)
        bonds += [f"a -> g{k} -> s{k} -> z{k} -> b", f"z{k} -> c{k}"]
    if where == "apart":
        parts |= {"x": hb.One(), "Jx": hb.I(1.0, f=1.0), "Mx": hb.Se(-1.0)}
        bonds += ["F -> x", "Mx -> x -> Jx"]
    else:
        bonds.append(f"F -> {where}")
    names = list(parts)
    r.shuffle(names)
    r.shuffle(bonds)
    m = hb.Model("tied_up", domain="rotational")
    m.add(**{name: parts[name] for name in names})
    m.bond(*bonds)
    return m


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("load", [0.5, -0.5])
@pytest.mark.parametrize("where", WHERE)
def test_no_friction_at_rest_fights_another_beside_a_one_way_clutch(
    where: str, load: float, solver: str
) -> None:
    for seed, ratios in enumerate([(1.0, 2.0), (0.5, 1.5), (1.0, 3.0)]):
        speeds = (1.0, 0.5) if where != "a" else (1.0, 1.2)
        run = hb.simulate(tied_up(load, ratios, where, seed, speeds), "5 s", solver=solver)
        run.audit()
        wanted = least(load, ratios, "" if where == "apart" else where)
        if where == "apart":
            wanted["F.e"] = 1.0
        for name, torque in wanted.items():
            assert run[name].at(5.0) == pytest.approx(torque, abs=1e-9), (name, ratios)
        assert run["a.f"].at(5.0) == pytest.approx(0.0, abs=1e-9)
        assert run["b.f"].at(5.0) == pytest.approx(0.0, abs=1e-9)
        assert "least leakage decides" in " ".join(map(str, run.warnings))


def test_a_body_that_meets_its_stop_changes_no_torque_of_brakes_it_does_not_touch() -> None:
    for seed in range(4):
        run = hb.simulate(tied_up(0.5, (1.0, 2.0), "apart", seed, (1.0, 0.5)), "3 s")
        for name in ("c0.e", "c1.e", "bk.e"):
            before, after = run[name].at(0.9), run[name].at(1.1)
            assert after == pytest.approx(before, abs=1e-9)
