"""The profile laid on the image where the ratio fits best, as far as its form tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from erlif.calibration.pairing import pair_profile_with_image
from erlif.calibration.points import Points
from erlif.calibration.pose import FoundPose, Freedom, Pose, find_freedom, find_turn
from erlif.calibration.profile import Profile
from erlif.calibration.regression import Fit, fit_robustly
from erlif.core.products import RatioImages

_STEPS = 10


def refine_pose(
    ratios: RatioImages, profile: Profile, points: Points, given: Pose
) -> tuple[Points, Freedom, FoundPose]:
    """Move, scale and turn the profile until the ratio fits best.

    The turn of a line is told by the image alone, because the film must not change across it; everything else by the form of the
    profile, together with K, p and q (Gauss-Newton steps, the pixels assigned to the CMM points anew after each).

    Parameters
    ----------
    ratios : RatioImages
    profile : Profile
        As it was paired.
    points : Points
        Paired at the given pose.
    given : Pose

    Returns
    -------
    points : Points
        Paired at the pose found.
    freedom : Freedom
        Combinations of offset, scale and turn that the data tell; they stay free in the fit that follows.
    found : FoundPose
    """
    pose, change, turn_std = given, np.zeros(4), 0.0
    for _ in range(3):
        turn, turn_error = find_turn(points, pixel_pitch=pose.pixel_pitch)
        if turn == 0.0:
            break
        turn_std = turn_error
        change[3] += turn
        pose = pose.changed(np.array([0.0, 0.0, 0.0, turn]), np.zeros(2))
        points, _ = pair_profile_with_image(ratios, profile, pose)
    for n in range(_STEPS):
        freedom = _freedom_at(points, pose)
        if not freedom.size:
            break
        fit = fit_robustly(points, freedom)
        std = np.sqrt(np.diag(fit.covariance)[3:])
        if n == _STEPS - 1 or np.all(np.abs(fit.displacement) < 0.1 * std):
            break
        step = freedom.combinations @ fit.displacement
        change += step
        pose = pose.changed(step, freedom.middle)
        points, _ = pair_profile_with_image(ratios, profile, pose)
    covariance = np.diag([0.0, 0.0, 0.0, turn_std**2])
    if freedom.size:
        scale = max(1.0, fit.reduced_chi_square)
        covariance += scale * freedom.combinations @ fit.covariance[3:, 3:] @ freedom.combinations.T
    determined = freedom.shares >= 0.5
    determined[3] |= turn_std > 0
    return points, freedom, FoundPose(pose, change, covariance, determined)


def _freedom_at(points: Points, pose: Pose) -> Freedom:
    freedom = Freedom.none(points)
    # without error bars, those of the CMM come from a scatter that a wrong pose is part of: look again with the pose free
    for _ in range(1 if np.isfinite(points.thickness_std).all() else 2):
        fit = fit_robustly(points, freedom)
        freedom = find_freedom(
            points,
            fit.kept,
            true_thickness=fit.true_thickness,
            slope=fit.slope(fit.true_thickness),
            thickness_std=fit.thickness_std,
            pixel_pitch=pose.pixel_pitch,
        )
    return freedom


def add_uncertainty_of_turn(fit: Fit, points: Points, freedom: Freedom, found: FoundPose) -> Fit:
    """The fit with a covariance that holds what the uncertain turn of a line leaves in K, p and q."""
    if points.position.shape[1] == 2:
        return fit
    slope = fit.slope(fit.true_thickness)
    design = np.column_stack(
        [fit.gradient(fit.true_thickness).T, slope[:, None] * freedom.displacement]
    )[fit.kept]
    variance = points.log_ratio_std**2 + (slope * fit.thickness_std) ** 2
    moved = (slope * points.gradient[:, 0] * points.mean_across / variance)[fit.kept]
    response = fit.covariance @ design.T @ moved * found.standard_deviations[3]
    return replace(fit, covariance=fit.covariance + np.outer(response, response))
