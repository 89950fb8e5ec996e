"""Errors of a run as the search for the shortest list of remedies takes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.calibration import RunCurve
from erlif.pipeline.physics.systematics import has_dry_joint, with_patch
from erlif.pipeline.recording.prepare import PreparedRun
from erlif.planning.target import FILMS, PATCH_STD, FilmErrors, information_of


def errors_of_run(ready: PreparedRun, curve: RunCurve, noise: float) -> FilmErrors:
    """Errors of films in the middle of a run, and the remedies that it has.

    Where the gap of the joint took errors out, its information holds for smaller widths as well.

    Parameters
    ----------
    ready : PreparedRun
    curve : RunCurve
        With the errors of the run.
    noise : float
        Error of the logarithm of the ratio that no remedy lowers. [1]

    Returns
    -------
    FilmErrors
        The film that decides is the median one of the run.
    """
    settings, middle, before = ready.run.settings, curve.at(0.5), curve.systematics.without_run
    covariance = before.anywhere(before.extend(curve.fitted_covariance))
    information, scale = None, ready.light.scale
    if ready.light.taken_out:
        # what the gap adds to a patch
        earlier = replace(curve, systematics=before)
        known = earlier if scale is None else with_patch(earlier, scale)
        information = information_of(known.at(0.5).anywhere_covariance, middle.anywhere_covariance)
        # nothing is taken out of a change over the field, which the gap may show to be larger
        left = np.diag(middle.anywhere_covariance)
        np.fill_diagonal(covariance, np.maximum(np.diag(covariance), left))

    # the shares of the light are those of its median film
    median = float(middle.inverse.look_up(np.diff(np.log(before.light)))[0])
    films = np.array([*FILMS, median, median if scale is None else scale.film])
    patch_std = PATCH_STD if scale is None else scale.film_std

    has = {
        "patch": scale is not None,
        "dry_frames": has_dry_joint(settings),
        "fixture_after": curve.later is not None,
        "temperature_log": settings.temperature.coefficient is not None,
    }
    had = frozenset(key for key in has if has[key])

    # films that the fixture does not cover have no errors
    low, high = middle.covered_range
    acts = np.where((films < low) | (films > high), np.nan, middle.gradient(films))
    errors = FilmErrors(films, acts, middle.slope(films), before, covariance, information)
    widths = settings.systematics.shares
    return replace(errors, shares=widths, had=had, noise=noise, patch_std=patch_std)
