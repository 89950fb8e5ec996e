"""Films of given shape against closed forms and published values."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.reynolds import pin_shape, roller_shape, solve_film

VISCOSITY = 0.1  # Pa s


def cells(number):
    """Middles of equal cells from 0 to 1."""
    return (np.arange(number) + 0.5) / number


def test_parabolic_slider_with_conserved_oil():
    """Closed form with Jakobsson, Floberg and Olsson's rupture, inlet and outlet at ambient."""
    film = 25.4e-6 * (1 + (2 * cells(400) - 1) ** 2)
    found = solve_film(
        film, length=0.0762, viscosity=0.039, entrainment=4.57 / 2, cavitation_pressure=0.0
    )
    npt.assert_allclose(found.peak_pressure, 3.591787e6, rtol=5e-5)
    npt.assert_allclose(found.force, 101.3495e3, rtol=5e-5)
    npt.assert_allclose(float(found.pressure.idxmax()) / 0.0762, 0.3210656, atol=1 / 400)
    rupture = float(found.x[found.void_fraction > 0][0]) / 0.0762
    npt.assert_allclose(rupture, 0.6789344, atol=1 / 400)


def test_oscillating_plates_open_and_close_a_cavity():
    """h = 20 + 15 (1 - cos 2 pi t/T) um: rupture, largest cavity and its end, closed form."""
    number, steps, period = 200, 800, 0.05
    time = np.linspace(0.0, 0.9, int(0.9 * steps) + 1) * period
    film = 20e-6 + 15e-6 * (1 - np.cos(2 * np.pi * time / period))
    found = solve_film(
        film[:, np.newaxis] * np.ones(number), length=0.02, viscosity=VISCOSITY, time=time
    )
    share = (found.void_fraction > 0).mean("x").values
    npt.assert_allclose(time[share > 0][0] / period, 0.00112586, atol=1.5 / steps)
    npt.assert_allclose(share.max(), 0.866324, atol=1.5 * 2 / number)
    npt.assert_allclose(time[share > 0][-1] / period, 0.87412, atol=1.5 / steps)
    lost = float((found.side_flow[1:] * np.diff(time)).sum())
    gained = float(found.oil_volume[-1] - found.oil_volume[0])
    npt.assert_allclose(gained, -lost, atol=1e-10 * float(found.oil_volume[0]))


def test_roller_on_flat_carries_martins_load():
    """Martin (1916): W = 4.894968 eta u R / h0 per length, flooded, rupture at p = dp/dx = 0."""
    radius, least, reach = 0.01, 1e-6, 40
    length = 2 * reach * np.sqrt(2 * radius * least)
    x = (cells(6400) - 0.5) * length
    found = solve_film(
        least + roller_shape(x, radius=radius),
        length=length,
        viscosity=VISCOSITY,
        entrainment=0.5,
        cavitation_pressure=0.0,
    )
    # the inlet at 40 sqrt(2 R h0) in place of infinity takes 0.1 % of the load
    load = float(found.force) * least / (VISCOSITY * 0.5 * radius)
    npt.assert_allclose(load, 4.894968, rtol=2e-3)
    edge = float(x[found.void_fraction.values > 0][0]) / np.sqrt(2 * radius * least)
    npt.assert_allclose(edge, 0.475129920, atol=0.02)


def test_ball_on_disc_without_rupture():
    """p = -12/5 eta u x / h^2 solves the full film between a ball and a flat (Kapitza 1955)."""
    radius, least, reach = 0.01, 1e-6, 12
    length = 2 * reach * np.sqrt(2 * radius * least)
    x = (cells(96) - 0.5) * length
    film = least + pin_shape(x[:, np.newaxis], x, radius=radius, cross_radius=radius)
    found = solve_film(
        film,
        length=length,
        width=length,
        viscosity=VISCOSITY,
        entrainment=0.5,
        cavitation_pressure=-1e12,
    )
    wanted = -12 / 5 * VISCOSITY * 0.5 * x[:, np.newaxis] / film**2
    npt.assert_allclose(found.pressure, wanted, atol=0.015 * wanted.max())


