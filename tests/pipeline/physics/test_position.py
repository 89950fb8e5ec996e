"""The position of the pin of a run: against its true film, and as variables of the film."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr
from scenes.fixture import with_systematics
from scenes.pin import fit_true_film
from scenes.results import make_position

from erlif.calibration import calibration_of
from erlif.core.notes import Level
from erlif.pipeline.physics.position import describe_positions, note_form
from erlif.pipeline.plane import ObjectPlane

SHAPE = (96, 128)


def test_position_follows_the_true_film(opened, truth):
    """Marks included, so that noise and calibration remain; the region is that of the run.

    The load line of this film is that which it states: the middle of its swing.
    """
    x, y = opened.x.values, opened.y.values
    inside_x, inside_y = (x >= 4) & (x <= 15), (y >= 2) & (y <= 13)
    line = opened.pin_displacement.attrs["load_line"]
    place = (x - line)[inside_x], (y - y.mean())[inside_y]
    pulls = []
    for k in range(6):
        true = fit_true_film(truth.film.values[k][np.ix_(inside_y, inside_x)], *place)
        found = np.concatenate([opened.pin_displacement.values[k], opened.pin_tilt.values[k]])
        pulls.append((found - true) / np.sqrt(np.diag(opened.pin_position_cov.values[k])))
    assert np.sqrt(np.mean(np.square(pulls), axis=0)).max() < 2
    assert np.abs(pulls).max() < 4


def test_covariance_has_the_stored_parts(opened):
    """Whole = noise + calibration + surfaces, and the rest has no negative variance."""
    covariance = calibration_of(opened).full_covariance
    for whole, random, gradient in zip(
        opened.pin_position_cov.values,
        opened.pin_position_cov_random.values,
        opened.pin_position_gradient.values,
        strict=True,
    ):
        rest = whole - random - gradient @ covariance @ gradient.T
        scale = 1 / np.sqrt(np.diag(whole))
        assert np.linalg.eigvalsh(rest * scale * scale[:, None]).min() > -1e-9


def test_triggers_without_a_position_leave_the_variables_out(run, calibration):
    view = ObjectPlane(run.settings, SHAPE).view
    assert describe_positions([make_position(), None], calibration, view) == {}
    assert describe_positions([make_position()], calibration, None) == {}


def test_variables_are_those_of_the_results(run, calibration):
    view = ObjectPlane(run.settings, SHAPE).view
    positions = [make_position((0.01, 0.02), film=film) for film in (2.0, 5.0)]
    film = xr.Dataset(describe_positions(positions, calibration, view))
    npt.assert_array_equal(film.pin_displacement, [[228.0, 1.0], [225.0, 1.0]])
    npt.assert_array_equal(film.pin_tilt, [[0.01, 0.1]] * 2)
    # e/(R1 R2), mm2
    expected = np.array([228.0, 225.0]) / (33.36 * 33.59)
    npt.assert_allclose(film.film_curvature_expected, expected)
    npt.assert_allclose(film.film_curvature, expected + 0.01)
    npt.assert_allclose(film.film_curvature_axial, 0.02)
    npt.assert_allclose(film.film_curvature_std, 0.001)


def notes_of(run, calibration, positions, *, load=np.nan, radii=("33.36 mm", "33.59 mm")):
    settings = run.settings
    changed = settings.model_dump(mode="json", exclude_none=True)
    changed["joint"]["pin_radius"], changed["joint"]["bushing_radius"] = radii
    settings = type(settings).model_validate(changed)
    return note_form(positions, calibration, ObjectPlane(settings, SHAPE), load)


def forms(along, axial=0.0):
    """Two triggers with these curvatures beyond circles. [um/mm2]"""
    return [make_position((along, axial), film=film) for film in (2.0, 5.0)]


EXACT = ("33.3600 mm", "33.5900 mm")
CHANGING = [make_position((0.01, 0.0), film=2.0), make_position((0.03, 0.0), film=5.0)]
FLATTENED = [make_position((-1.5 * 0.382 / h * 0.20525, 0.0), film=h) for h in (2.0, 5.0)]


@pytest.mark.parametrize(
    ("positions", "options", "words"),
    [
        # 10 % less of 0.2053 um/mm2; radii to 0.01 mm give a clearance to 4.1 um
        (forms(-0.02053), {}, "deviates by -10.0 ± 1."),
        (forms(-0.02053), {}, "a clearance of 207.0 um in place of 230.0 um, stated to ± 4.1 um"),
        (
            forms(0.02053),
            {"radii": EXACT},
            "likely, in this order: (1) films that the calibration makes 10.0 % too",
        ),
        (CHANGING, {}, "likely, in this order: the calibration, because the deviation changes"),
        (forms(0.0, 0.01), {}, "curved along the axis, 10.00 ± 0.71 nm/mm2"),
        (forms(0.0, 0.01), {}, "(1) a bent pin or an uneven bore; (2) a wrong dark, or light"),
        (FLATTENED, {"load": 222.4}, "likely, in this order: elastic flattening"),
    ],
)
def test_curvature_is_reported_with_its_likely_cause(run, calibration, positions, options, words):
    note = notes_of(run, calibration, positions, **options)[0]
    assert note.level is Level.WARNING
    assert words in note.text


@pytest.mark.parametrize(
    ("width", "first"), [(0.014, "scale of the ratio"), (0.004, "a clearance of 207.0 um")]
)
def test_errors_that_frames_do_not_show_are_among_the_causes(run, calibration, width, first):
    """A calibration 1 % low in the ratio makes gaps 2 % flatter here; these are 10 % flatter.

    The radii are known to 1.8 % and the film scale to 1 %: 10 % are 4.9 of their standard
    deviations, a ratio 5 % high is 3.6 or 12.5 of its own.
    """
    known = with_systematics(calibration, ratio=width)
    gradient = np.array([[0.0, 0.0, 0.0, 2 * 0.20525], [0.0, 0.0, 0.0, 0.0]])
    wide = np.zeros((4, 4))
    positions = [
        replace(one, gradient=wide, form=replace(one.form, gradient=gradient))
        for one in forms(-0.02053)
    ]
    (note,) = notes_of(run, known, positions)
    likeliest, _, _ = note.text.partition("(2)")
    assert first in likeliest
    assert "scale of the ratio between fixture and run (+5.0 %)" in note.text
    assert "a clearance of 207.0 um" in note.text


def test_flattening_beyond_the_error_of_the_position_is_noted(run, calibration):
    """50 lbf on 237 mm of acrylic: b^2/2R = 2 q/(pi E*) = 0.38 um, E* = 1.564 GPa."""
    (note,) = notes_of(run, calibration, forms(0.0), load=222.4)
    assert note.level is Level.NOTE
    assert "flattens pin and bushing by up to 0.38 um" in note.text
    assert notes_of(run, calibration, forms(0.0), load=0.0) == []
