"""Zero of the angle by films of a known speed."""

from types import SimpleNamespace

import numpy as np
import pytest

from erlif.io.settings import SliderCrankSettings
from erlif.pipeline.audit.zero import find_zero, note_zero

SLIDER = {"speed": lambda angle: np.abs(np.cos(angle)), "period": 180.0}


@pytest.mark.parametrize("off", [-60.0, -20.0, 8.0, 45.0])
def test_the_zero_of_a_drive_is_found_by_a_film_that_follows_the_speed(off):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film = np.abs(np.cos(angle)) ** 0.6 + 0.02 * np.random.default_rng(4).normal(size=90)
    found = find_zero(angle - np.radians(off), np.ones(90), film, **SLIDER)
    assert found == pytest.approx(off, abs=2)
    assert find_zero(angle, np.ones(90), film, **SLIDER) is None


@pytest.mark.parametrize("memory", [2.0, 6.0])
def test_a_film_that_squeeze_delays_has_no_other_zero(memory):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film, step = np.abs(np.cos(angle)), 1 - np.exp(-1 / memory)
    for k in range(1, 90):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    film += 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=90)
    assert find_zero(angle, np.ones(90), film, **SLIDER) is None


def pin_speed(angle):
    """Of a crank of 16 and a rod of 44 cm, over that of the crank."""
    ratio = 16 / 44
    return 1 + ratio * np.cos(angle) / np.sqrt(1 - (ratio * np.sin(angle)) ** 2)


PIN = {"speed": pin_speed, "period": 360.0}


def pin_film(angle, memory=0.0):
    """A power of the speed, or one that follows it with a delay of so many frames."""
    film = pin_speed(angle) ** 0.6
    step = 1 - np.exp(-1 / memory) if memory else 1.0
    for k in range(1, film.size):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    return film + 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=film.size)


@pytest.mark.parametrize("off", [-150.0, 20.0, 40.0, 179.0])
def test_the_zero_of_a_crank_is_found_where_the_film_would_lead_its_speed_or_fall(off):
    angle = np.linspace(0.1, 4 * np.pi, 80)
    found = find_zero(angle - np.radians(off), np.ones(80), pin_film(angle), **PIN)
    assert (found - off + 180) % 360 - 180 == pytest.approx(0, abs=5)


@pytest.mark.parametrize("off", [0.0, 180.0])
def test_a_crank_that_is_half_a_turn_off_is_named(off):
    angle = np.linspace(0.1, 4 * np.pi, 50)
    columns = {
        "crank_angle": np.degrees(angle) + off,
        "rocker_speed": pin_speed(angle + np.radians(off)),
    }
    one = SimpleNamespace(
        order=(None, np.array([], int)), levels=pin_film(angle), logged=columns.get
    )
    links = {"crank": "16 cm", "coupler": "44 cm", "crank_speed": "114 rpm"}
    one.run = SimpleNamespace(
        settings=SimpleNamespace(mechanism=SliderCrankSettings(kind="slider-crank", **links))
    )
    found = [note.text for note in note_zero(one)]
    assert len(found) == (off > 0)
    assert all("a crank angle -180 deg off" in text for text in found)


@pytest.mark.parametrize("memory", [0.0, 2.0, 6.0, 25.0])
def test_a_film_that_follows_the_crank_pin_late_has_no_other_zero(memory):
    angle = np.linspace(0.1, 4 * np.pi, 80)
    assert find_zero(angle, np.ones(80), pin_film(angle, memory), **PIN) is None