def test_square_plates_squeezed_and_drawn_apart():
    """W = 0.421732 eta L^4 V / h^3, from the torsion constant of a square."""
    film, size, speed = np.full((40, 40), 1e-5), 0.01, 1e-4
    case = {"length": size, "width": size, "viscosity": VISCOSITY}
    found = solve_film(film, film_rate=np.full((40, 40), -speed), **case)
    npt.assert_allclose(found.force, 0.421732 * VISCOSITY * size**4 * speed / 1e-15, rtol=3e-3)
    apart = solve_film(film, film_rate=np.full((40, 40), speed), cavitation_pressure=-3e3, **case)
    npt.assert_allclose(apart.pressure.min(), -3e3)
    assert float(apart.force) > -float(found.force)


def test_plane_slider_has_petroffs_limit_and_balances_its_work():
    film = 1e-5 * (1.2 - 0.2 * cells(100))
    found = solve_film(film, length=0.1, viscosity=VISCOSITY, entrainment=0.5)
    # h0 = 1.1e-5 on average: friction of parallel plates plus a small part of the wedge
    npt.assert_allclose(found.friction_force, VISCOSITY * 1.0 * 0.1 / 1.1e-5, rtol=0.02)
    npt.assert_allclose(found.power, found.friction_force * 1.0, rtol=1e-3)


def test_piezoviscous_slider_follows_the_reduced_pressure():
    """Pressure rises to -ln(1 - alpha q) / alpha of the isoviscous pressure q (Grubin 1949)."""
    film = 4e-6 * (2.2 - 1.2 * cells(100))
    case = {"length": 0.01, "viscosity": VISCOSITY, "entrainment": 0.5}
    thin = solve_film(film, **case)
    thick = solve_film(film, pressure_viscosity=2e-8, **case)
    wanted = -np.log1p(-2e-8 * thin.pressure) / 2e-8
    npt.assert_allclose(thick.pressure, wanted, rtol=1e-6)
    assert float(thick.peak_pressure) > 1.1 * float(thin.peak_pressure)
    with pytest.raises(ModelError, match="without bound"):
        solve_film(film / 2, pressure_viscosity=2e-8, **case)


def test_thin_film_on_a_soft_liner_has_the_pressure_of_dry_contact():
    """Winkler: p0 = k b^2 / (2 R) with b^3 = 3 W R / (2 k) per width (Johnson 1985)."""
    radius, foundation, load = 4.87, 1e11, 1e5
    width = (3 * load * radius / (2 * foundation)) ** (1 / 3)
    dry = foundation * width**2 / (2 * radius)
    x = (cells(256) - 0.5) * 8 * width
    peaks = []
    for speed in (0.1, 0.01):
        found = solve_film(
            1e-5 + roller_shape(x, radius=radius),
            length=8 * width,
            viscosity=VISCOSITY,
            entrainment=speed,
            load=load,
            foundation=foundation,
            cavitation_pressure=0.0,
        )
        peaks.append(float(found.peak_pressure) / dry)
        npt.assert_allclose(found.force, load, rtol=1e-6)

    # the film of 2 um under a deflection of 38 um; a thicker one spreads the load
    assert float(found.film.min()) < 2e-6
    npt.assert_allclose(peaks[1], 1.0, atol=0.02)
    assert peaks[0] < 0.95
    inside = np.abs(x) < 0.9 * width
    parabola = dry * (1 - (x / width) ** 2)
    npt.assert_allclose(found.pressure.values[inside], parabola[inside], atol=0.05 * dry)


def test_a_cavity_from_before_carries_nothing():
    """Plates that approach: with a cavity over one half, the other is a strip of half the width.

    Its peak is 6 eta V a^2/h^3, with a quarter of the length as a; Reynolds (1886).
    """
    film, void = np.full(200, 20e-6), np.where(cells(200) < 0.5, 0.3, 0.0)
    case = {"length": 0.04, "viscosity": VISCOSITY, "film_rate": np.full(200, -1e-4)}
    found = solve_film(film, void_fraction=void, cavitation_pressure=0.0, **case)
    form = 6 * VISCOSITY * 1e-4 * 0.01**2 / 20e-6**3
    npt.assert_allclose(found.peak_pressure, form, rtol=0.02)
    npt.assert_allclose(found.pressure[:99], 0.0, atol=1e-6 * form)
    npt.assert_allclose(found.void_fraction[:99], 0.3, rtol=1e-4)
    whole = solve_film(film, void_fraction=0 * void, cavitation_pressure=0.0, **case)
    npt.assert_allclose(whole.peak_pressure, 4 * form, rtol=1e-3)
