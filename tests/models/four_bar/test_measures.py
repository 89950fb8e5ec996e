"""Measures of crank-rockers: closed forms, the rig, and a position solver of the tests."""

import itertools

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.models.four_bar import grashof_class
from erlif.models.four_bar.measures import (
    Links,
    least_transmission,
    rocker_limits,
    rocker_rates,
    space,
    speed_ratio,
    stroke_excess,
    swept_box,
    swing,
    transmission_limits,
)

RIG = Links(0.055, 0.44, 0.26, 0.51)  # Farzaneh (2002), appendix A.2


def test_transmission_angle_is_extreme_with_the_crank_in_line(solver, draw_linkage):
    rng = np.random.default_rng(3)
    for _ in range(20):
        links = Links(*draw_linkage(rng))
        one = solver(links)

        def angle(crank_angle, one=one):
            pin = one.rocker_pin(crank_angle)
            return np.abs(
                np.angle((one.crank * np.exp(1j * crank_angle) - pin) / (one.ground - pin))
            )

        found = [angle(np.array(t)) for t in (0.0, np.pi)]
        npt.assert_allclose(transmission_limits(links), found, rtol=1e-12)
        everywhere = angle(np.linspace(0, 2 * np.pi, 400))
        assert found[0] - 1e-12 <= everywhere.min()
        assert everywhere.max() <= found[1] + 1e-12
        npt.assert_allclose(least_transmission(links), min(found[0], np.pi - found[1]))


def test_measures_are_those_of_the_positions(solver, draw_linkage):
    rng = np.random.default_rng(4)
    for _ in range(20):
        links = Links(*draw_linkage(rng))
        one = solver(links)
        npt.assert_allclose(swing(links), one.swing(), rtol=1e-11)
        part = (np.pi + stroke_excess(links)) / (2 * np.pi)
        npt.assert_allclose(part, one.rising_part(), atol=1e-6)
        fastest = max(speed_ratio(links, rising=up) for up in (True, False))
        npt.assert_allclose(fastest, one.speed_ratio(), rtol=1e-9)
        angle = rng.uniform(0, 2 * np.pi)
        rate, second = rocker_rates(links, angle)
        npt.assert_allclose(rate, one.speed(angle), atol=1e-10)
        step = 1e-4
        slope = (one.speed(angle + step) - one.speed(angle - step)) / (2 * step)
        npt.assert_allclose(second, slope, atol=1e-5 * (1 + abs(slope)))
        turn = np.linspace(0, 2 * np.pi, 2001)
        pins = np.concatenate([one.rocker_pin(turn), one.crank * np.exp(1j * turn), [one.ground]])
        npt.assert_allclose(space(links), [np.ptp(pins.real), np.ptp(pins.imag)], rtol=1e-4)


def test_the_space_of_wide_links_holds_their_outline(solver, draw_linkage):
    """Discs of half of the width, drawn along all links at 721 positions."""
    rng = np.random.default_rng(5)
    disc = np.exp(1j * np.linspace(0, 2 * np.pi, 33))
    part = np.linspace(0, 1, 9)
    for _ in range(5):
        links = Links(*draw_linkage(rng))
        width = rng.uniform(0.05, 0.6) * links.ground
        one, turn = solver(links), np.linspace(0, 2 * np.pi, 721)
        pin = one.crank * np.exp(1j * turn)
        joints = (0 * pin, pin, one.rocker_pin(turn), 0 * pin + one.ground)
        centres = [a + part[:, None] * (b - a) for a, b in itertools.pairwise(joints)]
        outline = np.add.outer(width / 2 * disc, np.concatenate(centres).ravel())
        sides = [np.ptp(outline.real), np.ptp(outline.imag)]
        npt.assert_allclose(space(links, width), sides, rtol=2e-4)
        left, _, bottom, _ = swept_box(links, width)
        corner = [outline.real.min(), outline.imag.min()]
        npt.assert_allclose([left, bottom], corner, atol=2e-4 * links.ground)


def test_arrays_give_what_single_linkages_give(draw_linkage):
    rng = np.random.default_rng(6)
    rows = np.array([draw_linkage(rng) for _ in range(10)])
    together = [speed_ratio(Links(*rows.T), rising=up) for up in (True, False)]
    alone = [[speed_ratio(Links(*row), rising=up) for row in rows] for up in (True, False)]
    npt.assert_allclose(together, alone, rtol=1e-8)


def test_numbers_of_the_rig():  # derived apart from this code, with two other programs
    npt.assert_allclose(np.degrees(rocker_limits(RIG)), [47.4095, 71.8355], atol=5e-5)
    npt.assert_allclose(np.degrees(swing(RIG)), 24.4260, atol=5e-5)
    npt.assert_allclose(np.degrees(stroke_excess(RIG)), 0.1253, atol=5e-5)
    npt.assert_allclose(np.degrees(transmission_limits(RIG)), [76.30, 104.69], atol=5e-3)
    speeds = [114 * np.pi / 30 * speed_ratio(RIG, rising=up) for up in (True, False)]
    npt.assert_allclose(speeds, [2.552104, 2.540492], rtol=1e-6)
    # crank circle to rocker pivot; upper end of the arc of the rocker pin
    across = 0.055 + 0.26 * np.sin(np.radians(71.8355))
    npt.assert_allclose(space(RIG), [0.055 + 0.51, across], rtol=1e-6)


@pytest.mark.parametrize(
    ("lengths", "kind"),
    [
        ((1, 3, 3, 4), "crank-rocker"),
        ((3, 1, 3, 4), "double-rocker"),
        ((3, 3, 1, 4), "rocker-crank"),
        ((3, 4, 3, 1), "double-crank"),
        ((2, 3, 3, 5), "triple-rocker"),
        ((1, 2, 3, 4), "change point"),
        ((0.1, 0.2, 0.4, 0.5), "change point"),
        ((2, 2, 2, 2), "change point"),
    ],
)
def test_grashof_classes(lengths, kind):
    names = ("crank", "coupler", "rocker", "ground")
    assert grashof_class(**dict(zip(names, lengths, strict=True))) == kind


@pytest.mark.parametrize("lengths", [(1, 1, 1, 4), (1, 1, 1, 3), (9, 1, 2, 3)])
def test_links_that_cannot_be_joined_are_of_no_class(lengths):
    names = ("crank", "coupler", "rocker", "ground")
    with pytest.raises(ModelError, match="can be joined"):
        grashof_class(**dict(zip(names, lengths, strict=True)))
