"""Errors that no frame shows, of a planned rig."""

from dataclasses import replace

import numpy as np
import numpy.testing as npt

from erlif.io.settings.planning import JointOfPlan
from erlif.planning import WantedFilm, log_ratio
from erlif.planning.design import example_dye_design
from erlif.planning.limit import attainable_errors
from erlif.planning.target import FILMS

DESIGN, WANTED = example_dye_design(), WantedFilm(2.0, 10.0, (0.1, 18.0))
LENGTHS = {"pin_radius": "33.36 mm", "bushing_radius": "33.59 mm", "width": "19.2 mm"}
JOINT = JointOfPlan(**LENGTHS, frames=40)


def errors(joint=None, **widths):
    return attainable_errors(DESIGN, WANTED, widths, joint)


def films_of(joint=None, **widths):
    """Standard deviations of the films."""
    return errors(joint, **widths)[2].std()[: len(FILMS)]


def test_a_scale_of_the_ratio_moves_a_film_by_its_share_over_the_slope():
    """The slope by differences of the ratio of the design."""
    step, films = 1e-4, np.array(FILMS)
    slope = (log_ratio(DESIGN, films + step) - log_ratio(DESIGN, films - step)) / (2 * step)
    npt.assert_allclose(films_of(ratio=0.01), 0.01 / slope, rtol=1e-5)


def test_errors_add_in_quadrature_and_the_gap_lowers_them():
    widths = {"ratio": 0.01, "wall": 0.02, "linearity": 0.01}
    one_by_one = [films_of(**{name: width}) ** 2 for name, width in widths.items()]
    without, covariance = films_of(**widths), errors(JOINT, **widths)[1]
    npt.assert_allclose(without, np.sqrt(sum(one_by_one)), rtol=1e-9)
    assert (films_of(JOINT, **widths) < 0.6 * without).all()
    assert (np.diag(covariance) <= np.array([0.01, 0.02, 0.01, 0.01]) ** 2 * (1 + 1e-9)).all()


def test_more_frames_lower_the_errors():
    widths = {"ratio": 0.01, "wall": 0.02, "linearity": 0.01, "background": 0.015}
    few, many = (films_of(JointOfPlan(**LENGTHS, frames=n), **widths) for n in (20, 200))
    assert (many < few).all()


def test_the_scale_of_the_fixture_keeps_its_width():
    """The gap is known to 1 % of its clearance, and the scale to half of that."""
    systematics, covariance, _ = errors(JOINT, size=0.005)
    assert systematics.terms == ("size",)
    assert 0.0045 < np.sqrt(covariance[0, 0]) <= 0.005


def test_the_gap_holds_for_smaller_widths_as_if_they_were_stated():
    """The list of means uses the information of the gap; the plan solves its equations again."""
    widths = {"ratio": 0.01, "wall": 0.02, "linearity": 0.01, "background": 0.015, "energy": 0.05}
    lowered = errors(JOINT, **widths)[2].std(["walls", "flat_levels"])
    stated = errors(JOINT, **widths | {"wall": 0.005, "linearity": 0.001})[2].std()
    npt.assert_allclose(lowered, stated, rtol=1e-6)


def test_means_that_the_rig_has_lower_its_errors_once():
    widths = {"wall": 0.02, "background": 0.015, "energy": 0.05}
    found, had = errors(**widths)[2], frozenset(["dry_frames", "walls"])
    found = replace(found, covariance=found.lowered(had), had=had)
    npt.assert_allclose(found.std()[:4], films_of(wall=0.005, background=0.05 * 0.015), rtol=1e-9)
    npt.assert_allclose(found.std(["flats"]), found.std())
