"""Convection and heat exchangers against closed forms and the differential equations behind."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import solve_bvp

import hybond as hb


def part(name: str, inputs: dict[str, object] | None = None, **parameters: object) -> hb.Submodel:
    return hb.Submodel(f"thermal.{name}", inputs=inputs, **parameters)


def between(hot: float, cold: float, wall: hb.Submodel) -> list[hb.Model]:
    m = hb.Model("wall")
    m.add(h=part("ambient", T=hot), wall=wall, c=part("ambient", T=cold))
    return every_way(m, "h.port - wall.hot", "wall.cold - c.port")


def test_a_body_cools_in_a_stream_as_fast_as_that_blows() -> None:
    """``"thermal.convection"``: still air takes nothing."""
    m = hb.Model("cup")
    m.add(
        body=part("heat_capacity", C=500, T_0=360),
        film=part(
            "convection", {"alpha": "if time < 10 then 0 else 30 [W/(m^2*K)]"}, area="0.2 m^2"
        ),
        air=part("ambient", T=300),
    )
    for way in every_way(m, "body.port - film.hot", "film.cold - air.port"):
        run = hb.simulate(way, until=100.0, rtol=1e-9)
        assert run["body.temperature"].at(10) == 360 and run["film.heat"].at(5) == 0
        expected = 300 + 60 * math.exp(-6 / 500 * 90)
        assert run["body.temperature"].at(100) == pytest.approx(expected, rel=1e-9)
        assert run["film.heat"].at(100) == pytest.approx(6 * (expected - 300), rel=1e-6)
        assert run["film.difference"].at(100) == pytest.approx(expected - 300, rel=1e-6)


@pytest.mark.parametrize("start", [380.0, 250.0, 300.0])
@pytest.mark.parametrize("n", [0.25, 1 / 3])
def test_a_wall_cools_the_slower_the_less_it_is_warm(start: float, n: float) -> None:
    """``"thermal.natural_convection"``: x' = -c*x^(1 + n), both ways, and nothing at rest."""
    m = hb.Model("stove")
    m.add(
        body=part("heat_capacity", C=500, T_0=start),
        film=part("natural_convection", area="2 m^2", n=n),
        air=part("ambient", T=300),
    )
    x = abs(start - 300)
    c = 2.8 / 500
    end = (x**-n + n * c * 200) ** (-1 / n) if x else 0.0
    for way in every_way(m, "body.port - film.hot", "film.cold - air.port"):
        run = hb.simulate(way, until=200.0, rtol=1e-9)
        found = run["body.temperature"].at(200)
        assert found == pytest.approx(300 + math.copysign(end, start - 300), rel=1e-9)
        assert run["film.heat"].at(200) == pytest.approx(
            math.copysign(2.8 * end ** (1 + n), start - 300), rel=1e-5, abs=1e-9
        )
        assert run["film.alpha"].at(200) == pytest.approx(1.4 * end**n, rel=1e-5, abs=1e-3)


def along(kind: str, UA: float, hot: float, cold: float, counts: tuple[float, float]) -> tuple:
    """Both streams along the wall, by their differential equations."""
    way = -1.0 if kind == "counterflow" else 1.0

    def rates(x, T):
        heat = UA * (T[0] - T[1])
        return np.vstack([-heat / counts[0], way * heat / counts[1]])

    def ends(first, last):
        return np.array([first[0] - hot, (last if way < 0 else first)[1] - cold])

    x = np.linspace(0, 1, 41)
    guess = np.vstack([np.full_like(x, hot), np.full_like(x, cold)])
    found = solve_bvp(rates, ends, x, guess, tol=1e-9)
    assert found.success
    return found.y[0, -1], found.y[1, 0 if way < 0 else -1]


@pytest.mark.parametrize("kind", ["counterflow", "parallel"])
@pytest.mark.parametrize("counts", [(100.0, 300.0), (250.0, 80.0), (120.0, 120.0)])
def test_a_heat_exchanger_gives_what_the_streams_along_its_wall_exchange(
    kind: str, counts: tuple[float, float]
) -> None:
    """``"thermal.counterflow_exchanger"`` and ``"thermal.parallel_exchanger"``."""
    out = along(kind, 200.0, 360.0, 290.0, counts)
    flows = {"flow_hot": counts[0], "flow_cold": -counts[1]}
    for m in between(360.0, 290.0, part(f"{kind}_exchanger", flows, UA=200)):
        run = hb.simulate(m, until=0.1)
        assert run["wall.out_hot"].at(0.1) == pytest.approx(out[0], rel=1e-7)
        assert run["wall.out_cold"].at(0.1) == pytest.approx(out[1], rel=1e-7)
        heat = run["wall.heat"].at(0.1)
        assert heat == pytest.approx(counts[0] * (360 - out[0]), rel=1e-5)
        assert run["c.heat"].at(0.1) == pytest.approx(-heat)
        assert run["wall.effectiveness"].at(0.1) == pytest.approx(heat / min(counts) / 70)


@pytest.mark.parametrize("kind", ["counterflow", "parallel"])
def test_a_stream_that_stops_ends_the_exchange_without_a_gap(kind: str) -> None:
    """The cold stream falls to nothing and turns; no wall, or one of no end, are right, too."""
    flows = {"flow_hot": "100", "flow_cold": "100 [W/K]*(1 - time/(1 [s]))"}
    (m, *_) = between(360.0, 290.0, part(f"{kind}_exchanger", flows, UA=200))
    run = hb.simulate(m, until=2.0)
    assert run["wall.heat"].at(1.0) == 0
    # what is left of the stream comes up to the temperature of the other
    assert run["wall.heat"].at(0.999) == pytest.approx(70 * 0.1, rel=2e-2)
    assert run["wall.out_cold"].at(0.9999) == pytest.approx(360, abs=0.5)
    assert run["wall.heat"].at(2.0) == pytest.approx(run["wall.heat"].at(0.0), rel=1e-9)
    for UA, part_of in ((0.0, 0.0), (1e7, 1.0 if kind == "counterflow" else 0.5)):
        given = {"flow_hot": 100, "flow_cold": 100}
        (m, *_) = between(360.0, 290.0, part(f"{kind}_exchanger", given, UA=UA))
        found = hb.simulate(m, until=0.1)["wall.heat"].at(0)
        assert found == pytest.approx(7000 * part_of, rel=1e-4)
    # where both streams are nearly alike a quotient of small differences is replaced by its series
    last = 0.0
    for more in (0.0, 1e-9, 9.9e-5, 1.1e-4, 1e-3):
        given = {"flow_hot": 100, "flow_cold": 100 * (1 + more)}
        (m, *_) = between(360.0, 290.0, part(f"{kind}_exchanger", given, UA=100))
        heat = float(hb.simulate(m, until=0.1)["wall.heat"].at(0))
        c = 1 / (1 + more)
        if kind == "counterflow":
            z = 1 - c
            e = 0.5 if more == 0 else -math.expm1(-z) / (z - c * math.expm1(-z))
        else:
            e = -math.expm1(-(1 + c)) / (1 + c)
        assert heat == pytest.approx(7000 * e, rel=1e-11)
        assert heat >= last - 1e-9
        last = heat
