"""Magnetic parts against closed forms, with the bonds at their ports drawn in both directions."""

import math

import numpy as np
import pytest
from library.bench import every_way

import hybond as hb

MU_0 = 1.25663706212e-6


def part(name: str, inputs: dict[str, object] | None = None, **parameters: object) -> hb.Submodel:
    return hb.Submodel(f"magnetic.{name}", inputs=inputs, **parameters)


def driven(source: object, R: float = 0.0, **parts: object) -> hb.Model:
    """A coil of 200 turns at a source, its minus grounded, and the ground of its magnetic path."""
    m = hb.Model("magnet", domain="magnetic")
    m.add(
        source=source,
        wire=hb.One(domain="electrical"),
        copper=hb.R(R, domain="electrical"),
        node=hb.Zero(domain="electrical"),
        coil=part("coil", N=200),
        earth=hb.Se(0, domain="electrical"),
        ground=part("ground"),
        **parts,
    )
    m.bond("source -> wire -> node", "wire -> copper", "earth -> coil.minus")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("R", [1.0, 8.0])
def test_a_coil_on_a_core_is_an_inductance_of_its_turns_squared_times_the_permeance(R):
    """``"magnetic.coil"``, ``"magnetic.core"``, ``"magnetic.ground"``: a step of voltage."""
    L = 200**2 * MU_0 * 2000 * 1e-4 / 0.1
    m = driven(hb.Se("12 V", domain="electrical"), R, core=part("core"))
    for way in every_way(
        m,
        "node - coil.plus",
        "coil.north - core.north",
        "core.south - coil.south",
        "ground.port - coil.south",
    ):
        run = hb.simulate(way, until=3 * L / R, rtol=1e-9)
        t = np.linspace(0, 3 * L / R, 7)
        current = 12 / R * (1 - np.exp(-R / L * t))
        assert run["coil.current"].at(t) == pytest.approx(current, rel=1e-7, abs=1e-9)
        assert run["core.flux"].at(t) == pytest.approx(L * current / 200, rel=1e-7, abs=1e-12)
        assert run["coil.mmf"].at(t) == pytest.approx(200 * current, rel=1e-7, abs=1e-6)
        assert run["coil.voltage"].at(t) == pytest.approx(12 - R * current, rel=1e-6, abs=1e-6)
        assert run["core.B"].at(t) == pytest.approx(run["core.flux"].at(t) / 1e-4)
        units = [run[n].unit for n in ("core.flux", "core.B", "core.mmf", "coil.rate")]
        assert units == ["V*s", "T", "A", "V"]
        assert run.audit().holds(1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("gap", ["1 mm", "0.2 mm"])
def test_reluctances_add_in_a_row_and_permeances_side_by_side(gap):
    """``"magnetic.air_gap"``, ``"magnetic.leakage"``: what a step of current rate meets."""
    length = float(gap.split()[0]) * 1e-3
    path = 1 / (0.1 / (MU_0 * 2000 * 1e-4) + length / (MU_0 * 1e-4))
    L = 200**2 * (path + 3e-8)
    m = driven(
        hb.Se("2 V", domain="electrical"),
        core=part("core"),
        gap=part("air_gap", length=gap),
        beside=part("leakage", P="3e-8 H"),
    )
    m.bond("node -> coil.plus", "ground.port -> coil.south")
    for way in every_way(
        m,
        "coil.north - core.north",
        "core.south - gap.north",
        "gap.south - coil.south",
        "coil.north - beside.north",
        "beside.south - coil.south",
    ):
        run = hb.simulate(way, until=0.01, rtol=1e-9)
        assert run["coil.current"].at(0.01) == pytest.approx(2 * 0.01 / L, rel=1e-9)
        flux = 200 * 2 * 0.01 / L * path
        assert run["gap.flux"].at(0.01) == pytest.approx(flux, rel=1e-9)
        assert run["gap.flux"].at(0.01) == pytest.approx(run["core.flux"].at(0.01))
        assert run["gap.force"].at(0.01) == pytest.approx(flux**2 / (2 * MU_0 * 1e-4))
        both = run["gap.flux"].at(0.01) + run["beside.flux"].at(0.01)
        assert both == pytest.approx(2 * 0.01 / 200)


def test_two_coils_on_a_core_are_a_transformer():
    """Voltages by turns, and currents against each other where the core takes no field."""
    m = driven(hb.Se("10 V*cos(300*time/(1 s))", domain="electrical"), core=part("core", mu_r=1e9))
    m.add(
        second=part("coil", N=50),
        load=hb.R("5 ohm", domain="electrical"),
        loop=hb.One(domain="electrical"),
        low=hb.Zero(domain="electrical"),
        zero=hb.Se(0, domain="electrical"),
    )
    m.bond("second.plus -> loop -> low", "loop -> load", "zero -> low", "low -> second.minus")
    m.bond("node -> coil.plus", "ground.port -> coil.south")
    for way in every_way(
        m, "coil.north - core.north", "core.south - second.south", "second.north - coil.south"
    ):
        run = hb.simulate(way, until=0.02, rtol=1e-8)
        t = np.linspace(0.002, 0.02, 5)
        # north of one coil is joined to the core, south of the other: the flux leaves both
        # through their norths, or enters both
        second = run["second.voltage"].at(t)
        assert second == pytest.approx(10 * np.cos(300 * t) * 50 / 200, rel=1e-6)
        assert run["coil.current"].at(t) == pytest.approx(second / 5 * 50 / 200, rel=1e-3)


@pytest.mark.parametrize("n", [5, 9])
def test_a_core_that_saturates_takes_ever_more_current_at_a_constant_voltage(n):
    """``"magnetic.saturating_core"``: the flux is a ramp, and the current follows the law."""
    m = driven(hb.Se("12 V", domain="electrical"), iron=part("saturating_core", n=n))
    m.bond("node -> coil.plus", "ground.port -> coil.south")
    for way in every_way(m, "coil.north - iron.north", "iron.south - coil.south"):
        # short steps: the flux is linear in time, what is supplied is not
        run = hb.simulate(way, until=4e-3, rtol=1e-9, max_step=1e-4)
        t = np.linspace(0, 4e-3, 9)
        B = 12 / 200 * t / 1e-4
        H = B / (MU_0 * 2000) * (1 + (B / 1.5) ** (n - 1))
        assert run["iron.B"].at(t) == pytest.approx(B, rel=1e-9, abs=1e-12)
        assert run["coil.current"].at(t) == pytest.approx(H * 0.1 / 200, rel=1e-7, abs=1e-9)
        assert run["iron.H"].at(t) == pytest.approx(H, rel=1e-7, abs=1e-6)
        assert B[-1] > 1.5
        assert run.audit().holds(1e-8)


@pytest.mark.parametrize("gap", [2e-3, 5e-4])
def test_a_magnet_drives_flux_through_a_gap_on_its_straight_line(gap):
    """``"magnetic.permanent_magnet"``: B = B_r/(1 + mu_r*gap/length) for one cross-section."""
    m = hb.Model("magnet", domain="magnetic")
    m.add(magnet=part("permanent_magnet"), gap=part("air_gap", length=gap), ground=part("ground"))
    for way in every_way(
        m, "magnet.north - gap.north", "gap.south - magnet.south", "ground.port - gap.south"
    ):
        run = hb.simulate(way, until=1.0)
        B = 1.2 / (1 + 1.05 * gap / 0.01)
        assert run["magnet.B"].at(0.5) == pytest.approx(B)
        assert run["gap.B"].at(0.5) == pytest.approx(B)
        # the field in the magnet is against its flux
        assert run["magnet.mmf"].at(0.5) == pytest.approx((1.2 - B) * 0.01 / (MU_0 * 1.05))


def test_eddy_currents_hold_the_flux_back():
    """``"magnetic.loss"``: flux follows the magnetomotive force with the time constant G*P."""
    G, P = 40.0, MU_0 * 2000 * 1e-4 / 0.1
    m = driven(hb.Sf("0.5 A", domain="electrical"), core=part("core"), eddy=part("loss", G=G))
    m.bond("node -> coil.plus", "ground.port -> coil.south")
    for way in every_way(
        m, "coil.north - core.north", "core.south - eddy.north", "eddy.south - coil.south"
    ):
        run = hb.simulate(way, until=3 * G * P, rtol=1e-9)
        t = np.linspace(0, 3 * G * P, 5)
        flux = 100 * P * (1 - np.exp(-t / (G * P)))
        assert run["core.flux"].at(t) == pytest.approx(flux, rel=1e-7, abs=1e-12)
        rate = 100 / G * np.exp(-t / (G * P))
        assert run["eddy.power"].at(t) == pytest.approx(G * rate**2, rel=1e-6)


def lifted(source: object, **parameters: object) -> hb.Model:
    """An armature of 0.1 kg before a coil."""
    m = driven(source, gap=part("moving_gap", gap_0="2 mm", **parameters))
    m.add(
        armature=hb.One(domain="translational"),
        mass=hb.I("0.1 kg", domain="translational"),
    )
    m.bond("armature -> mass", "ground.port -> coil.south")
    return m


def test_a_coil_that_is_shorted_keeps_its_flux_and_pulls_with_a_constant_force():
    """``"magnetic.moving_gap"``: a free fall, with the force of Maxwell."""
    flux = 2e-5
    force = flux**2 / (2 * MU_0 * 1e-4)
    m = lifted(hb.Se(0, domain="electrical"), flux_0=flux)
    for way in every_way(
        m,
        "node - coil.plus",
        "coil.north - gap.north",
        "gap.south - coil.south",
        "armature - gap.mover",
    ):
        run = hb.simulate(way, until=0.01, rtol=1e-9)
        t = np.linspace(0, 0.01, 5)
        way_back = force / 0.1 * t**2 / 2
        assert run["gap.force"].at(t) == pytest.approx(np.full(5, -force))
        assert run["gap.gap"].at(t) == pytest.approx(2e-3 - way_back, rel=1e-8)
        assert run["gap.flux"].at(t) == pytest.approx(np.full(5, flux))
        assert run["coil.current"].at(t) == pytest.approx(
            flux * (2e-3 - way_back) / (MU_0 * 1e-4) / 200
        )
        assert [run[n].unit for n in ("gap.gap", "gap.force", "gap.flux")] == ["m", "N", "V*s"]


@pytest.mark.slow
def test_what_a_source_of_current_gives_goes_half_into_the_field_and_half_into_the_armature():
    m = lifted(hb.Sf("0.5 A", domain="electrical"))
    for way in every_way(m, "node - coil.plus", "coil.north - gap.north", "armature - gap.mover"):
        way.bond("gap.south -> coil.south")
        run = hb.simulate(way, until=0.02, rtol=1e-10)
        x = run["gap.gap"].at(0.02)
        assert 2e-4 < x < 1.9e-3
        assert run["gap.force"].at(0.02) == pytest.approx(-MU_0 * 1e-4 * (100 / x) ** 2 / 2)
        # the field holds half of N*i*flux; the armature has as much as the field has gained
        gained = MU_0 * 1e-4 * 100**2 / 2 * (1 / x - 1 / 2e-3)
        speed = run["armature.f"].at(0.02)
        assert 0.1 * speed**2 / 2 == pytest.approx(gained, rel=1e-7)
        assert run.audit().holds(1e-8)
        assert math.isclose(run["gap.B"].at(0.02), MU_0 * 100 / x, rel_tol=1e-9)
