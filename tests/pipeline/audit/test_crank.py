"""Readings of an encoder against a crank that turns evenly."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scenes.linkage import OMEGA, link_angles, locate, make_log

from erlif.core.errors import ModelError
from erlif.io.settings import CrankRockerSettings, SliderCrankSettings
from erlif.models.mechanism import CrankRocker, SliderCrank
from erlif.pipeline.audit.crank import find_odd, find_slips, note_crank
from erlif.pipeline.audit.evidence import Evidence

TIME = np.linspace(0, 2 * math.pi / OMEGA, 50, endpoint=False)
ROCKER = np.degrees([link_angles(OMEGA * t + 0.7)[0] for t in TIME])
CRANK = np.degrees(OMEGA * TIME + 0.7) % 360


def run_of(log, mounted, crank=0.055):
    lengths = {"crank": crank, "coupler": 0.44, "rocker": 0.26, "ground": 0.51}
    links = CrankRockerSettings.model_construct(kind="crank-rocker", **lengths, crank_speed=OMEGA)
    encoder = SimpleNamespace(mounted_on=mounted, zero=None)
    return SimpleNamespace(log=log, settings=SimpleNamespace(linkage=links, encoder=encoder))


def notes(angle, *, mounted="rocker", crank=0.055, time=TIME, noise=0.01):
    """Notes on a log of readings with the noise of an encoder."""
    angle = angle + noise * np.random.default_rng(2).normal(size=angle.size)
    log = make_log(angle, **({} if time is None else {"time": time}))
    located = locate(
        log.assign(angle=log.angle if mounted == "rocker" else log.angle % 360),
        mechanism=CrankRocker(crank, 0.44, 0.26, 0.51),
        mounted_on=mounted,
        zero=0.0 if mounted == "rocker" else None,
    )
    return list(note_crank(Evidence(run_of(log, mounted, crank), located, ())))


def inside(angle, change=0.0):
    """Readings that stay within the reach of the linkage."""
    return np.clip(angle + change, 47.45, 71.8)


@pytest.mark.parametrize("mounted", ["rocker", "crank"])
@pytest.mark.parametrize("digits", [6, 3])
def test_an_even_turn_has_no_note(mounted, digits):
    angle = inside(ROCKER) if mounted == "rocker" else CRANK
    assert notes(angle, mounted=mounted, time=np.round(TIME, digits)) == []


@pytest.mark.parametrize(("ticks", "step"), [(360, 0.96), (360, 0.97), (400, 0.87), (300, 1.15)])
def test_an_encoder_of_few_ticks_has_no_note_in_an_even_turn(ticks, step):
    """Pulses at even steps of the rocker, which beat with the ticks."""
    time = TIME[ROCKER.argmin()] + np.linspace(0.01, 0.45, 1000) * 2 * math.pi / OMEGA
    stroke = np.degrees([link_angles(OMEGA * t + 0.7)[0] for t in time])
    angle = np.arange(stroke[0], stroke[-1], step)
    ticks_read = np.round((angle - angle[0]) * ticks / 360)
    log = make_log(ticks_read * 360 / ticks, time=np.interp(angle, stroke, time))
    located = locate(log, mechanism=CrankRocker(0.055, 0.44, 0.26, 0.51), zero=None)
    assert list(note_crank(Evidence(run_of(log, "rocker"), located, ()))) == []


def test_an_encoder_on_the_coupler_or_on_a_rod_has_no_note_in_an_even_turn():
    coupler = np.degrees([link_angles(OMEGA * t + 0.7)[1] for t in TIME])
    log = make_log(coupler, time=TIME)
    located = locate(log, mounted_on="coupler", zero=None)
    assert list(note_crank(Evidence(run_of(log, "coupler"), located, ()))) == []

    # a rod of four cranks, by the law of sines
    rod = np.degrees(np.arcsin(np.sin(OMEGA * TIME + 0.7) / 4))
    log = make_log(rod, time=TIME)
    located = locate(log, mechanism=SliderCrank(0.05, 0.2), zero=None)
    run = run_of(log, "rocker")
    run.settings.linkage = SliderCrankSettings.model_construct(
        kind="slider-crank", crank=0.05, coupler=0.2, crank_speed=OMEGA
    )
    assert list(note_crank(Evidence(run, located, ()))) == []


@pytest.mark.parametrize(("row", "off"), [(12, -8.0), (12, 3.0), (30, 5.0), (40, -3.0)])
@pytest.mark.parametrize("time", [TIME, None], ids=["times", "no times"])
def test_a_reading_that_is_off_is_named(row, off, time):
    angle = ROCKER.copy()
    angle[row] += off if 48 < angle[row] + off < 71 else -off
    (note,) = notes(inside(angle), time=time)
    assert note.text.startswith(f"reading or time of row {row} is not that of an even turn")


@pytest.mark.parametrize("off", [-20.0, 8.0])
def test_a_reading_of_the_crank_that_is_off_is_named(off):
    angle = CRANK.copy()
    angle[20] += off
    (note,) = notes(angle, mounted="crank")
    assert "row 20 " in note.text


@pytest.mark.parametrize(("row", "off"), [(12, 1.0), (12, -1.0), (20, 0.5), (8, -0.6)])
def test_a_slip_is_named_with_its_row_and_size(row, off):
    # from one dead point past the other, so that the readings stay within the reach
    start = int(np.argmax(ROCKER) if off > 0 else np.argmin(ROCKER))
    angle = inside(np.roll(ROCKER, -start))[:36]
    angle[row:] += off
    (note,) = notes(angle, time=TIME[:36], noise=0.002)
    found = re.match(r"it slipped by (\S+) deg at row (\d+), or rows", note.text)
    assert float(found[1]) == pytest.approx(off, abs=0.05)
    assert int(found[2]) == row


@pytest.mark.parametrize(("row", "off"), [(20, 5.0), (15, -6.0)])
def test_a_slip_of_the_crank_is_named_among_few_readings(row, off):
    angle = CRANK[:36].copy()
    angle[row:] += off
    (note,) = notes(angle, mounted="crank", time=TIME[:36])
    found = re.match(r"it slipped by (\S+) deg at row (\d+), ", note.text)
    assert float(found[1]) == pytest.approx(off, abs=0.5)
    assert int(found[2]) == row


@pytest.mark.parametrize(("stated", "words"), [(0.056, True), (0.057, True), (0.0551, False)])
def test_a_crank_of_another_length_is_named_by_the_swing(stated, words):
    found = notes(inside(ROCKER), crank=stated)
    assert len(found) == words
    if words:
        assert f"as with a crank of 5.5 cm in place of {100 * stated:.3g} cm" in found[0].text


@pytest.mark.parametrize(("share", "words"), [(1 / 360, "36\\d"), (math.pi / 180, "57")])
def test_readings_in_turns_or_radian_are_named_by_their_swing(share, words):
    (note,) = notes(48 + share * (inside(ROCKER) - inside(ROCKER).min()), noise=1e-5)
    assert re.search(rf"by 2\d\.\d\d deg, {words} times as far. Correct the unit", note.text)


def test_a_swing_that_no_crank_gives_is_named_without_a_crank(monkeypatch):
    def refuse(swing, **links):
        raise ModelError("Expected a swing that a crank gives.")

    monkeypatch.setattr("erlif.pipeline.audit.crank.crank_for_swing", refuse)
    (note,) = notes(inside(ROCKER), crank=0.056)
    assert "its reading swings by" in note.text
    assert "as with a crank" not in note.text


@pytest.mark.parametrize("seed", range(20))
def test_noise_of_any_size_is_neither_odd_nor_a_slip(seed):
    rest = np.random.default_rng(seed).normal(size=200)
    assert find_odd(rest, 24.0).size == 0
    assert find_slips(rest, 24.0) == []


def test_an_uneven_crank_is_not_judged():
    uneven = np.degrees([link_angles(OMEGA * t + 0.7 + math.sin(OMEGA * t))[0] for t in TIME])
    assert notes(inside(uneven)) == []


def test_a_log_without_a_linkage_has_no_note():
    run = run_of(make_log(ROCKER), "rocker")
    run.settings.linkage = None
    assert list(note_crank(Evidence(run, xr.Dataset(), ()))) == []
