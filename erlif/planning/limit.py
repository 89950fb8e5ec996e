"""Errors that no frame shows: those of a planned rig, and what the gap of a joint leaves of them.

The widths of the errors are those of the plan. A joint whose radii are known shows part of them
in the curvature of its gap; what it leaves follows from the equations of `erlif.trend.rigidity`,
which need no measured value. A constant error of all films remains: it is a displacement of the
pin. The error of the calibration and the position of the fixture are not part of a plan. Remedies
lower the widths (`erlif.planning.target`).
"""

from __future__ import annotations

import numpy as np

from erlif.calibration import Reabsorption, Systematics
from erlif.core.arrays import Array
from erlif.core.terms import TERMS
from erlif.io.settings.planning import JointOfPlan
from erlif.planning.design import Design, log_ratio, log_ratio_slope, mean_attenuation
from erlif.planning.precision import WantedFilm, log_ratio_variance
from erlif.planning.target import FILMS, FilmErrors, information_of
from erlif.ratio import cell_centres
from erlif.trend import (
    CLEARANCE_STD,
    RatioEquations,
    RigidityUnknowns,
    gap_of_pin,
    solve_equations,
)

_SHAPE = (256, 320)  # px: rows and columns of the image, of which a cell is one of 120
_CELL = _SHAPE[0] * _SHAPE[1] / 120  # px in a cell
_EXCESS = 3e-4  # scatter of the ratio of a cell beyond photons, as virtual rigs show it [1]
_TURNS = 1.5  # times that the pin goes up and down in a run


def attainable_errors(
    design: Design, film: WantedFilm, widths: dict[str, float], joint: JointOfPlan | None
) -> tuple[Systematics, Array, FilmErrors]:
    """Errors of a run by their widths, and by the gap of a joint.

    Parameters
    ----------
    design : Design
    film : WantedFilm
        The minimum film of the joint moves through the wanted range.
    widths : dict of str to float
        Standard deviation of each source of error that a file states. [1]
    joint : JointOfPlan or None
        None: the form of the gap is not known.

    Returns
    -------
    systematics : Systematics
        By the widths; it names the parameters.
    covariance : array, (parameter, parameter)
        With the gap.
    errors : FilmErrors
        Those of `FILMS` and of the middle of the wanted range, which is the film of a patch.

    Examples
    --------
    >>> from erlif.planning.design import example_dye_design
    >>> lengths = {"pin_radius": "33.36 mm", "bushing_radius": "33.59 mm", "width": "19.2 mm"}
    >>> joint = JointOfPlan(**lengths, frames=30)
    >>> wanted = WantedFilm(2.0, 10.0, (0.1, 18.0))
    >>> found = attainable_errors(example_dye_design(), wanted, {"ratio": 0.01}, joint)
    >>> bool((found[2].std() < 0.5 * 0.01 / found[2].slope[:-1]).all())
    True
    """
    attenuation = [mean_attenuation(design, number) for number in (1, 2)]
    model = Reabsorption(np.array([float(np.exp(log_ratio(design, 1e-6))), *attenuation]))
    middle = float(np.sqrt(film.thinnest * film.thickest))
    light = float(model.light(middle).signal)
    pair = (light, light * float(np.exp(model.predict(middle))))
    terms = {key: width for key, width in widths.items() if key in TERMS and not TERMS[key].of_two}
    systematics = Systematics.of(terms, parameters=0, light=pair, frame=_SHAPE)
    covariance, information = systematics.covariance, None
    prior = systematics.anywhere(covariance)
    if joint is not None:
        covariance = _constrain(design, film, model, systematics, joint)
        information = information_of(prior, systematics.anywhere(covariance))

    films = np.array([*FILMS, middle, middle])
    slope = log_ratio_slope(design, films)
    acts = systematics.gradient(films, model, slope, 0 * films, passed=np.array([0.5]))
    errors = FilmErrors(films, acts, slope, systematics, prior, information, widths)
    return systematics, covariance, errors


def _constrain(
    design: Design,
    film: WantedFilm,
    model: Reabsorption,
    systematics: Systematics,
    joint: JointOfPlan,
) -> Array:
    """Covariance of the errors under the condition that all frames show one gap."""
    lengths = (joint.width, joint.pin_radius, joint.bushing_radius)
    width, pin, bore = (1e3 * float(length) for length in lengths)  # mm
    place = cell_centres(_SHAPE)
    x, y = (width / _SHAPE[1] * centre for centre in place)
    x, y = x - x.mean(), y - y.mean()
    radius = float(np.sqrt(pin * bore))
    clearance = 1e3 * (bore - pin)
    gap = gap_of_pin(x, y, radius, clearance_std=CLEARANCE_STD * clearance)

    # the minimum film takes the part of the wanted range that the form of the gap leaves
    passed = np.linspace(0, 1, joint.frames)
    form = clearance * (1 - np.cos(x / radius))
    span = max(film.thickest - film.thinnest - float(form.max()), 0.0)
    minimum = film.thinnest + span * np.sin(np.pi * _TURNS * passed) ** 2
    films = minimum[:, None] + form

    slope, (new, _) = log_ratio_slope(design, films), log_ratio_variance(design, films, average=1)
    acts = systematics.gradient(films, model, slope, 0 * films, passed=passed[:, None], place=place)
    variance = np.where(films <= film.thickest, new / _CELL + _EXCESS**2, np.inf)
    nothing = RigidityUnknowns(
        np.zeros(len(acts)), np.zeros(x.size), np.zeros((joint.frames, len(gap[0])))
    )
    equations = RatioEquations(slope, acts, variance, *gap)
    return solve_equations(equations, systematics.covariance, np.zeros(films.shape), nothing)[1]
