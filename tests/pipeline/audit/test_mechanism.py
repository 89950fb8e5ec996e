"""Kind of a mechanism and zero of its angle by films of a known speed."""

from types import SimpleNamespace

import numpy as np
import pytest

from erlif.io.settings import CrankRockerSettings, EncoderSettings, RunSettings, SliderCrankSettings
from erlif.models.mechanism import CrankRocker
from erlif.pipeline.audit.film_order import LEFT, is_better
from erlif.pipeline.audit.mechanism import Motion, fit_zero, note_mechanism

SLIDER = Motion("drive", np.cos, 180.0)


def find_zero(angle, film, motion):
    fit = fit_zero(angle, np.ones(angle.size), film, motion)
    return fit.off if fit.left < LEFT and is_better(film, fit.plain, fit.left) else None


@pytest.mark.parametrize("off", [-60.0, -20.0, 8.0, 45.0])
def test_the_zero_of_a_drive_is_found_by_a_film_that_follows_the_speed(off):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film = np.abs(np.cos(angle)) ** 0.6 + 0.02 * np.random.default_rng(4).normal(size=90)
    found = find_zero(angle - np.radians(off), film, SLIDER)
    assert found == pytest.approx(off, abs=2)
    assert find_zero(angle, film, SLIDER) is None


@pytest.mark.parametrize("memory", [2.0, 6.0])
def test_a_film_that_squeeze_delays_has_no_other_zero(memory):
    angle = np.linspace(0.1, 6 * np.pi, 90)
    film, step = np.abs(np.cos(angle)), 1 - np.exp(-1 / memory)
    for k in range(1, 90):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    film += 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=90)
    assert find_zero(angle, film, SLIDER) is None


def pin_speed(angle):
    """Of a crank of 16 and a rod of 44 cm, over that of the crank."""
    ratio = 16 / 44
    return 1 + ratio * np.cos(angle) / np.sqrt(1 - (ratio * np.sin(angle)) ** 2)


PIN = Motion("crank", pin_speed)


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
    found = find_zero(angle - np.radians(off), pin_film(angle), PIN)
    assert (found - off + 180) % 360 - 180 == pytest.approx(0, abs=5)


LINKS = {"crank": "16 cm", "coupler": "44 cm", "crank_speed": "114 rpm"}
SLIDER_CRANK = SliderCrankSettings(kind="slider-crank", **LINKS)
ROCKER = CrankRockerSettings(kind="crank-rocker", **LINKS, rocker="60 cm", ground="65 cm")


def notes_of(angle, film, stated, *, mounted_on="crank", ordered=True, load=None):
    """Warnings about a film and the angles in its log, with the encoder on the crank."""
    encoder = EncoderSettings(mounted_on=mounted_on)
    settings = RunSettings.model_construct(mechanism=stated, encoder=encoder)
    one = SimpleNamespace(
        order=(None, np.array([], int)) if ordered else None,
        levels=film,
        logged={"crank_angle": np.degrees(angle), "joint_load": load}.get,
        run=SimpleNamespace(settings=settings),
    )
    return [note.text for note in note_mechanism(one)]


@pytest.mark.parametrize("off", [0.0, 180.0])
def test_a_crank_that_is_half_a_turn_off_is_named(off):
    angle = np.linspace(0.1, 4 * np.pi, 50)
    found = notes_of(angle + np.radians(off), pin_film(angle), SLIDER_CRANK)
    assert len(found) == (off > 0)
    assert all("a crank angle -180 deg off" in text for text in found)


@pytest.mark.parametrize(
    "load", [np.linspace(0.4, 1.8, 40), np.repeat([1.0, 2.0, 0.7], 14)[:40]], ids=["ramp", "steps"]
)
def test_a_film_that_does_not_follow_its_load_has_no_other_zero(load):
    angle = np.linspace(0.1, 2 * np.pi, 40)
    assert not notes_of(angle, pin_film(angle), SLIDER_CRANK, load=222 * load)
    assert notes_of(angle + np.pi, pin_film(angle), SLIDER_CRANK, load=np.full(40, 222.0))


def rocker_film(angle, memory=0.0):
    """As `pin_film`, of the rocker of `ROCKER`."""
    links = CrankRocker(ROCKER.crank, ROCKER.coupler, ROCKER.rocker, ROCKER.ground)
    film = np.abs(links.rocker_speed(angle, crank_speed=1.0)) ** 0.6
    step = 1 - np.exp(-1 / memory) if memory else 1.0
    for k in range(1, film.size):
        film[k] = film[k - 1] + step * (film[k] - film[k - 1])
    return film + 0.02 * np.ptp(film) * np.random.default_rng(4).normal(size=film.size)


@pytest.mark.parametrize("ordered", [True, False])
@pytest.mark.parametrize("off", [0.0, 0.5])
@pytest.mark.parametrize(
    ("film", "stated", "true"),
    [(pin_film, ROCKER, "slider-crank"), (rocker_film, SLIDER_CRANK, "crank-rocker")],
)
def test_the_other_kind_of_linkage_is_named(film, stated, true, off, ordered):
    angle = np.linspace(0.1, 4 * np.pi, 60)
    (found,) = notes_of(angle + off, film(angle), stated, ordered=ordered)
    assert f"follows the speed of a {true} " in found


@pytest.mark.parametrize("memory", [0.0, 2.0, 6.0, 25.0])
@pytest.mark.parametrize(("film", "stated"), [(pin_film, SLIDER_CRANK), (rocker_film, ROCKER)])
def test_a_film_that_squeeze_delays_is_not_of_another_kind(film, stated, memory):
    angle = np.linspace(0.1, 4 * np.pi, 60)
    assert not notes_of(angle, film(angle, memory), stated)


@pytest.mark.parametrize("off", [-90.0, -30.0, 20.0, 90.0])
def test_the_zero_of_the_crank_of_a_rocker_is_named(off):
    """On the rocker itself, the reach of the linkage shows it."""
    angle = np.linspace(0.1, 4 * np.pi, 80)
    film = rocker_film(angle)
    (found,) = notes_of(angle - np.radians(off), film, ROCKER)
    assert float(found.split(" deg off")[0].split()[-1]) == pytest.approx(off, abs=4)
    assert not notes_of(angle - np.radians(off), film, ROCKER, mounted_on="rocker")


@pytest.mark.parametrize("memory", [0.0, 2.0, 6.0, 25.0])
def test_a_film_that_follows_the_crank_pin_late_has_no_other_zero(memory):
    angle = np.linspace(0.1, 4 * np.pi, 80)
    assert find_zero(angle, pin_film(angle, memory), PIN) is None
