"""Errors that no frame shows, of a planned rig."""

import numpy as np
import numpy.testing as npt

from erlif.io.settings.planning import JointOfPlan
from erlif.planning import WantedFilm, log_ratio
from erlif.planning.design import example_dye_design
from erlif.planning.limit import FILMS, attainable_errors

DESIGN, WANTED = example_dye_design(), WantedFilm(2.0, 10.0, (0.1, 18.0))
LENGTHS = {"pin_radius": "33.36 mm", "bushing_radius": "33.59 mm", "width": "19.2 mm"}
JOINT = JointOfPlan(**LENGTHS, frames=40)


def errors(joint=None, **widths):
    return attainable_errors(DESIGN, WANTED, widths, joint)


def test_a_scale_of_the_ratio_moves_a_film_by_its_share_over_the_slope():
    """The slope by differences of the ratio of the design."""
    step, films = 1e-4, np.array(FILMS)
    slope = (log_ratio(DESIGN, films + step) - log_ratio(DESIGN, films - step)) / (2 * step)
    _, _, std = errors(ratio=0.01)
    npt.assert_allclose(std, [0.01 / slope] * 2, rtol=1e-5)


def test_errors_add_in_quadrature_and_the_gap_lowers_them():
    widths = {"ratio": 0.01, "wall": 0.02, "linearity": 0.01}
    one_by_one = [errors(**{name: width})[2][0] ** 2 for name, width in widths.items()]
    _, covariance, std = errors(JOINT, **widths)
    npt.assert_allclose(std[0], np.sqrt(sum(one_by_one)), rtol=1e-9)
    assert (std[1] < 0.6 * std[0]).all()
    assert (np.diag(covariance) <= np.array([0.01, 0.02, 0.01, 0.01]) ** 2 * (1 + 1e-9)).all()


def test_more_frames_lower_the_errors():
    widths = {"ratio": 0.01, "wall": 0.02, "linearity": 0.01, "background": 0.015}
    few, many = (errors(JointOfPlan(**LENGTHS, frames=n), **widths)[2][1] for n in (20, 200))
    assert (many < few).all()


def test_the_scale_of_the_fixture_keeps_its_width():
    """The gap is known to 1 % of its clearance, and the scale to half of that."""
    systematics, covariance, _ = errors(JOINT, size=0.005)
    assert systematics.terms == ("size",)
    assert 0.0045 < np.sqrt(covariance[0, 0]) <= 0.005
