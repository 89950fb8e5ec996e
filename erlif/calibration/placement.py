"""Refinement of the pose: the profile is moved to where the ratio fits best.

Only what the form of the profile determines is refined, see `erlif.calibration.pose`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.calibration.pairing import pair_profile_with_image
from erlif.calibration.points import Points
from erlif.calibration.pose import TURN, FoundPose, Freedom, Pose, Turn, find_freedom, find_turn
from erlif.calibration.profile import Profile
from erlif.calibration.regression import Fit, fit_robustly
from erlif.core.arrays import Array
from erlif.core.products import RatioImages

_TURNS = 3  # each turn assigns the pixels anew; the second is already below its error
_STEPS = 10
_CONVERGED = 0.1  # of the standard deviation of each combination
_MOSTLY = 0.5  # share of an element of the pose from which on it counts as determined


def refine_pose(
    ratios: RatioImages, profile: Profile, points: Points, given: Pose
) -> tuple[Points, Freedom, FoundPose]:
    """Move, scale and turn the profile until the ratio fits best.

    The turn of a line comes from the image alone, because the film does not change across it.
    Everything else comes from the form of the profile, together with K, p and q (Gauss-Newton
    steps; the pixels are assigned to the CMM points anew after each).

    Parameters
    ----------
    ratios : RatioImages
        Ratio of the fixture, (y, x).
    profile : Profile
        Profile as it was paired.
    points : Points
        CMM points and ratio, paired at the given pose.
    given : Pose
        Pose from fixture.toml.

    Returns
    -------
    Points
        CMM points and ratio, paired at the refined pose.
    Freedom
        Combinations of offset, scale and turn that stay free in the fit that follows.
    FoundPose
        The refined pose, its change and its uncertainty.
    """
    points, pose, turn = _turn_line(ratios, profile, points, given)
    change = np.zeros(4)
    change[TURN] += turn.angle

    for n in range(_STEPS):
        freedom = _freedom_at(points, pose)
        if not freedom.size:
            break
        fit = fit_robustly(points, freedom)
        std = np.sqrt(np.diag(fit.covariance)[-freedom.size :])
        if n == _STEPS - 1 or np.all(np.abs(fit.displacement) < _CONVERGED * std):
            break
        step = freedom.combinations @ fit.displacement
        change += step
        pose = pose.changed(step, freedom.middle)
        points, _ = pair_profile_with_image(ratios, profile, pose)

    covariance = np.diag([0.0, 0.0, 0.0, turn.std**2])
    if freedom.size:
        scale = max(1.0, fit.reduced_chi_square)
        free = fit.covariance[-freedom.size :, -freedom.size :]
        covariance += scale * freedom.combinations @ free @ freedom.combinations.T
    determined = freedom.shares >= _MOSTLY
    determined[TURN] |= turn.std > 0
    return points, freedom, FoundPose(pose, change, covariance, determined)


def _turn_line(
    ratios: RatioImages, profile: Profile, points: Points, pose: Pose
) -> tuple[Points, Pose, Turn]:
    """Turn a line profile until the ratio is constant across it."""
    total, std = 0.0, 0.0
    for _ in range(_TURNS):
        turn = find_turn(points, pixel_pitch=pose.pixel_pitch)
        if turn.angle == 0.0:
            break
        std = turn.std
        total += turn.angle
        pose = pose.changed(np.array([0.0, 0.0, 0.0, turn.angle]), np.zeros(2))
        points, _ = pair_profile_with_image(ratios, profile, pose)
    return points, pose, Turn(total, std)


def _freedom_at(points: Points, pose: Pose) -> Freedom:
    """Changes of the pose that the points determine, outliers left out."""
    freedom = Freedom.none(points)
    # Without stated uncertainty the CMM's comes from the scatter, to which a wrong pose
    # contributes: the second pass estimates it with the pose free.
    for _ in range(1 if points.has_error_bars else 2):
        fit = fit_robustly(points, freedom)
        freedom = find_freedom(points, fit, pixel_pitch=pose.pixel_pitch)
    return freedom


def add_uncertainty_of_turn(fit: Fit, points: Points, freedom: Freedom, pose: FoundPose) -> Fit:
    """Add the uncertainty of a line's turn to the covariance of K, p and q.

    Parameters
    ----------
    fit : Fit
        The model fitted at the refined pose.
    points : Points
        What was fitted.
    freedom : Freedom
        Changes of the pose that were free in the fit.
    pose : FoundPose
        The refined pose with the standard deviation of its turn.

    Returns
    -------
    Fit
        The same parameters with the larger covariance; a surface's fit is returned as it is.
    """
    if points.on_surface:
        return fit
    slope = fit.slope(fit.true_thickness)
    design = np.column_stack(
        [fit.gradient(fit.true_thickness).T, slope[:, None] * freedom.displacement]
    )[fit.kept]
    variance = points.log_ratio_std**2 + (slope * fit.thickness_std) ** 2

    # linear response of the parameters to a turn by one standard deviation
    moved: Array = (slope * points.gradient[:, 0] * points.mean_across / variance)[fit.kept]
    response = fit.covariance @ design.T @ moved * pose.standard_deviations[TURN]
    return replace(fit, covariance=fit.covariance + np.outer(response, response))
